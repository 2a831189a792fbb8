// A point is a square that faces the screen; one-pixel points are single vertices of a point list. Attributes beyond
// position and colour: `points_*.wgsl`.

#import common/quads.wgsl
#import common/view.wgsl
#import generated/amplification
#import generated/constants

fn amplified_vertex(instance: Instance) -> SplatVertex {
    let point = fetch_point(instance);
    let shape = point_shape(instance);
    if (shape.radius == RADIUS_OF_NOTHING) {
        return nowhere();
    }
    let center = rotate_to_view(offset_from_eye(point.position));
    var place = center;
    var clip = project(center);
    if (VERTICES_PER_RECORD > 1u) {
        let corner = quad_corner(vertex_of_record(instance));
        let half_edge = 0.5 * (view.point_edge + view.point_edge_per_radius * shape.radius);
        let min_value = view.point_min_px / view.viewport_px * clip.w;
        // Half edges times the focal length.
        let half = max(half_edge * view.focal, min_value);
        place += vec3f(corner * half / view.focal, 0.0);
        clip += vec4f(corner * half, 0.0, 0.0);
        // ε-z, as for surfels.
        clip.z /= 1.0 + view.depth_slack * (half.y / view.focal.y) / max(length(center), view.near);
    }
    let light = point_light(shape, center, place);
    return SplatVertex(clip, point.color, shape.normal, pack2x16unorm(light), 1.0);
}
