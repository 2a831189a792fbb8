// The grid on the ground, occluded by surfaces in front of it. The plane and its lines: scene/view/ground.rs.

#import common/fullscreen.wgsl
#import common/view.wgsl

struct GridPixel {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

// The fraction of a pixel that lines cover. `place` is along both axes, and grows by `per_px` per pixel across the
// lines.
fn lines(place: vec2f, per_px: vec2f, spacing: f32) -> f32 {
    let cells = place / spacing;
    let cell_px = spacing / per_px;
    let from_line_px = abs(cells - round(cells)) * cell_px;
    let covered = clamp(1.0 - from_line_px, vec2f(0.0), vec2f(1.0));
    let width = (cell_px - NARROWEST_CELL_PX) / (WIDEST_CELL_PX - NARROWEST_CELL_PX);
    let shown = covered * clamp(width, vec2f(0.0), vec2f(1.0));
    return max(shown.x, shown.y);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> GridPixel {
    // Lines are as wide as the pixels of the displayed image.
    let slope_per_px = parts.grid.samples_per_edge * vec2f(2.0, -2.0) / (view.viewport_px * view.focal);
    let ray = ray_through(position.xy);
    let facing = dot(parts.grid.normal.xyz, ray);
    let distance = parts.grid.normal.w / facing;
    // Parallel to the plane, behind the eye or too near.
    if (abs(facing) < 1e-6 || distance <= view.near) {
        discard;
    }
    let along = vec2f(dot(parts.grid.right.xyz, ray), dot(parts.grid.forward.xyz, ray));
    let place = distance * along - vec2f(parts.grid.right.w, parts.grid.forward.w);
    // The derivative of distance · along: a quotient of two functions that are affine in pixels.
    // In closed form: GPUs would compute it from differences inside a pixel quad, and the CPU would draw other lines.
    let per_facing = along / facing;
    let right_per_px = (parts.grid.right.xy - per_facing.x * parts.grid.normal.xy) * slope_per_px;
    let forward_per_px = (parts.grid.forward.xy - per_facing.y * parts.grid.normal.xy) * slope_per_px;
    let per_px = max(distance * vec2f(length(right_per_px), length(forward_per_px)), vec2f(1e-30));
    let usual = USUAL_LINES * lines(place, per_px, parts.grid.spacing);
    let coarse = COARSE_LINES * lines(place, per_px, 10.0 * parts.grid.spacing);
    let fine = FINE_LINES * lines(place, per_px, 0.1 * parts.grid.spacing);
    let fading = clamp(2.0 - 2.0 * length(place) / parts.grid.color.w, 0.0, 1.0);
    let opacity = fading * max(max(usual, coarse), fine);
    if (opacity <= 0.0) {
        discard;
    }
    return GridPixel(vec4f(parts.grid.color.rgb, opacity), view.near / distance);
}
