// The displayed image: each pixel is the mean of its display-referred samples.

#import common/fullscreen.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let samples = SAMPLES_PER_EDGE;
    let first = samples * vec2u(position.xy);
    var sum = vec4f(0.0);
    for (var row = 0u; row < samples; row++) {
        for (var column = 0u; column < samples; column++) {
            // Display-referred: averaging linear light would widen the bright sides of edges. This way, edges match
            // those blended by splats, alpha can be recovered by drawing on black and on white, and flat areas keep
            // their exact bytes.
            sum += textureLoad(picture, first + vec2u(column, row), 0);
        }
    }
    return sum / f32(samples * samples);
}
