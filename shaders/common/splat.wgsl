// Amplification: one record becomes the corners of quads. Shared by the vertex stage of the instanced strategies and by
// the compute pass of the amplifying one, so that all of them draw the same picture.

// A corner of a quad, ready for the rasteriser. Mirror: gpu_data.rs, `SplatVertex`.
struct SplatVertex {
    clip: vec4f,
    // 8-bit red, green, blue in the low bytes.
    color: u32,
    // Packed normal, see oct_decode.
    normal: u32,
    // See light.wgsl.
    light: vec2f,
}

// Corners 0 1 2 3 of a quad are (-1,-1) (1,-1) (-1,1) (1,1).
fn quad_corner(corner: u32) -> vec2f {
    return vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
}

// Paper 000 §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n and v = n × u.
fn surfel_vertex(point: PointRecord, shape: ShapeRecord, corner: u32) -> SplatVertex {
    let n = oct_decode(shape.normal);
    // `a` must not be parallel to n; the paper switches to a' only when it is, we do where the product loses digits.
    let a = select(vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, -1.0), abs(n.y) > 0.99);
    let u = normalize(cross(a, n));
    let v = cross(n, u);
    let q = quad_corner(corner);
    let radius = shape.radius * view.splat_scale;
    let center = offset_from_eye(point.position);
    let offset = center + (u * q.x + v * q.y) * radius;
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

// True unless the whole surfel faces away. Errs towards true: the rasteriser has the last word.
fn surfel_may_face_eye(point: PointRecord, shape: ShapeRecord) -> bool {
    let to_eye = -offset_from_eye(point.position);
    return view.back_faces != BACK_FACES_CULLED || dot(oct_decode(shape.normal), to_eye) > -1e-3 * length(to_eye);
}

// One of the three faces of a cell that can face the eye: `face` is 0, 1, 2 for x, y, z.
fn voxel_vertex(cell: PointRecord, face: u32, corner: u32) -> SplatVertex {
    let normal = pack2x16snorm(face_oct(face, towards_eye(cell, face)));
    return voxel_vertex_with_normal(cell, normal, face, corner);
}

// The side of a cell's face towards the eye. For an eye between the two planes it is turned away and culled.
fn towards_eye(cell: PointRecord, face: u32) -> f32 {
    return select(-1.0, 1.0, offset_from_eye(cell.position)[face] < 0.0);
}

// The same in the light that falls on a surface with a packed normal.
fn voxel_vertex_with_normal(cell: PointRecord, lit_normal: u32, face: u32, corner: u32) -> SplatVertex {
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
    let clip = project(rotate_to_view(offset));
    let light = light_at_vertex(oct_decode(lit_normal), face_center, offset);
    return SplatVertex(clip, cell.color, lit_normal, light);
}

// Not by `vector[axis] = length`: FXC, one of the two compilers for Direct3D 12, refuses it.
fn along_axis(axis: u32, length: f32) -> vec3f {
    return select(vec3f(0.0), vec3f(length), vec3u(0u, 1u, 2u) == vec3u(axis));
}

fn voxel_half_edge(cell: PointRecord) -> f32 {
    return ldexp(view.cube_half_edge, -i32(cell.color >> 24u));
}

// Octahedral code of an axis: exact.
fn face_oct(face: u32, towards: f32) -> vec2f {
    switch face {
        case 0u: { return vec2f(towards, 0.0); }
        case 1u: { return vec2f(0.0, towards); }
        default: { return select(vec2f(1.0, 1.0), vec2f(0.0, 0.0), towards > 0.0); }
    }
}

// True unless a sphere around `position` is outside the view: conservative, for the compute pass.
fn sphere_may_be_seen(position: vec3f, radius: f32) -> bool {
    let center = rotate_to_view(offset_from_eye(position));
    // Slopes of the side planes, times the focal length.
    let right_top = 1.0 - view.center_ndc;
    let left_bottom = 1.0 + view.center_ndc;
    // A little more than the radius, for the rounding of these few operations.
    let reach = radius * 1.001 + 1e-5 * length(center);
    // Distances to the side planes, times the length of their normals.
    let along = center.xy * view.focal;
    let beyond_right_top = right_top * center.z + along;
    let beyond_left_bottom = left_bottom * center.z - along;
    let is_near = beyond_right_top <= sqrt(view.focal * view.focal + right_top * right_top) * reach;
    let is_near_too = beyond_left_bottom <= sqrt(view.focal * view.focal + left_bottom * left_bottom) * reach;
    return all(is_near) && all(is_near_too) && -center.z + reach >= 0.0;
}

// A square of fixed size around a point.
fn point_vertex(point: PointRecord, corner: u32) -> SplatVertex {
    var clip = project(rotate_to_view(offset_from_eye(point.position)));
    clip += vec4f(quad_corner(corner) * view.point_size_px / view.viewport_px * clip.w, 0.0, 0.0);
    return SplatVertex(clip, point.color, 0u, vec2f(1.0, 0.0));
}
