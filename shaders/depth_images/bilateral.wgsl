// The mean of the neighbours at a similar depth. Twin of rgbd/filters/bilateral.rs.

#import depth_images/image.wgsl

fn sigma_at(depth: f32) -> f32 {
    if (imaging.sigma_m > 0.0) {
        return imaging.sigma_m;
    }
    let beyond = depth - SENSOR_BEST_M;
    return imaging.noise_factor * (SENSOR_NOISE_M + SENSOR_NOISE_PER_M * beyond * beyond);
}

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn bilateral(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) local_index: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    read_tile(BILATERAL_REACH, group.xy, local_index);
    if (!is_in_image(id.xy)) {
        return;
    }
    let edge = tile_edge(BILATERAL_REACH);
    let corner = local.y * edge + local.x;
    let center = tile[corner + BILATERAL_REACH * edge + BILATERAL_REACH];
    if (center == 0.0) {
        after[index_of(id.xy)] = 0.0;
        return;
    }
    let sigma = sigma_at(center);
    let exponent_per_m2 = -0.5 * LOG2_E / (sigma * sigma);
    var weights = 0.0;
    // A sum of differences: a plane of constant depth is reproduced exactly.
    var sum = 0.0;
    for (var row = 0u; row <= 2u * BILATERAL_REACH; row++) {
        for (var column = 0u; column <= 2u * BILATERAL_REACH; column++) {
            let depth = tile[corner + row * edge + column];
            let difference = depth - center;
            let aside = vec2f(vec2i(vec2u(column, row)) - i32(BILATERAL_REACH));
            let exponent = exponent_per_m2 * difference * difference + imaging.exponent_per_px2 * dot(aside, aside);
            let weight = select(exp2(max(exponent, MIN_EXPONENT)), 0.0, depth == 0.0);
            weights += weight;
            sum += weight * difference;
        }
    }
    after[index_of(id.xy)] = center + sum / weights;
}
