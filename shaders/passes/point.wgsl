// Plain points: colours as they are, whatever the lighting.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    return vec4f(albedo(in), 1.0);
}
