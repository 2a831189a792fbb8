// The median of the labelled pixels among 3 × 3, as a disparity. Twin of stereo/matching/filters.rs.

#import stereo/pair.wgsl

@compute @workgroup_size(STEREO_TILE_PX, STEREO_TILE_PX)
fn median(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    if (before[index] == NO_LABEL) {
        after[index] = NO_LABEL;
        return;
    }
    let first = max(vec2i(id.xy) - 1, vec2i(0));
    let last = min(vec2i(id.xy) + 1, vec2i(matching.size_px) - 1);
    // Sorted.
    var around: array<f32, 9>;
    var count = 0;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let value = before[index_of(vec2u(vec2i(x, y)))];
            if (value == NO_LABEL) {
                continue;
            }
            var place = count;
            while (place > 0 && around[max(place - 1, 0)] > value) {
                around[place] = around[place - 1];
                place--;
            }
            around[place] = value;
            count++;
        }
    }
    after[index] = around[(count - 1) / 2] + f32(matching.min_px);
}
