// Lights the surface inside a voxel instead of its faces.

#import common/records.wgsl
#import primitives/voxels.wgsl

fn lit_normal(instance: Instance, cell: PointRecord, face: u32) -> u32 {
    return fetch_shape(instance).normal;
}
