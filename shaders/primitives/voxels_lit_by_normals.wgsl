// A voxel whose light falls on the surface in it instead of on its faces.

const VERTICES_PER_RECORD: u32 = 12u;

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let vertex = vertex_of_record(instance);
    let normal = fetch_shape(instance).normal;
    return voxel_vertex_with_normal(fetch_point(instance), normal, vertex / 4u, vertex % 4u);
}

fn may_be_seen(instance: Instance) -> bool {
    let cell = fetch_point(instance);
    return sphere_may_be_seen(cell.position, 1.7321 * voxel_half_edge(cell));
}
