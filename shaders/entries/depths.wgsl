// Fragments leave nothing beside depths of their own.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @builtin(frag_depth) f32 {
    left(in);
    return depth_of(in);
}
