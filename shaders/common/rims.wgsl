// The colour behind soft edges of splats (scene/effects/rims.rs). A pass that includes this defines two functions of a
// pixel: `sum_at`, sums of colours and weights, and `depth_at`, a reversed depth.

#import common/view.wgsl
#import generated/constants

fn opacity_at(pixel: vec2i) -> f32 {
    return min(sum_at(pixel).a / parts.resolving.opaque_weight, 1.0);
}

fn color_at(pixel: vec2i) -> vec3f {
    let sum = sum_at(pixel);
    return sum.rgb / sum.a;
}

// Steps from a pixel to the first opaque one along a line; 0 if none is within reach, or a transparent one comes before
// it.
fn steps_to_opaque(pixel: vec2i, step: vec2i, max_value: i32) -> i32 {
    let size = vec2i(view.viewport_px);
    for (var steps = 1; steps <= max_value; steps++) {
        let at = pixel + steps * step;
        if (any(at < vec2i(0)) || any(at >= size)) {
            return 0;
        }
        let opacity = opacity_at(at);
        if (opacity >= RIM_OPAQUE) {
            return steps;
        }
        if (opacity < RIM_OPEN) {
            return 0;
        }
    }
    return 0;
}

// The colour behind a pixel between two ends of a line, at the given number of steps from each.
fn color_between(pixel: vec2i, line: vec2i, steps: i32, other_steps: i32) -> vec3f {
    let end = pixel - steps * line;
    let other_end = pixel + other_steps * line;
    let depth = depth_at(end);
    let other_depth = depth_at(other_end);
    var to_other = select(1.0, 0.0, depth < other_depth);
    // On a single surface, which end is farther would depend on rounding, and the two renderers would differ.
    if (min(depth, other_depth) >= GAP_ONE_SURFACE * max(depth, other_depth)) {
        to_other = f32(steps) / f32(steps + other_steps);
    }
    return mix(color_at(end), color_at(other_end), to_other);
}

// The colour behind the soft edge at a pixel; the fourth component is 0 if there is none.
fn behind_rim(pixel: vec2i) -> vec4f {
    let opacity = opacity_at(pixel);
    var found = vec4f(0.0);
    if (opacity < RIM_OPEN || opacity >= RIM_OPAQUE) {
        return found;
    }
    let max_value = i32(parts.resolving.rim_px);
    var lines = PIXEL_LINES;
    var shortest = 1e30;
    // One of the four lines is enough, unlike for gaps: along a straight edge, one line never ends.
    for (var line = 0; line < 4; line++) {
        let one = steps_to_opaque(pixel, -lines[line], max_value - 1);
        if (one == 0) {
            continue;
        }
        let other = steps_to_opaque(pixel, lines[line], max_value - one);
        let span = f32(one + other) * length(vec2f(lines[line]));
        if (other > 0 && span < shortest) {
            shortest = span;
            found = vec4f(color_between(pixel, lines[line], one, other), 1.0);
        }
    }
    return found;
}

// The colour of a pixel, composited over the surface behind its soft edge, if it has one.
fn over_rim(pixel: vec2i) -> vec4f {
    let opacity = opacity_at(pixel);
    let behind = behind_rim(pixel);
    if (behind.a == 0.0) {
        return vec4f(color_at(pixel), opacity);
    }
    return vec4f(mix(behind.rgb, color_at(pixel), opacity), 1.0);
}
