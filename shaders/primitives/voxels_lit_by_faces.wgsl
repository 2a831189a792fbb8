// Lights the faces of a voxel.

#import common/records.wgsl
#import primitives/voxels.wgsl

fn lit_normal(instance: Instance, cell: PointRecord, face: u32) -> u32 {
    return pack2x16snorm(face_oct(face, towards_eye(cell, face)));
}

// Octahedral code of an axis: exact.
fn face_oct(face: u32, towards: f32) -> vec2f {
    switch face {
        case 0u: { return vec2f(towards, 0.0); }
        case 1u: { return vec2f(0.0, towards); }
        default: { return select(vec2f(1.0, 1.0), vec2f(0.0, 0.0), towards > 0.0); }
    }
}
