// A point of one pixel needs no amplification: it is one vertex of a point list.

const VERTICES_PER_RECORD: u32 = 1u;

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let point = fetch_point(instance);
    return SplatVertex(project(rotate_to_view(offset_from_eye(point.position))), point.color, 0u, vec2f(1.0, 0.0));
}
