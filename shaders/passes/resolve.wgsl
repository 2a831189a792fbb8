// Resolve: divides the summed colours by the summed weights and lays the result over the background.

@group(SOURCE_GROUP) @binding(0) var accumulated: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let sum = textureLoad(accumulated, vec2u(position.xy), 0);
    if (sum.a == 0.0) {
        discard;
    }
    return vec4f(sum.rgb / sum.a, min(sum.a / view.opaque_weight, 1.0));
}
