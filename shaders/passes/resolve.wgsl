// Resolve: divides the summed colours by the summed weights and composites the result over the background, or over the
// surface behind a soft edge.

#import common/fullscreen.wgsl
#import common/rims.wgsl

fn sum_at(pixel: vec2i) -> vec4f {
    return textureLoad(accumulated, pixel, 0);
}

fn depth_at(pixel: vec2i) -> f32 {
    return textureLoad(depths, pixel, 0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    if (sum_at(pixel).a == 0.0) {
        discard;
    }
    return over_rim(pixel);
}
