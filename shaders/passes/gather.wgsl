// Gathers the records of selected nodes, so that strategies draw them like all records of a cloud.

#import generated/bindings
#import generated/constants

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
