// Brings the records of selected nodes together, so that strategies draw them as they draw all records of a cloud.

// Mirror: render/gpu/gpu_data.rs.
struct Gathering {
    // The first of these records among those that are selected, and how many they are.
    first: u32,
    count: u32,
    // From one record to the next; 0 where indices say which.
    step: u32,
    // On the second number of a record, which is a radius, unless it is 1.
    radius_factor: f32,
}

@group(GATHER_GROUP) @binding(0) var<uniform> gathering: Gathering;
@group(GATHER_GROUP) @binding(1) var<storage, read> indices: array<u32>;
@group(GATHER_GROUP) @binding(2) var<storage, read> nodes: array<vec4u>;
@group(GATHER_GROUP) @binding(3) var<storage, read_write> gathered: array<vec4u>;

@compute @workgroup_size(GROUP_RECORDS)
fn gather(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    for (var place = invocation.x; place < gathering.count; place += groups.x * GROUP_RECORDS) {
        let selected = gathering.first + place;
        var node = selected * gathering.step;
        if (gathering.step == 0u) {
            node = indices[selected];
        }
        var record = nodes[node];
        if (gathering.radius_factor != 1.0) {
            record.y = bitcast<u32>(bitcast<f32>(record.y) * gathering.radius_factor);
        }
        gathered[place] = record;
    }
}
