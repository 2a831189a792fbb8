// Visible points in a pyramid of screen cells. Twin of analysis/screen/cells.rs.

#import screen_normals/view.wgsl

// Number of cells of a level along both axes.
fn level_size(level: u32) -> vec2u {
    return (screening.size_px >> vec2u(level)) + 1u;
}

// Levels are stored one after the other.
fn cell_at(level: u32, place: vec2u) -> u32 {
    var start = 0u;
    for (var finer = 0u; finer < level; finer++) {
        let size = level_size(finer);
        start += size.x * size.y;
    }
    return start + place.y * level_size(level).x + place.x;
}

// The level whose windows cover a radius.
fn level_of(radius_px: f32) -> u32 {
    let cells_reached = radius_px / MAX_REACH_CELLS;
    var level = 0u;
    while (level < MAX_LEVELS && cells_reached > f32(1u << level)) {
        level++;
    }
    return level;
}

// The search radius for neighbours of a point, in pixels.
fn radius_px_at(depth: f32) -> f32 {
    return max(screening.radius * px_per_unit() / depth, MIN_RADIUS_PX);
}

// Chooses the first of the nearest points of each of the finest cells.
@compute @workgroup_size(GROUP_RECORDS)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= found.visible) {
        return;
    }
    let cell = places[places[screening.point_count + id.x]];
    // WGSL has no 64-bit atomics: `compact` found the nearest depth of each cell, and this pass finds the first point
    // at that depth. Depths and cells are the stored ones: recomputed, they might be fused differently.
    if (atomicLoad(&cell_keys[3u * cell]) == ~bitcast<u32>(seen_points[id.x].w)) {
        atomicMax(&cell_keys[3u * cell + 1u], ~id.x);
    }
}

// The cells of a level: the finest one is taken as is, each other one is built from four finer cells.
@compute @workgroup_size(GROUP_RECORDS)
fn coarsen(@builtin(global_invocation_id) id: vec3u) {
    let level = screening.level;
    let size = level_size(level);
    if (found.visible == 0u || level < found.finest || level > found.coarsest || id.x >= size.x * size.y) {
        return;
    }
    let place = vec2u(id.x % size.x, id.x / size.x);
    let cell = cell_at(level, place);
    var key = vec3u(0u);
    if (level == found.finest) {
        key = key_of(cell);
    } else {
        let finer_size = level_size(level - 1u);
        for (var row = 2u * place.y; row < min(2u * place.y + 2u, finer_size.y); row++) {
            for (var column = 2u * place.x; column < min(2u * place.x + 2u, finer_size.x); column++) {
                let finer = key_of(cell_at(level - 1u, vec2u(column, row)));
                let count = key.z + finer.z;
                if (finer.x > key.x || (finer.x == key.x && finer.y > key.y)) {
                    key = finer;
                }
                key.z = count;
            }
        }
        cell_keys_found[3u * cell] = key.x;
        cell_keys_found[3u * cell + 1u] = key.y;
        cell_keys_found[3u * cell + 2u] = key.z;
    }
    var center = vec3f(0.0);
    if (key.z > 0u) {
        center = seen_points[~key.y].xyz;
    }
    cells[cell] = vec4f(center, f32(key.z));
}

fn key_of(cell: u32) -> vec3u {
    return vec3u(cell_keys_found[3u * cell], cell_keys_found[3u * cell + 1u], cell_keys_found[3u * cell + 2u]);
}
