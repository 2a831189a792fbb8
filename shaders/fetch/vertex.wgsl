// Strategy `vertex`: the hardware supplies the record as per-instance attributes. Packed colours and normals arrive as
// integers and are unpacked as everywhere else, so that no adapter's own conversion changes the image.

#import common/records.wgsl

struct Instance {
    @builtin(vertex_index) vertex: u32,
    @location(0) position: vec3f,
    @location(1) color: u32,
    @location(2) normal: u32,
    @location(3) radius: f32,
    @location(4) ellipse: u32,
    @location(5) scalar: f32,
}

fn fetch_point(instance: Instance) -> PointRecord {
    return PointRecord(instance.position, instance.color);
}

fn fetch_shape(instance: Instance) -> ShapeRecord {
    return ShapeRecord(instance.normal, instance.radius, instance.ellipse, instance.scalar);
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex;
}
