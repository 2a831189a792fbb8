// Surfels of the screen: what a picture shows of a cloud, and the surface around each of those points. Twin of
// analysis/screen, whose files have the names of these and say why.
//
// Passes one after the other: `draw` and `frame` make the picture of depths, `cull` and `scan` tell which points it
// shows, `compact` lists them in their order, `choose` and `coarsen` put them into cells, `surface` writes the records
// that are drawn, and `lend` gives normals to those without. What a pass has worked out is read by those after it and
// not worked out again: adapters may fuse the same operations differently in two programs.

#import common/records.wgsl
#import generated/bindings
#import generated/constants
#import generated/screen_normals

// What is known of all points. It begins with zeros, so of depths that are to be small it has the inverted bits.
struct Found {
    nearest: atomic<u32>,
    nearest_visible: atomic<u32>,
    farthest_visible: atomic<u32>,
    visible: u32,
    // Levels of cells that there are.
    finest: u32,
    coarsest: u32,
}

// A point in the picture.
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

// Whether a point is behind the near plane and its middle in the picture; nothing that is no number is.
fn is_in_picture(seen: Seen) -> bool {
    let is_before_end = seen.depth >= screening.near && seen.depth > 0.0 && seen.depth < NO_DEPTH;
    let size = vec2f(screening.size_px);
    return is_before_end && all(seen.place_px >= vec2f(0.0)) && all(seen.place_px < size);
}

// Pixels that a length covers at a distance of 1, along the axis where these are most.
fn px_per_unit() -> f32 {
    let px = abs(screening.px_per_slope);
    return max(px.x, px.y);
}
