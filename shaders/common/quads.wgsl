// Amplification: one record becomes the corners of quads or of a triangle (`shaders/primitives/`). Shared by the vertex
// stage of the instanced strategies and by the compute pass of the amplifying one, so that all of them draw the same
// image.

#import common/view.wgsl
#import generated/amplification
#import generated/constants
#import generated/splat_vertex

// A corner of something that is not drawn: all are at one position outside the view.
fn nowhere() -> SplatVertex {
    return SplatVertex(vec4f(2.0, 2.0, 2.0, 1.0), 0u, 0u, 0u, 0.0);
}

// Corners 0 1 2 3 of a quad are (-1,-1) (1,-1) (-1,1) (1,1).
fn quad_corner(corner: u32) -> vec2f {
    return vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
}

// Corners 0 1 2 of the smallest equilateral triangle around the unit disk. Its area is 3√3, 1.3 times the quad's.
fn triangle_corner(corner: u32) -> vec2f {
    let neighbor = vec2f(sqrt(3.0) * (f32(corner) * 2.0 - 1.0), -1.0);
    return select(neighbor, vec2f(0.0, 2.0), corner == 2u);
}

// The position of a vertex in the plane of the quad or triangle, in which the unit disk or square is drawn.
fn corner_of(vertex: u32) -> vec2f {
    if (VERTICES_PER_RECORD == VERTICES_PER_TRIANGLE) {
        return triangle_corner(vertex % VERTICES_PER_TRIANGLE);
    }
    return quad_corner(vertex % VERTICES_PER_QUAD);
}

// Whether a position in the square of a point is outside its disk; the pixel that contains the point never is. Points
// larger than the minimum have that pixel inside their disk.
fn is_outside_disk(quad: vec2f) -> bool {
    let aside_px = abs(quad) * 0.5 * view.point_min_px;
    return dot(quad, quad) > 1.0 && max(aside_px.x, aside_px.y) > 0.5;
}

// Frustum culling: true unless a sphere around `position` is outside the view: conservative, for the compute pass.
fn sphere_may_be_seen(position: vec3f, radius: f32) -> bool {
    let center = rotate_to_view(offset_from_eye(position));
    // Slopes of the side planes, times the focal length.
    let right_top = 1.0 - view.center_ndc;
    let left_bottom = 1.0 + view.center_ndc;
    // Slightly more than the radius, to cover the rounding of these few operations.
    let reach = radius * 1.001 + 1e-5 * length(center);
    // Distances to the side planes, times the length of their normals.
    let along = center.xy * view.focal;
    let beyond_right_top = right_top * center.z + along;
    let beyond_left_bottom = left_bottom * center.z - along;
    let is_near = beyond_right_top <= sqrt(view.focal * view.focal + right_top * right_top) * reach;
    let is_near_too = beyond_left_bottom <= sqrt(view.focal * view.focal + left_bottom * left_bottom) * reach;
    return all(is_near) && all(is_near_too) && -center.z + reach >= 0.0;
}
