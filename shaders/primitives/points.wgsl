// A point is a square that faces the screen; one of a pixel is one vertex of a point list. What is known of it beside its
// place and its colour: `points_*.wgsl`.

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let point = fetch_point(instance);
    let shape = point_shape(instance);
    var clip = project(rotate_to_view(offset_from_eye(point.position)));
    if (VERTICES_PER_RECORD > 1u) {
        let corner = quad_corner(vertex_of_record(instance));
        let half_edge = 0.5 * (view.point_edge + view.point_edge_per_radius * shape.radius);
        let least = view.point_least_px / view.viewport_px * clip.w;
        clip += vec4f(corner * max(half_edge * view.focal, least), 0.0, 0.0);
    }
    return SplatVertex(clip, point.color, 0u, vec2f(1.0, 0.0));
}
