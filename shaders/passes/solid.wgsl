// Opaque geometry: the faces of voxels, and meshes.

fn left(in: Varyings) -> vec4f {
    return vec4f(shaded(in), 1.0);
}
