// Strategy `vertex` for primitives without a shape: the second vertex buffer is neither uploaded nor bound.

#import common/records.wgsl

struct Instance {
    @builtin(vertex_index) vertex: u32,
    @location(0) position: vec3f,
    @location(1) color: u32,
}

fn fetch_point(instance: Instance) -> PointRecord {
    return PointRecord(instance.position, instance.color);
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex;
}
