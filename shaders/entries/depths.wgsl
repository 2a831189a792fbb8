// Fragments write only their own depth.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @builtin(frag_depth) f32 {
    left(in);
    return depth_of(in);
}
