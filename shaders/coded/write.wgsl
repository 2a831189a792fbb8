// Surfels of the drawn nodes of a byte code as records, so that strategies draw them like all records of a cloud. Twin
// of `CodedCloud::surfel` in levels/octree/coded/expand.rs.

#import coded/code.wgsl

@compute @workgroup_size(GROUP_RECORDS)
fn write(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= expanding.count) {
        return;
    }
    let place = expanding.first + id.x;
    if (place >= found.drawn) {
        drawn_points[id.x] = PointRecord(vec3f(0.0), 0u);
        drawn_shapes[id.x] = ShapeRecord(0u, RADIUS_OF_NOTHING, 0u, 0.0);
        return;
    }
    let node = drawn_nodes[place];
    let attributes = attributes_of(number_of(node));
    let edge = edge_of_level(level_of(node));
    let normal = normal_of(attributes);
    let position = center_of(node) + offset_edges(attributes) * edge * bitcast<vec3f>(normal.xyz);
    drawn_points[id.x] = PointRecord(position, (attributes.y & 0xffffffu) | 0xff000000u);
    drawn_shapes[id.x] = ShapeRecord(normal.w, radius_edges(attributes) * edge, 0u, 0.0);
}
