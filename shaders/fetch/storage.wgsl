// Strategy `storage`: the vertex stage pulls records from storage buffers by index.

#import common/records.wgsl
#import generated/amplification
#import generated/constants

@group(STREAM_GROUP) @binding(0) var<storage, read> points: array<PointRecord>;
@group(SHAPE_GROUP) @binding(0) var<storage, read> shapes: array<ShapeRecord>;

struct Instance {
    @builtin(vertex_index) vertex: u32,
}

fn fetch_point(instance: Instance) -> PointRecord {
    return points[instance.vertex / VERTICES_PER_RECORD];
}

fn fetch_shape(instance: Instance) -> ShapeRecord {
    return shapes[instance.vertex / VERTICES_PER_RECORD];
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex % VERTICES_PER_RECORD;
}
