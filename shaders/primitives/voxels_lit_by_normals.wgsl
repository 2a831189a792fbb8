// Light falls on the surface in a voxel instead of on its faces.

#import common/records.wgsl
#import primitives/voxels.wgsl

fn lit_normal(instance: Instance, cell: PointRecord, face: u32) -> u32 {
    return fetch_shape(instance).normal;
}
