// The nodes of a byte code that are drawn in a view, level by level. Twin of levels/octree/coded/expand.rs.
//
// For each level three dispatches: `classify` tests the nodes of the queue and counts within workgroups how many are
// drawn, and how many children the divided ones have; `scan` turns the counts into offsets, and sizes the dispatches of
// the next level; `divide` lists the drawn nodes, and writes the next queue.

#import coded/code.wgsl
#import common/scan.wgsl

// A queue of one node: the root.
@compute @workgroup_size(1)
fn begin() {
    next_queue[0] = vec4u(0u);
    found.queued[0] = 1u;
    found.queued[1] = 0u;
    found.drawn = 0u;
    groups[0] = DispatchIndirect(vec3u(1u), 0u);
}

fn is_outside(offset: vec3f, node_radius: f32) -> bool {
    // More than the radius, to cover rounding.
    let radius = node_radius * 1.001 + 1e-5 * length(offset);
    var nearest = dot(offset, expanding.forward);
    for (var side = 0u; side < 4u; side++) {
        nearest = min(nearest, dot(offset, expanding.sides[side].xyz));
    }
    return nearest < -radius;
}

fn faces_away(attributes: vec2u, offset: vec3f, radius: f32) -> bool {
    let distance = length(offset);
    let cone = cone_of(attributes);
    if (distance <= radius || cone.y <= 0.0) {
        return false;
    }
    // Of the angle between the directions to the centre and to the border of the sphere.
    let border_sine = radius / distance;
    let border_cosine = sqrt(1.0 - border_sine * border_sine);
    let facing = dot(bitcast<vec3f>(normal_of(attributes).xyz), offset) / distance;
    return cone.y * border_cosine > cone.x * border_sine
        && facing > cone.x * border_cosine + cone.y * border_sine;
}

fn is_small(offset: vec3f, edge: f32) -> bool {
    let reach = abs(expanding.forward);
    let nearest = dot(offset, expanding.forward) - 0.5 * edge * (reach.x + reach.y + reach.z);
    return nearest > expanding.near && edge * (expanding.px_per_slope / nearest) < expanding.lod_px;
}

// Nodes that are drawn instead of one, in the upper half, and children that are queued, in the lower half.
fn counts_of(node: vec4u) -> u32 {
    let attributes = attributes_of(number_of(node));
    let edge = edge_of_level(expanding.level);
    let offset = (center_of(node) - expanding.eye_high) - expanding.eye_low;
    let half_diagonal = LARGEST_OFFSET * edge;
    let of_own = expanding.reach_radii * (radius_edges(attributes) * edge + edge);
    if (is_outside(offset, half_diagonal + min(expanding.reach, of_own))) {
        return 0u;
    }
    if (expanding.culls_back_faces == 1u && faces_away(attributes, offset, half_diagonal)) {
        return 0u;
    }
    if (expanding.level >= expanding.deepest_level || is_small(offset, edge)) {
        let facing = dot(bitcast<vec3f>(normal_of(attributes).xyz), offset);
        return select(1u << 16u, 0u, expanding.culls_by_own_normals == 1u && facing > 0.0);
    }
    return countOneBits(mask_of(number_of(node)));
}

fn queued() -> u32 {
    return found.queued[expanding.level % 2u];
}

@compute @workgroup_size(GROUP_RECORDS)
fn classify(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    var counts = 0u;
    if (id.x < queued()) {
        counts = counts_of(queue[id.x]);
    }
    let through = inclusive_scan(local, counts);
    if (id.x < queued()) {
        places[id.x] = vec2u(counts, through - counts);
    }
    if (local == GROUP_RECORDS - 1u) {
        sums[group.x] = vec2u(through >> 16u, through & 0xffffu);
    }
}

@compute @workgroup_size(GROUP_RECORDS)
fn scan(@builtin(local_invocation_index) local: u32) {
    let group_count = (queued() + GROUP_RECORDS - 1u) / GROUP_RECORDS;
    // The same number of rounds for all, as the barriers require: what was read from a buffer might differ.
    let max_groups = (expanding.max_queued + GROUP_RECORDS - 1u) / GROUP_RECORDS;
    var total = vec2u(found.drawn, 0u);
    for (var start = 0u; start < max_groups; start += GROUP_RECORDS) {
        let group = start + local;
        var sum = vec2u(0u);
        if (group < group_count) {
            sum = sums[group];
        }
        let drawn = inclusive_scan(local, sum.x);
        var all = vec2u(retained[GROUP_RECORDS - 1u], 0u);
        workgroupBarrier();
        let children = inclusive_scan(local, sum.y);
        all.y = retained[GROUP_RECORDS - 1u];
        if (group < group_count) {
            sums[group] = total + vec2u(drawn, children) - sum;
        }
        total += all;
        workgroupBarrier();
    }
    if (local == 0u) {
        found.drawn = total.x;
        found.queued[(expanding.level + 1u) % 2u] = total.y;
        let next_groups = (total.y + GROUP_RECORDS - 1u) / GROUP_RECORDS;
        groups[(expanding.level + 1u) % 2u] = DispatchIndirect(vec3u(next_groups, 1u, 1u), 0u);
    }
}

@compute @workgroup_size(GROUP_RECORDS)
fn divide(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    if (id.x >= queued()) {
        return;
    }
    let node = queue[id.x];
    let counts = places[id.x].x;
    let place = sums[group.x] + vec2u(places[id.x].y >> 16u, places[id.x].y & 0xffffu);
    if (counts >> 16u != 0u) {
        drawn_nodes[place.x] = node;
    } else if (counts != 0u) {
        let first = first_child(number_of(node));
        var octants = mask_of(number_of(node));
        for (var child = 0u; child < counts; child++) {
            let octant = firstTrailingBit(octants);
            octants &= octants - 1u;
            next_queue[place.y + child] = child_of(node, octant, first + child);
        }
    }
}
