// The grid on the ground, hidden by what is before it. The plane and its lines: scene/ground.rs.

struct GridPixel {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

// How much of a pixel lines cover. `place` is along both axes, and grows by `per_px` with each pixel across the lines.
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
    // Lines are as wide as pixels that are shown.
    let slope_per_px = view.samples_per_edge * vec2f(2.0, -2.0) / (view.viewport_px * view.focal);
    let ray = ray_through(position.xy);
    let facing = dot(view.ground_normal.xyz, ray);
    let distance = view.ground_normal.w / facing;
    // Along the plane, behind the eye and too near.
    if (abs(facing) < 1e-6 || distance <= view.near) {
        discard;
    }
    let along = vec2f(dot(view.ground_right.xyz, ray), dot(view.ground_forward.xyz, ray));
    let place = distance * along - vec2f(view.ground_right.w, view.ground_forward.w);
    // The derivative of distance · along: a quotient of two functions that are affine in pixels.
    let per_facing = along / facing;
    let right_per_px = (view.ground_right.xy - per_facing.x * view.ground_normal.xy) * slope_per_px;
    let forward_per_px = (view.ground_forward.xy - per_facing.y * view.ground_normal.xy) * slope_per_px;
    let per_px = max(distance * vec2f(length(right_per_px), length(forward_per_px)), vec2f(1e-30));
    let usual = USUAL_LINES * lines(place, per_px, view.ground_spacing);
    let coarse = COARSE_LINES * lines(place, per_px, 10.0 * view.ground_spacing);
    let fine = FINE_LINES * lines(place, per_px, 0.1 * view.ground_spacing);
    let fading = clamp(2.0 - 2.0 * length(place) / view.ground_color.w, 0.0, 1.0);
    let opacity = fading * max(max(usual, coarse), fine);
    if (opacity <= 0.0) {
        discard;
    }
    return GridPixel(vec4f(view.ground_color.rgb, opacity), view.near / distance);
}
