// Occlusion culling: drops points that others hide. Twin of analysis/screen/cull.rs.

#import common/scan.wgsl
#import screen_normals/cells.wgsl
#import screen_normals/ramp.wgsl
#import screen_normals/view.wgsl

var<workgroup> group_nearest: atomic<u32>;
var<workgroup> group_farthest: atomic<u32>;

// Every point writes its depth at the pixel of its centre.
@compute @workgroup_size(GROUP_RECORDS)
fn draw(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    if (id.x < screening.point_count) {
        let point = points[id.x];
        let seen = see(point.position);
        let is_hole = screening.has_holes != 0u && point.color == 0u;
        var depth = 0u;
        if (is_in_picture(seen) && !is_hole) {
            // Positive f32 have the same order as their bits.
            depth = bitcast<u32>(seen.depth);
            let pixel = vec2u(seen.place_px);
            atomicMax(&nearest[pixel.y * screening.size_px.x + pixel.x], ~depth);
            atomicMax(&group_nearest, ~depth);
        }
        // Stored for `cull`: recomputed it might be fused differently, and a point would not be found in its own pixel.
        places[id.x] = depth;
    }
    workgroupBarrier();
    if (local == 0u) {
        atomicMax(&found.nearest, atomicLoad(&group_nearest));
    }
}

fn stride() -> u32 {
    return screening.size_px.x + 2u * BORDER_PX;
}

// Adds a border around the image.
@compute @workgroup_size(GROUP_RECORDS)
fn frame(@builtin(global_invocation_id) id: vec3u) {
    let size = screening.size_px;
    let place = vec2u(id.x % stride(), id.x / stride());
    if (place.y >= size.y + 2u * BORDER_PX) {
        return;
    }
    // Outside the image they wrap around to large values.
    let pixel = place - BORDER_PX;
    var depth = NO_DEPTH;
    if (all(pixel < size)) {
        let bits = nearest_drawn[pixel.y * size.x + pixel.x];
        if (bits != 0u) {
            depth = bitcast<f32>(~bits);
        }
    }
    depths[id.x] = depth;
}

@compute @workgroup_size(GROUP_RECORDS)
fn cull(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    var bits = 0u;
    if (id.x < screening.point_count) {
        bits = places[id.x];
    }
    var is_visible = false;
    if (bits != 0u) {
        let place_px = see(points[id.x].position).place_px;
        is_visible = !is_hidden(place_px, bitcast<f32>(bits));
    }
    if (is_visible) {
        atomicMax(&group_nearest, ~bits);
        atomicMax(&group_farthest, bits);
    }
    let through = inclusive_scan(local, select(0u, 1u, is_visible));
    if (id.x < screening.point_count) {
        places[id.x] = select(NOT_VISIBLE, through - 1u, is_visible);
    }
    if (local == GROUP_RECORDS - 1u) {
        places[first_sum() + group.x] = through;
        if (through > 0u) {
            atomicMax(&found.nearest_visible, atomicLoad(&group_nearest));
            atomicMax(&found.farthest_visible, atomicLoad(&group_farthest));
        }
    }
}

fn first_sum() -> u32 {
    return 2u * screening.point_count;
}

// Turns sums of workgroups into the indices of their first points, and determines which levels of cells exist.
@compute @workgroup_size(GROUP_RECORDS)
fn scan(@builtin(local_invocation_index) local: u32) {
    let groups = (screening.point_count + GROUP_RECORDS - 1u) / GROUP_RECORDS;
    var total = 0u;
    for (var start = 0u; start < groups; start += GROUP_RECORDS) {
        let group = start + local;
        var sum = 0u;
        if (group < groups) {
            sum = places[first_sum() + group];
        }
        let through = inclusive_scan(local, sum);
        if (group < groups) {
            places[first_sum() + group] = total + through - sum;
        }
        total += retained[GROUP_RECORDS - 1u];
        workgroupBarrier();
    }
    if (local == 0u) {
        found.visible = total;
        if (total > 0u) {
            found.finest = level_of(radius_px_at(bitcast<f32>(atomicLoad(&found.farthest_visible))));
            found.coarsest = level_of(2.0 * radius_px_at(bitcast<f32>(~atomicLoad(&found.nearest_visible))));
        }
    }
}

// Anything nearer than this covers a pixel at this number of steps: a point is as wide as the diagonal of a square of
// the spacing.
fn covers_below(steps: vec2u) -> vec2f {
    let half_width_px = 0.5 * sqrt(2.0) * screening.spacing * abs(screening.px_per_slope);
    let reach = half_width_px / max(vec2f(steps) - 0.5, vec2f(0.5));
    return select(reach, vec2f(NO_DEPTH), steps == vec2u(0u));
}

fn is_hidden(place_px: vec2f, depth: f32) -> bool {
    let pixel = min(vec2u(place_px), screening.size_px - 1u);
    let center = (pixel.y + BORDER_PX) * stride() + pixel.x + BORDER_PX;
    let limit = depth - screening.radius;
    let own = depths[center];
    let smallest = covers_below(vec2u(1u));
    if (own < depth && depth > min(smallest.x, smallest.y)) {
        // Of points smaller than a pixel, the nearest one survives.
        return true;
    }
    if (own >= limit && !is_covered(center, limit)) {
        return false;
    }
    return !is_on_plane_of_nearer(center, place_px - vec2f(pixel) - 0.5, depth);
}

// Whether anything nearer than `limit` covers the pixel at the centre.
fn is_covered(center: u32, limit: f32) -> bool {
    let nearest_depth = bitcast<f32>(~atomicLoad(&found.nearest));
    for (var row = 0u; row <= MAX_REACH_PX; row++) {
        if (row > 0u) {
            // Up to the reach of the nearest of all points.
            let reach = covers_below(vec2u(row));
            if (nearest_depth >= max(reach.x, reach.y)) {
                break;
            }
        }
        for (var column = 0u; column <= MAX_REACH_PX; column++) {
            let below = covers_below(vec2u(column, row));
            let covering = min(min(below.x, below.y), limit);
            let above = center - row * stride();
            let under = center + row * stride();
            let nearest_of_four = min(
                min(depths[above - column], depths[above + column]),
                min(depths[under - column], depths[under + column]),
            );
            if (nearest_of_four < covering) {
                return true;
            }
        }
    }
    return false;
}

// Lists the visible points in their order, and writes their depths to the finest cells.
@compute @workgroup_size(GROUP_RECORDS)
fn compact(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    if (id.x >= screening.point_count) {
        return;
    }
    let rank = places[id.x];
    if (rank == NOT_VISIBLE) {
        return;
    }
    let place = places[first_sum() + group.x] + rank;
    let seen = see(points[id.x].position);
    places[screening.point_count + place] = id.x;
    // Depth, and the cell below, are stored for `choose`: recomputed there, they might be fused differently.
    seen_points[place] = vec4f(seen.offset, seen.depth);
    let finest = found.finest;
    let cell = cell_at(finest, min(vec2u(seen.place_px), screening.size_px - 1u) >> vec2u(finest));
    places[id.x] = cell;
    atomicMax(&cell_keys[3u * cell], ~bitcast<u32>(seen.depth));
    atomicAdd(&cell_keys[3u * cell + 2u], 1u);
}
