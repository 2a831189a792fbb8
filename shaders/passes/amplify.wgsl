// Strategy `compute`: potentially visible records become corners, in the order of the cloud, and one draw call for
// them.
//
// Three dispatches: `count` counts the records that each workgroup retains, `scan` turns the counts into offsets and
// writes the indirect draw, `emit` writes the corners. The order is that of the records, so blending gives the same
// result as with the other strategies.

#import common/quads.wgsl
#import common/scan.wgsl
#import generated/amplification
#import generated/constants
#import generated/outputs

fn keeps(record: u32) -> u32 {
    if (record >= arrayLength(&points)) {
        return 0u;
    }
    return select(0u, 1u, may_be_seen(Instance(record * VERTICES_PER_RECORD)));
}

@compute @workgroup_size(GROUP_RECORDS)
fn count(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    let sum = inclusive_scan(local, keeps(id.x));
    if (local == GROUP_RECORDS - 1u) {
        group_offsets[group.x] = sum;
    }
}

@compute @workgroup_size(GROUP_RECORDS)
fn scan(@builtin(local_invocation_index) local: u32) {
    let groups = arrayLength(&group_offsets);
    var total = 0u;
    for (var start = 0u; start < groups; start += GROUP_RECORDS) {
        let group = start + local;
        var sum = 0u;
        if (group < groups) {
            sum = group_offsets[group];
        }
        let through = inclusive_scan(local, sum);
        if (group < groups) {
            group_offsets[group] = total + through - sum;
        }
        total += retained[GROUP_RECORDS - 1u];
        workgroupBarrier();
    }
    if (local == 0u) {
        draw = DrawIndexedIndirect(total * DRAWN_PER_RECORD, 1u, 0u, 0, 0u);
    }
}

@compute @workgroup_size(GROUP_RECORDS)
fn emit(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    let keep = keeps(id.x);
    let through = inclusive_scan(local, keep);
    if (keep == 0u) {
        return;
    }
    let slot = group_offsets[group.x] + through - 1u;
    for (var vertex = 0u; vertex < VERTICES_PER_RECORD; vertex++) {
        vertices[slot * VERTICES_PER_RECORD + vertex] = amplified_vertex(Instance(id.x * VERTICES_PER_RECORD + vertex));
    }
}
