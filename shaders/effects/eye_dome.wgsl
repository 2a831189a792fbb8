// Eye-dome lighting (Boucheny 2009): darkens pixels behind their neighbours. Multiplies the drawn colours, or their
// sums, before the background is composited behind them. The formula: scene/effects/eye_dome.rs.

#import common/fullscreen.wgsl
#import common/view.wgsl

// x: contribution of a neighbour in front of the pixel; y: 1 if it is empty.
fn neighbour(pixel: vec2i, offset: vec2i, per_depth: f32, gain: f32) -> vec2f {
    let last = vec2i(view.viewport_px) - 1;
    let depth = textureLoad(depths, clamp(pixel + offset, vec2i(0), last), 0);
    let step = clamp(gain * (depth * per_depth - 1.0), 0.0, parts.eye_dome.max);
    return vec2f(step, select(0.0, 1.0, depth == 0.0));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let depth = textureLoad(depths, pixel, 0);
    if (depth == 0.0) {
        discard;
    }
    let per_depth = 1.0 / depth;
    let straight = parts.eye_dome.reach_px.x;
    let diagonal = parts.eye_dome.reach_px.y;
    var sum = vec2f(0.0);
    for (var side = -1; side <= 1; side += 2) {
        sum += neighbour(pixel, vec2i(side * straight, 0), per_depth, parts.eye_dome.gains.x);
        sum += neighbour(pixel, vec2i(0, side * straight), per_depth, parts.eye_dome.gains.x);
        sum += neighbour(pixel, vec2i(side, side) * diagonal, per_depth, parts.eye_dome.gains.y);
        sum += neighbour(pixel, vec2i(side, -side) * diagonal, per_depth, parts.eye_dome.gains.y);
    }
    let outside = sum.y / 8.0;
    let edge = parts.eye_dome.edge * outside * max(LONE - outside, 0.0);
    let shade = exp(-(sum.x + edge));
    return vec4f(vec3f(shade), 1.0);
}
