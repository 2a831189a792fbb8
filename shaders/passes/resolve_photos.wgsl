// Resolve of a surface textured from images: like `resolve.wgsl`, after closing the gaps in the surface. Definition of
// a gap: scene/effects/gaps.rs.

#import common/blended_surface.wgsl
#import common/fullscreen.wgsl
#import common/photos.wgsl
#import common/rims.wgsl
#import generated/constants

// The first pixel of the surface along a line from a pixel, or the first one outside the image.
struct GapEnd {
    // 0: neither is within reach.
    steps: i32,
    // Reversed; 0 outside the image.
    depth: f32,
}

fn sum_at(pixel: vec2i) -> vec4f {
    return textureLoad(lit_colors, pixel, 0);
}

// Reversed. The depth buffer has depths that are pushed back.
fn depth_at(pixel: vec2i) -> f32 {
    return view.near / -blended_surface(vec2f(pixel) + 0.5).place.z;
}

fn gap_end(pixel: vec2i, step: vec2i, max_value: i32) -> GapEnd {
    let size = vec2i(view.viewport_px);
    for (var steps = 1; steps <= max_value; steps++) {
        let at = pixel + steps * step;
        if (any(at < vec2i(0)) || any(at >= size)) {
            return GapEnd(steps, 0.0);
        }
        if (opacity_at(at) >= GAP_SOLID) {
            return GapEnd(steps, depth_at(at));
        }
    }
    return GapEnd(0, 0.0);
}

// The reversed depth of the gap at a pixel; 0 if there is none.
fn depth_in_gap(pixel: vec2i, widest: i32) -> f32 {
    var lines = PIXEL_LINES;
    var found = 0.0;
    var shortest = 1e30;
    // The line along which a slit is open.
    var open_lines = 0;
    var is_at_border = false;
    for (var line = 0; line < 4; line++) {
        let one = gap_end(pixel, -lines[line], widest - 1);
        var other = GapEnd(0, 0.0);
        if (one.steps > 0) {
            other = gap_end(pixel, lines[line], widest - one.steps);
        }
        if (other.steps == 0) {
            open_lines++;
            if (open_lines > 1) {
                return 0.0;
            }
            continue;
        }
        let nearer = max(one.depth, other.depth);
        let farther = min(one.depth, other.depth);
        is_at_border = is_at_border || farther == 0.0;
        let span = f32(one.steps + other.steps) * length(vec2f(lines[line]));
        if (nearer > 0.0 && span < shortest) {
            shortest = span;
            let to_other = f32(one.steps) / f32(one.steps + other.steps);
            let of_plane = mix(one.depth, other.depth, to_other);
            let of_one = select(farther, nearer, farther == 0.0);
            found = select(of_one, of_plane, farther >= GAP_ONE_SURFACE * nearer);
        }
    }
    let is_slit = !is_at_border && GAPS_PER_SLIT * shortest <= f32(widest);
    return select(0.0, found, open_lines == 0 || is_slit);
}

// The colour of a pixel after gaps are closed, before specks are filled.
struct Resolved {
    color: vec4f,
    is_in_gap: bool,
}

fn gap_px() -> f32 {
    return textureLoad(photo_table, vec2u(1u, 0u), 0).x;
}

fn resolved(pixel: vec2i) -> Resolved {
    let sum = sum_at(pixel);
    let opacity = opacity_at(pixel);
    var is_in_gap = false;
    if (opacity < 1.0) {
        let in_gap = depth_in_gap(pixel, i32(gap_px()));
        is_in_gap = in_gap > 0.0;
        if (is_in_gap) {
            var depth = in_gap;
            if (sum.a > 0.0) {
                depth = depth_at(pixel);
            }
            let ray = ray_through(vec2f(pixel) + 0.5);
            let place = ray * (view.near / depth);
            let there = BlendedSurface(1.0, vec3f(0.0), place, -normalize(ray), vec3f(0.0));
            let answer = photo_answer(there, vec2u(pixel));
            if (answer.kind == ANSWER_SHOWN) {
                let surface = sum.rgb / max(sum.a, 1e-37);
                return Resolved(vec4f(mix(answer.color, surface, opacity), 1.0), true);
            }
        }
    }
    if (sum.a == 0.0) {
        return Resolved(vec4f(0.0), is_in_gap);
    }
    return Resolved(over_rim(pixel), is_in_gap);
}

// The first opaque pixel along a line from a pixel: its colour, and how many steps away it is; 0 if none is within
// reach.
fn opaque_end(pixel: vec2i, step: vec2i, max_value: i32) -> vec4f {
    let size = vec2i(view.viewport_px);
    for (var steps = 1; steps <= max_value; steps++) {
        let at = pixel + steps * step;
        if (any(at < vec2i(0)) || any(at >= size)) {
            break;
        }
        let color = resolved(at).color;
        if (color.a >= RIM_OPAQUE) {
            return vec4f(color.rgb, f32(steps));
        }
    }
    return vec4f(0.0);
}

// The mean colour of the opaque pixels on both sides of a pixel along each line, weighted by their nearness; the fourth
// component is 0 unless each of these pairs is at most `widest` steps apart.
fn mean_around(pixel: vec2i, widest: i32) -> vec4f {
    var lines = PIXEL_LINES;
    var sum = vec4f(0.0);
    for (var line = 0; line < 4; line++) {
        let one = opaque_end(pixel, -lines[line], widest - 1);
        if (one.a == 0.0) {
            return vec4f(0.0);
        }
        let other = opaque_end(pixel, lines[line], widest - i32(one.a));
        if (other.a == 0.0) {
            return vec4f(0.0);
        }
        sum += vec4f(one.rgb, 1.0) / one.a + vec4f(other.rgb, 1.0) / other.a;
    }
    return sum / sum.a;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let own = resolved(pixel);
    if (own.is_in_gap && own.color.a < RIM_OPAQUE) {
        let around = mean_around(pixel, i32(gap_px() / GAPS_PER_SPECK));
        if (around.a > 0.0) {
            return vec4f(mix(around.rgb, own.color.rgb, own.color.a), 1.0);
        }
    }
    if (own.color.a == 0.0) {
        discard;
    }
    return own.color;
}
