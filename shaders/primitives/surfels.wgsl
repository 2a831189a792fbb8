// A surfel is one quad.

fn amplified_vertex(instance: Instance) -> SplatVertex {
    return surfel_vertex(fetch_point(instance), fetch_shape(instance), vertex_of_record(instance));
}

fn may_be_seen(instance: Instance) -> bool {
    let point = fetch_point(instance);
    let shape = fetch_shape(instance);
    return surfel_may_face_eye(point, shape)
        && sphere_may_be_seen(point.position, SQUARE_REACH_RADII * shape.radius * view.splat_scale);
}

fn surfel_vertex(point: PointRecord, shape: ShapeRecord, corner: u32) -> SplatVertex {
    let n = oct_decode(shape.normal);
    let axes = half_axes(n, shape.ellipse);
    let q = quad_corner(corner);
    let radius = shape.radius * view.splat_scale;
    let center = offset_from_eye(point.position);
    let offset = center + (axes[0] * q.x + axes[1] * q.y) * radius;
    var clip = project(rotate_to_view(offset));
    // ε-z: the depth alone moves away along the ray, the footprint stays (one factor a surfel keeps it a plane).
    clip.z /= 1.0 + view.depth_slack * radius / max(length(center), view.near);
    return SplatVertex(clip, side_color(point.color, dot(n, center)), shape.normal, light_at_vertex(n, center, offset));
}

// The colour of the side of a surfel that is seen: of the back where the normal points away.
fn side_color(color: u32, away: f32) -> u32 {
    if (view.back_faces == BACK_FACES_DARKER && away > 0.0) {
        return pack4x8unorm(unpack4x8unorm(color) * vec4f(vec3f(BACK_SIDE), 1.0));
    }
    return color;
}

// True unless the whole surfel faces away. Errs towards true: the rasteriser has the last word, and where a surfel of a
// pixel or so is seen nearly edge on, that may turn it around. It rounds corners to a grid, of 1/16 pixel on the
// coarsest adapters: half a cell along both axes changes the area of a triangle as if the disk was 0.08 pixels thicker
// or thinner.
fn surfel_may_face_eye(point: PointRecord, shape: ShapeRecord) -> bool {
    let to_eye = -offset_from_eye(point.position);
    let distance = length(to_eye);
    let facing = dot(oct_decode(shape.normal), to_eye);
    let radius = shape.radius * view.splat_scale;
    let px_per_slope = min(view.px_per_slope.x, view.px_per_slope.y);
    // As thick as its disk is seen where it is farthest, beside 1/8 pixel.
    let is_thin = -facing * radius * px_per_slope < 0.125 * distance * (distance + SQUARE_REACH_RADII * radius);
    return view.back_faces != BACK_FACES_CULLED || facing > -1e-3 * distance || is_thin;
}
