// Strategy `uniform`: batches of 4096 records (64 KiB, the size every adapter can bind) and one draw for each.

const BATCH_RECORDS: u32 = 4096u;

struct PointBatch {
    records: array<PointRecord, BATCH_RECORDS>,
}

struct ShapeBatch {
    records: array<ShapeRecord, BATCH_RECORDS>,
}

@group(1) @binding(0) var<uniform> points: PointBatch;
@group(2) @binding(0) var<uniform> shapes: ShapeBatch;

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
