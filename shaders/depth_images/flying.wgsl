// Removes flying pixels, those between a surface and its background. Twin of rgbd/filters/flying.rs.

#import depth_images/image.wgsl

// How many of a pixel's eight neighbours are at its depth. Precondition: the pixel has a measured depth.
fn near_neighbours(corner: u32, edge: u32) -> f32 {
    let center = tile[corner + edge + 1u];
    let max_value = max(center * imaging.flying_share, imaging.flying_m);
    // The centre itself is counted too.
    var count = -1.0;
    for (var row = 0u; row < 3u; row++) {
        for (var column = 0u; column < 3u; column++) {
            let depth = tile[corner + row * edge + column];
            count += select(0.0, 1.0, depth != 0.0 && abs(depth - center) <= max_value);
        }
    }
    return count;
}

// Retains the pixels of a workgroup that have at least `min_value` neighbours at their depth.
fn keep_flying(min_value: f32, pixel: vec2u, local: vec2u, local_index: u32, group: vec2u) {
    read_tile(1u, group, local_index);
    if (!is_in_image(pixel)) {
        return;
    }
    let edge = tile_edge(1u);
    let corner = local.y * edge + local.x;
    let depth = tile[corner + edge + 1u];
    let is_retained = depth != 0.0 && near_neighbours(corner, edge) >= min_value;
    after[index_of(pixel)] = select(0.0, depth, is_retained);
}

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn flying(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) local_index: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    keep_flying(imaging.min_neighbours, id.xy, local.xy, local_index, group.xy);
}

// Also removes pixels without eight neighbours at their depth: one more pixel along every edge.
@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn erode(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) local_index: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    keep_flying(8.0, id.xy, local.xy, local_index, group.xy);
}
