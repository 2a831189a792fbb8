// Fast approximate antialiasing (Lottes 2009): finds edges in the finished image, and blends pixels next to them with
// their neighbour by the area that the edge covers. How: render/effects/fxaa.

#import common/fullscreen.wgsl
#import common/view.wgsl

fn color_at(pixel: vec2i) -> vec3f {
    let last = vec2i(view.viewport_px) - 1;
    return textureLoad(picture, clamp(pixel, vec2i(0), last), 0).rgb;
}

fn luma(color: vec3f) -> f32 {
    return dot(color, vec3f(FXAA_RED, FXAA_GREEN, FXAA_BLUE));
}

fn luma_at(pixel: vec2i) -> f32 {
    return luma(color_at(pixel));
}

// The distance in pixels from `pixel` to the end of the edge between it and the one at `neighbor`; and how much lighter
// both sides are there.
fn end_of_edge(pixel: vec2i, neighbor: vec2i, along: vec2i, border: f32, limit: f32) -> vec2f {
    var difference = 0.0;
    var steps = 0;
    while (steps < FXAA_SEARCH_STEPS && abs(difference) < limit) {
        steps++;
        let place = pixel + steps * along;
        difference = 0.5 * (luma_at(place) + luma_at(place + neighbor)) - border;
    }
    return vec2f(f32(steps), difference);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let own = color_at(pixel);
    let center = luma(own);
    let north = luma_at(pixel + vec2i(0, -1));
    let south = luma_at(pixel + vec2i(0, 1));
    let west = luma_at(pixel + vec2i(-1, 0));
    let east = luma_at(pixel + vec2i(1, 0));
    let max_value = max(center, max(max(north, south), max(west, east)));
    let contrast = max_value - min(center, min(min(north, south), min(west, east)));
    if (contrast < max(FXAA_MIN_CONTRAST, FXAA_MIN_SHARE * max_value)) {
        return vec4f(own, 1.0);
    }
    var corners = vec3f(0.0);
    var lumas: array<f32, 4>;
    for (var corner = 0; corner < 4; corner++) {
        let color = color_at(pixel + vec2i(corner & 1, corner >> 1u) * 2 - 1);
        corners += color;
        lumas[corner] = luma(color);
    }
    let across_rows = abs(lumas[0] + lumas[2] - 2.0 * west) + 2.0 * abs(north + south - 2.0 * center)
        + abs(lumas[1] + lumas[3] - 2.0 * east);
    let across_columns = abs(lumas[0] + lumas[1] - 2.0 * north) + 2.0 * abs(west + east - 2.0 * center)
        + abs(lumas[2] + lumas[3] - 2.0 * south);
    let is_along_row = across_rows >= across_columns;
    let along = select(vec2i(0, 1), vec2i(1, 0), is_along_row);
    let before = select(west, north, is_along_row);
    let after = select(east, south, is_along_row);
    let is_before = abs(before - center) >= abs(after - center);
    let neighbor = select(along.yx, -along.yx, is_before);
    let other = select(after, before, is_before);

    let border = 0.5 * (center + other);
    let limit = FXAA_END_OF_EDGE * abs(other - center);
    let back = end_of_edge(pixel, neighbor, -along, border, limit);
    let ahead = end_of_edge(pixel, neighbor, along, border, limit);
    let nearest = select(ahead, back, back.x < ahead.x);
    // The edge turns towards this pixel where its nearer end has the luma of the other side.
    let turns_here = (nearest.y < 0.0) != (center < border);
    // Lengths between pixel centres approximate the area coverage of straight edges: the error on the outline of a cube
    // is 0.06 of a pixel on average, 0.09 with four samples per pixel, 0.25 without antialiasing.
    let share = select(0.0, 0.5 - (nearest.x - 0.5) / (back.x + ahead.x - 1.0), turns_here);
    let smooth_edge = mix(own, color_at(pixel + neighbor), share);

    // Details smaller than a pixel are blended with their surroundings.
    let detail = abs(0.25 * (north + south + west + east) - center) / contrast - FXAA_DETAIL;
    let blended = clamp(detail / (1.0 - FXAA_DETAIL), 0.0, FXAA_MAX_BLENDED);
    let sides = color_at(pixel + vec2i(0, -1)) + color_at(pixel + vec2i(0, 1)) + color_at(pixel + vec2i(-1, 0))
        + color_at(pixel + vec2i(1, 0));
    let around = (own + sides + corners) / 9.0;
    return vec4f(mix(smooth_edge, around, blended), 1.0);
}
