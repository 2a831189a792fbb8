// Fragments write only the depths of their quads.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) {
    left(in);
}
