// The median of 5 × 5 pixels. Twin of rgbd/filters/median.rs: what is forgotten after which value (`center_of_window`)
// is written out by render/gpu/depth_images/network.rs.

#import depth_images/image.wgsl
#import generated/center_of_window

// What stands for the next hole: in turn less than all depths and more.
var<private> stands_for_hole: f32;

fn window_value(place: u32) -> f32 {
    let depth = tile[place];
    let is_hole = depth == 0.0;
    let value = select(depth, stands_for_hole, is_hole);
    stands_for_hole = select(stands_for_hole, NO_DEPTH - stands_for_hole, is_hole);
    return value;
}

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn median(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) local_index: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    read_tile(MEDIAN_REACH, group.xy, local_index);
    if (!is_in_image(id.xy)) {
        return;
    }
    let edge = tile_edge(MEDIAN_REACH);
    let corner = local.y * edge + local.x;
    stands_for_hole = 0.0;
    let center = center_of_window(corner, edge);
    let own = tile[corner + MEDIAN_REACH * edge + MEDIAN_REACH];
    after[index_of(id.xy)] = select(center, 0.0, own == 0.0);
}
