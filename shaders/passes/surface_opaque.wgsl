// Hard disks for deferred shading.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> Surface {
    if (dot(in.quad, in.quad) > 1.0) {
        discard;
    }
    return surface(in, in.normal, 1.0);
}
