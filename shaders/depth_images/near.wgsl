// Raw camera values → metres, within the depth range. Twin of rgbd/filters/range.rs.

#import depth_images/image.wgsl

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn near(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    var depth = 0.0;
    if (imaging.is_coded != 0u) {
        depth = table[(samples[index / 2u] >> (16u * (index % 2u))) & 0xffffu];
    } else {
        depth = bitcast<f32>(samples[index]);
    }
    let is_retained = depth >= imaging.near_m && depth <= imaging.far_m;
    after[index] = select(0.0, depth, is_retained);
}
