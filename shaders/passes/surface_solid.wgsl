// The faces of voxels, and meshes, for deferred shading.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> Surface {
    return surface(in, in.normal, 1.0);
}
