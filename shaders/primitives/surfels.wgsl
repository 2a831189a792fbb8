// A surfel is one quad.

const VERTICES_PER_RECORD: u32 = 4u;

fn amplified_vertex(instance: Instance) -> SplatVertex {
    return surfel_vertex(fetch_point(instance), fetch_shape(instance), vertex_of_record(instance));
}

fn may_be_seen(instance: Instance) -> bool {
    let point = fetch_point(instance);
    let shape = fetch_shape(instance);
    // The quad's corners are √2 radii away.
    return surfel_may_face_eye(point, shape)
        && sphere_may_be_seen(point.position, 1.4143 * shape.radius * view.splat_scale);
}
