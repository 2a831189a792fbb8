// A point is a square of fixed size that faces the screen; one of a pixel is one vertex of a point list.

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let point = fetch_point(instance);
    var clip = project(rotate_to_view(offset_from_eye(point.position)));
    if (VERTICES_PER_RECORD > 1u) {
        let corner = quad_corner(vertex_of_record(instance));
        clip += vec4f(corner * view.point_size_px / view.viewport_px * clip.w, 0.0, 0.0);
    }
    return SplatVertex(clip, point.color, 0u, pack2x16unorm(vec2f(1.0, 0.0)), 1.0);
}
