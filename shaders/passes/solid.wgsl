// Opaque geometry: the faces of voxels, and meshes.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    return vec4f(shaded(in), 1.0);
}
