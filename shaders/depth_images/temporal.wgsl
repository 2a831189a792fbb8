// The running mean with the preceding images. Twin of rgbd/filters/temporal.rs. For the first image, means and ages are
// zero: nothing was measured before it.

#import depth_images/image.wgsl

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn mean_over_time(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    let now = before[index];
    let so_far = mean[index];
    if (now > 0.0) {
        let is_same = so_far > 0.0 && abs(now - so_far) <= imaging.same_m;
        mean[index] = select(now, so_far + imaging.newest_share * (now - so_far), is_same);
        ages[index] = 0u;
    } else if (ages[index] < imaging.fill_frames) {
        ages[index] += 1u;
    } else {
        mean[index] = 0.0;
    }
}
