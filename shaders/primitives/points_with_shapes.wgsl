// A point has a radius and a normal.

#import common/light.wgsl
#import common/records.wgsl
#import common/view.wgsl

fn point_shape(instance: Instance) -> ShapeRecord {
    return fetch_shape(instance);
}

// In view space: the centre of the point, and one of its corners.
fn point_light(shape: ShapeRecord, center: vec3f, place: vec3f) -> vec2f {
    return light_at_vertex(rotate_to_view(oct_decode(shape.normal)), center, place);
}
