// The picture that is shown: each pixel is the mean of those that were drawn for it, as they are displayed.

#import common/fullscreen.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let samples = SAMPLES_PER_EDGE;
    let first = samples * vec2u(position.xy);
    var sum = vec4f(0.0);
    for (var row = 0u; row < samples; row++) {
        for (var column = 0u; column < samples; column++) {
            // Display-referred: averages of linear light would make bright sides of edges wider. As it is, edges look
            // like those that splats blend, alpha can be found by drawing on black and on white, and flat areas keep
            // their bytes.
            sum += textureLoad(picture, first + vec2u(column, row), 0);
        }
    }
    return sum / f32(samples * samples);
}
