// One point per pixel, X = z · ray(u, v). Twin of rgbd/cloud.rs. Holes are points with colour 0, which are never drawn:
// the colours of images are opaque.

#import depth_images/image.wgsl

fn color_of(index: u32) -> u32 {
    if (imaging.has_colors == 0u) {
        return imaging.one_color;
    }
    let word = 3u * index / 4u;
    let shift = 8u * ((3u * index) % 4u);
    var bits = colors[word] >> shift;
    if (shift > 8u) {
        bits |= colors[word + 1u] << (32u - shift);
    }
    return bits | 0xff000000u;
}

@compute @workgroup_size(DEPTH_TILE_PX, DEPTH_TILE_PX)
fn reproject(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    let depth = before[index];
    let ray = rays[index];
    var made = PointRecord(vec3f(0.0), 0u);
    if (depth > 0.0 && depth < FARTHEST_POINT_M && all(abs(ray) < vec2f(NO_RAY))) {
        made = PointRecord(vec3f(ray * depth, depth) - imaging.origin, color_of(index));
    }
    made_points[index] = made;
}
