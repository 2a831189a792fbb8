// Fragments leave what deferred shading needs.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> Surface {
    return left(in);
}
