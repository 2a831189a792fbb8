// Fragments write a colour.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    return left(in);
}
