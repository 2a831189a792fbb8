// The faces of voxels, and meshes, for deferred shading.

#import common/fragments.wgsl

fn left(in: Varyings) -> Surface {
    return surface(in, in.normal, 1.0);
}
