// Selects which winners are retained, and refines their positions by a parabola. Twin of stereo/matching/winner.rs and
// stereo/matching/contrast.rs.

#import stereo/exact_share.wgsl
#import stereo/pair.wgsl

fn winner_at(index: u32) -> u32 {
    return winners[index] & (IS_UNIQUE - 1u);
}

// Whether the match is consistent with the reverse match to within 1 px.
fn agrees(pixel: vec2u, label: u32) -> bool {
    let partner = partner_of(pixel.x, label);
    if (partner < 0 || partner >= i32(matching.size_px.x)) {
        return false;
    }
    let of_partner = winners[right_line(pixel.y) + u32(partner)];
    return abs(i32(of_partner) - i32(label)) <= 1;
}

// True if the census window has no contrast.
fn is_even(pixel: vec2u) -> bool {
    let reach = vec2i(CENSUS_HALF_WIDTH, CENSUS_HALF_HEIGHT);
    let first = max(vec2i(pixel) - reach, vec2i(0));
    let last = min(vec2i(pixel) + reach, vec2i(matching.size_px) - 1);
    var min_value = 255u;
    var max_value = 0u;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let seen = brightness(index_of(vec2u(vec2i(x, y))));
            min_value = min(min_value, seen);
            max_value = max(max_value, seen);
        }
    }
    return max_value - min_value <= EVEN_WINDOW;
}

// The summed cost of a label at a pixel.
fn sum_at(index: u32, label: u32) -> u32 {
    return (sums[index * word_count() + label / 2u] >> (16u * (label % 2u))) & 0xffffu;
}

// The minimum of a parabola through the summed costs of the neighbouring pixels in the row.
fn lowest(pixel: vec2u, label: u32) -> f32 {
    if (label == 0u || label + 1u == matching.count) {
        return 0.0;
    }
    let first = max(i32(pixel.x) - PARABOLA_REACH, 0);
    let last = min(i32(pixel.x) + PARABOLA_REACH, i32(matching.size_px.x) - 1);
    var three = vec3i(0);
    for (var x = first; x <= last; x++) {
        let index = index_of(vec2u(u32(x), pixel.y));
        if (abs(i32(winner_at(index)) - i32(label)) <= 1) {
            three += vec3i(vec3u(sum_at(index, label - 1u), sum_at(index, label), sum_at(index, label + 1u)));
        }
    }
    let below = three.x - three.y;
    let above = three.z - three.y;
    if (below + above <= 0) {
        return 0.0;
    }
    return exact_share(below - above, 2 * (below + above));
}

@compute @workgroup_size(STEREO_TILE_PX, STEREO_TILE_PX)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    if (!is_in_image(id.xy)) {
        return;
    }
    let index = index_of(id.xy);
    let label = winner_at(index);
    var place = NO_LABEL;
    if ((winners[index] & IS_UNIQUE) != 0u && agrees(id.xy, label) && !is_even(id.xy)) {
        place = f32(label);
        if (matching.by_parabola != 0u) {
            place += lowest(id.xy, label);
        }
    }
    after[index] = place;
}
