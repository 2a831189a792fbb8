// Opaque geometry among which points are round.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    if (is_beside_disk(in.quad)) {
        discard;
    }
    return vec4f(shaded(in), 1.0);
}
