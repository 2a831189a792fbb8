// A level of half the size (Gortler et al. 1996, §3.5): the mean colour of four pixels, weighted by their confidence;
// its confidence is their sum, at most 1.

#import common/fullscreen.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = 2u * vec2u(position.xy);
    let end = min(first + 2u, textureDimensions(finer));
    var sum = vec4f(0.0);
    for (var row = first.y; row < end.y; row++) {
        for (var column = first.x; column < end.x; column++) {
            sum += textureLoad(finer, vec2u(column, row), 0);
        }
    }
    return sum / max(sum.a, 1.0);
}
