// A voxel is the three faces of its cube that can face the eye.

const VERTICES_PER_RECORD: u32 = 12u;

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let vertex = vertex_of_record(instance);
    return voxel_vertex(fetch_point(instance), vertex / 4u, vertex % 4u);
}

fn may_be_seen(instance: Instance) -> bool {
    let cell = fetch_point(instance);
    return sphere_may_be_seen(cell.position, 1.7321 * voxel_half_edge(cell));
}
