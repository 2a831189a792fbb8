// Screen-space surfels: the visible points of a cloud in an image, and the surface around each of those points. Twin of
// analysis/screen, whose files have the same names as these and give the reasons.
//
// Passes in order: `draw` and `frame` make the depth image, `cull` and `scan` determine which points it shows,
// `compact` lists them in their order, `choose` and `coarsen` sort them into cells, `surface` writes the records that
// are drawn, and `lend` gives normals to those without. The result of a pass is read by later ones and not recomputed:
// adapters may fuse the same operations differently in two programs.

#import common/records.wgsl
#import generated/bindings
#import generated/constants
#import generated/screen_normals

// Results over all points. Zero-initialised, so depths that are minimised are stored with their bits inverted.
struct Found {
    nearest: atomic<u32>,
    nearest_visible: atomic<u32>,
    farthest_visible: atomic<u32>,
    visible: u32,
    // Range of the levels of cells.
    finest: u32,
    coarsest: u32,
}

// A point on the screen.
struct Seen {
    offset: vec3f,
    depth: f32,
    place_px: vec2f,
}

fn see(position: vec3f) -> Seen {
    return seen_from_eye((position - screening.eye_high) - screening.eye_low);
}

fn seen_from_eye(offset: vec3f) -> Seen {
    let in_view =
        screening.rotation_x * offset.x + screening.rotation_y * offset.y + screening.rotation_z * offset.z;
    let depth = -in_view.z;
    return Seen(offset, depth, in_view.xy / depth * screening.px_per_slope + screening.center_px);
}

// Whether a point is beyond the near plane and its centre in the image; false for NaN.
fn is_in_picture(seen: Seen) -> bool {
    let is_before_end = seen.depth >= screening.near && seen.depth > 0.0 && seen.depth < NO_DEPTH;
    let size = vec2f(screening.size_px);
    return is_before_end && all(seen.place_px >= vec2f(0.0)) && all(seen.place_px < size);
}

// Pixels covered by a unit length at distance 1, along the axis with more pixels.
fn px_per_unit() -> f32 {
    let px = abs(screening.px_per_slope);
    return max(px.x, px.y);
}
