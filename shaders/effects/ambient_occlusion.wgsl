// Ambient occlusion (volumetric obscurance, Loos and Sloan 2010). The formula: scene/effects/ambient_occlusion.rs.

#import common/view.wgsl

// The fraction of the ambient light that reaches the surface at a pixel. `normal` is in view space and towards the eye.
fn openness(depths: texture_depth_2d, pixel: vec2i, normal: vec3f) -> f32 {
    // A branch of the shading pass: a separate pass would have to write what this one reads.
    if (parts.occlusion.strength == 0.0) {
        return 1.0;
    }
    // Not blended distances: sums of half floats are accurate to 1/2000 of the distance, a hundredth of a radius or
    // more. In two-pass modes the whole depth buffer is pushed back by a splat radius, so heights are unaffected.
    let depth = textureLoad(depths, pixel, 0);
    if (depth == 0.0) {
        return 1.0;
    }
    let radius_px = min(parts.occlusion.near_radius_px * depth, parts.occlusion.max_radius_px);
    // Converts relative distances to heights in radii.
    let heights = 0.5 * view.focal.y * view.viewport_px.y / radius_px;
    let facing = dot(normal, ray_through(vec2f(pixel) + 0.5));
    let last = vec2i(view.viewport_px) - 1;
    var lines = OCCLUSION_LINES;
    var filled = 0.0;
    var room = 0.0;
    for (var index = 0u; index < OCCLUSION_LINE_COUNT; index++) {
        let place = clamp(pixel + vec2i(floor(lines[index] * radius_px + 0.5)), vec2i(0), last);
        let aside = vec2f(place - pixel) / radius_px;
        let top = sqrt(max(1.0 - dot(aside, aside), 0.0));
        // Where the plane is not visible from the eye, it is far behind the ball.
        let facing_there = min(dot(normal, ray_through(vec2f(place) + 0.5)), -1e-6);
        let bottom = clamp(heights * (1.0 - facing / facing_there), -top, top);
        let depth_there = max(textureLoad(depths, place, 0), 1e-30);
        let height = heights * (1.0 - depth / depth_there) - OCCLUSION_ROUGHNESS;
        let nearness = clamp(2.0 + top - height, 0.0, 1.0);
        filled += (clamp(height, bottom, top) - bottom) * nearness;
        room += top - bottom;
    }
    return max(1.0 - parts.occlusion.strength * filled / max(room, 1e-6), 0.0);
}
