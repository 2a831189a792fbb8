// Strategy `uniform`: batches of BATCH_RECORDS with one draw call each.

#import common/records.wgsl
#import generated/amplification
#import generated/constants

struct PointBatch {
    records: array<PointRecord, BATCH_RECORDS>,
}

struct ShapeBatch {
    records: array<ShapeRecord, BATCH_RECORDS>,
}

@group(STREAM_GROUP) @binding(0) var<uniform> points: PointBatch;
@group(SHAPE_GROUP) @binding(0) var<uniform> shapes: ShapeBatch;

struct Instance {
    @builtin(vertex_index) vertex: u32,
}

fn fetch_point(instance: Instance) -> PointRecord {
    return points.records[instance.vertex / VERTICES_PER_RECORD];
}

fn fetch_shape(instance: Instance) -> ShapeRecord {
    return shapes.records[instance.vertex / VERTICES_PER_RECORD];
}

fn vertex_of_record(instance: Instance) -> u32 {
    return instance.vertex % VERTICES_PER_RECORD;
}
