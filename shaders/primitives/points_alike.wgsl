// Points without further attributes.

#import common/records.wgsl

fn point_shape(instance: Instance) -> ShapeRecord {
    return ShapeRecord(0u, 0.0, 0u, 0.0);
}

fn point_light(shape: ShapeRecord, center: vec3f, place: vec3f) -> vec2f {
    return vec2f(1.0, 0.0);
}
