// Sub-label refinement, and fitting to the planes of surfaces. Twin of stereo/matching/refine.rs.

#import stereo/exact_share.wgsl
#import stereo/pair.wgsl

// First and last pixel of the square around a pixel.
fn square_around(pixel: vec2u) -> vec4i {
    let first = max(vec2i(pixel) - REFINE_REACH, vec2i(0));
    return vec4i(first, min(vec2i(pixel) + REFINE_REACH, vec2i(matching.size_px) - 1));
}

// Costs of a label and its two neighbours at a pixel; 0 in `w` where the other image does not have them all.
fn costs_around(pixel: vec2u, label: i32) -> vec4i {
    let partner = i32(pixel.x) - matching.min_px - label;
    if (partner < 1 || partner + 1 >= i32(matching.size_px.x)) {
        return vec4i(0);
    }
    let own = census_bits[index_of(pixel)];
    let line = right_line(pixel.y);
    let below = cost(own, line, partner + 1);
    return vec4i(vec4u(below, cost(own, line, partner), cost(own, line, partner - 1), 1u));
}

// Where two lines of opposite slope through the costs of a square meet.
@compute @workgroup_size(STEREO_TILE_PX, STEREO_TILE_PX)
fn meet(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    let label = before[index];
    if (label == NO_LABEL) {
        after[index] = NO_LABEL;
        return;
    }
    let square = square_around(id.xy);
    var three = vec3i(0);
    for (var y = square.y; y <= square.w; y++) {
        for (var x = square.x; x <= square.z; x++) {
            let near = vec2u(vec2i(x, y));
            if (abs(label - before[index_of(near)]) <= 1.0) {
                three += costs_around(near, i32(label)).xyz;
            }
        }
    }
    let below = three.x - three.y;
    let above = three.z - three.y;
    let steeper = max(below, above);
    var place = label;
    if (steeper > 0) {
        place += exact_share(below - above, 2 * steeper);
    }
    after[index] = place;
}

@compute @workgroup_size(STEREO_TILE_PX, STEREO_TILE_PX)
fn lay_on_planes(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    let own = before[index];
    if (own == NO_LABEL) {
        after[index] = NO_LABEL;
        return;
    }
    let square = square_around(id.xy);
    var count = 0.0;
    // Sums of x, y and the step from this pixel.
    var first = vec3f(0.0);
    // Sums of x · x, x · y and y · y.
    var squares = vec3f(0.0);
    var products = vec2f(0.0);
    for (var y = square.y; y <= square.w; y++) {
        for (var x = square.x; x <= square.z; x++) {
            let step = before[index_of(vec2u(vec2i(x, y)))] - own;
            if (abs(step) <= 1.0) {
                let aside = vec2f(vec2i(x, y) - vec2i(id.xy));
                count += 1.0;
                first += vec3f(aside, step);
                squares += vec3f(aside.x * aside.x, aside.x * aside.y, aside.y * aside.y);
                products += step * aside;
            }
        }
    }
    let mean = first / count;
    let xx = squares.x - count * mean.x * mean.x;
    let xy = squares.y - count * mean.x * mean.y;
    let yy = squares.z - count * mean.y * mean.y;
    let along = products - count * mean.z * mean.xy;
    let determinant = xx * yy - xy * xy;
    var place = own;
    if (determinant >= 1.0) {
        let slope = vec2f(yy * along.x - xy * along.y, xx * along.y - xy * along.x) / determinant;
        place += clamp(mean.z - dot(slope, mean.xy), -1.0, 1.0);
    }
    after[index] = place;
}
