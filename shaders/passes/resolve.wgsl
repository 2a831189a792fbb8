// Resolve: divides the summed colours by the summed weights and lays the result over the background, or over what lies
// behind a rim.

@group(SOURCE_GROUP) @binding(0) var accumulated: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(1) var depths: texture_depth_2d;

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
