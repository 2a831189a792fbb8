// The faces of voxels, and meshes, for deferred shading.

fn left(in: Varyings) -> Surface {
    return surface(in, in.normal, 1.0);
}
