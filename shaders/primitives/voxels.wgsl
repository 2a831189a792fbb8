// A voxel is drawn as the three faces of its cube that can face the eye. How they are lit: `voxels_lit_by_*.wgsl`.

#import common/light.wgsl
#import common/quads.wgsl
#import common/records.wgsl
#import common/view.wgsl
#import generated/constants

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let cell = fetch_point(instance);
    let vertex = vertex_of_record(instance);
    let face = vertex / VERTICES_PER_QUAD;
    return voxel_vertex(cell, lit_normal(instance, cell, face), face, vertex % VERTICES_PER_QUAD);
}

fn may_be_seen(instance: Instance) -> bool {
    let cell = fetch_point(instance);
    return sphere_may_be_seen(cell.position, CUBE_REACH_HALF_EDGES * voxel_half_edge(cell));
}

// The side of a cell whose face is towards the eye. For an eye between the two planes it faces away and is culled.
fn towards_eye(cell: PointRecord, face: u32) -> f32 {
    return select(-1.0, 1.0, offset_from_eye(cell.position)[face] < 0.0);
}

// One of the three faces of a cell that can face the eye, lit with a packed normal: `face` is 0, 1, 2 for x, y, z.
fn voxel_vertex(cell: PointRecord, lit_normal: u32, face: u32, corner: u32) -> SplatVertex {
    let half_edge = voxel_half_edge(cell);
    let center = offset_from_eye(cell.position);
    let towards = towards_eye(cell, face);
    let normal = along_axis(face, towards);
    // Two axes of the face, ordered so that the corners run counter-clockwise seen from outside.
    let u = along_axis((face + 1u) % 3u, towards);
    let v = along_axis((face + 2u) % 3u, 1.0);
    let q = quad_corner(corner);
    let face_center = center + normal * half_edge;
    let offset = face_center + (u * q.x + v * q.y) * half_edge;
    var clip = project(rotate_to_view(offset));
    // In a shadow map, the faces of cells are steps in the surface that they stand for.
    let step = 2.0 * CUBE_REACH_HALF_EDGES * half_edge;
    clip.z /= 1.0 + view.depth_slack * step / max(length(center), view.near);
    let light = light_at_vertex(oct_decode(lit_normal), face_center, offset);
    return SplatVertex(clip, cell.color, lit_normal, pack2x16unorm(light), 1.0);
}

// Not by `vector[axis] = length`: FXC, one of the two compilers for Direct3D 12, rejects it.
fn along_axis(axis: u32, length: f32) -> vec3f {
    return select(vec3f(0.0), vec3f(length), vec3u(0u, 1u, 2u) == vec3u(axis));
}

fn voxel_half_edge(cell: PointRecord) -> f32 {
    return ldexp(view.cube_half_edge, -i32(cell.color >> 24u));
}
