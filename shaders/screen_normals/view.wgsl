// Surfels of the screen: what a picture shows of a cloud, and the surface around each of those points. Twin of
// analysis/screen, whose files have the names of these and say why.
//
// Passes one after the other: `draw` and `frame` make the picture of depths, `cull` and `scan` tell which points it
// shows, `compact` lists them in their order, `choose` and `coarsen` put them into cells, `surface` writes the records
// that are drawn, and `lend` gives normals to those without. What a pass has worked out is read by those after it and
// not worked out again: adapters may fuse the same operations differently in two programs.

// Mirror: render/gpu/gpu_data.rs.
struct Screening {
    // Columns of the rotation from the axes of the cloud to those of the view (right, up, backward).
    rotation_x: vec3f,
    near: f32,
    rotation_y: vec3f,
    // In which neighbours are looked for, scene units.
    radius: f32,
    rotation_z: vec3f,
    spacing: f32,
    // The eye is `eye_high + eye_low`.
    eye_high: vec3f,
    // Factor on radii.
    closing: f32,
    eye_low: vec3f,
    has_sensor: u32,
    // Of the sensor from the eye.
    sensor: vec3f,
    point_count: u32,
    px_per_slope: vec2f,
    middle_px: vec2f,
    // Of the picture with its margin.
    size_px: vec2u,
    // The first record of what `surface` writes among all, and how many it writes.
    first: u32,
    count: u32,
    // Of the cells that `coarsen` writes.
    level: u32,
    // Whether points of no colour at all are holes of an image.
    has_holes: u32,
    unused_a: u32,
    unused_b: u32,
}

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

@group(SCREENING_GROUP) @binding(0) var<uniform> screening: Screening;
@group(SCREENING_GROUP) @binding(1) var<storage, read> points: array<PointRecord>;
@group(SCREENING_GROUP) @binding(2) var<storage, read_write> found: Found;
// Inverted bits of the depth of the nearest point of each pixel; zero where there is none.
@group(SCREENING_GROUP) @binding(3) var<storage, read_write> nearest: array<atomic<u32>>;
@group(SCREENING_GROUP) @binding(4) var<storage, read> nearest_drawn: array<u32>;
// The same as depths, with a border of BORDER_PX pixels.
@group(SCREENING_GROUP) @binding(5) var<storage, read_write> depths: array<f32>;
// Of each point the bits of its depth, then its place among those of its workgroup that are visible, then its cell.
// Behind these the visible points, and behind these the sums of workgroups.
@group(SCREENING_GROUP) @binding(6) var<storage, read_write> places: array<u32>;
// Visible points: from the eye, in the axes of the cloud, and depths.
@group(SCREENING_GROUP) @binding(7) var<storage, read_write> seen_points: array<vec4f>;
// Of each cell the inverted bits of the nearest depth, the inverted place of the first such point among the visible
// ones, and how many points it has.
@group(SCREENING_GROUP) @binding(8) var<storage, read_write> cell_keys: array<atomic<u32>>;
@group(SCREENING_GROUP) @binding(9) var<storage, read_write> cell_keys_found: array<u32>;
// Where the nearest point of each cell is, from the eye, and how many points there are.
@group(SCREENING_GROUP) @binding(10) var<storage, read_write> cells: array<vec4f>;
@group(SCREENING_GROUP) @binding(11) var<storage, read_write> drawn_points: array<PointRecord>;
@group(SCREENING_GROUP) @binding(12) var<storage, read_write> drawn_shapes: array<ShapeRecord>;
// Of visible points, or NO_NORMAL where there is no plane around.
@group(SCREENING_GROUP) @binding(13) var<storage, read_write> normals: array<u32>;

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
    return Seen(offset, depth, in_view.xy / depth * screening.px_per_slope + screening.middle_px);
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
