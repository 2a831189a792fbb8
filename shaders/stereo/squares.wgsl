// Costs summed over squares: over columns first, then over the sums of columns, each as a running sum that adds one
// value and subtracts another per pixel. Costs outside the image repeat the border's. Twin of stereo/matching/local.rs.

#import stereo/pair.wgsl

@compute @workgroup_size(STEREO_LANES)
fn sum_columns(@builtin(global_invocation_id) id: vec3u) {
    let words = word_count();
    let size = matching.size_px;
    if (id.x >= size.x * words) {
        return;
    }
    let x = id.x / words;
    let word = id.x % words;
    let last = i32(size.y) - 1;
    let radius = i32(matching.radius_px);
    let first = i32(id.y * STEREO_STRIP_PX);
    var sum = 0u;
    for (var y = first - radius; y < first + radius; y++) {
        sum += two_costs(vec2u(x, u32(clamp(y, 0, last))), word);
    }
    for (var y = first; y <= min(first + i32(STEREO_STRIP_PX) - 1, last); y++) {
        sum += two_costs(vec2u(x, u32(min(y + radius, last))), word);
        columns[(u32(y) * size.x + x) * words + word] = sum;
        sum -= two_costs(vec2u(x, u32(max(y - radius, 0))), word);
    }
}

@compute @workgroup_size(STEREO_LANES)
fn sum_squares(@builtin(global_invocation_id) id: vec3u) {
    let words = word_count();
    let size = matching.size_px;
    if (id.x >= size.y * words) {
        return;
    }
    // The first word of a pixel's column is `line` + its x · `words`.
    let line = id.x / words * size.x * words + id.x % words;
    let last = i32(size.x) - 1;
    let radius = i32(matching.radius_px);
    let first = i32(id.y * STEREO_STRIP_PX);
    var sum = 0u;
    for (var x = first - radius; x < first + radius; x++) {
        sum += columns[line + u32(clamp(x, 0, last)) * words];
    }
    for (var x = first; x <= min(first + i32(STEREO_STRIP_PX) - 1, last); x++) {
        sum += columns[line + u32(min(x + radius, last)) * words];
        sums[line + u32(x) * words] = sum;
        sum -= columns[line + u32(max(x - radius, 0)) * words];
    }
}
