// Filters of depth images, and the points of their pixels. Twin of rgbd/filters and rgbd/cloud.rs, whose files have the
// names of these and say why.
//
// Passes one after the other: `near` turns the numbers of a camera into metres and drops what is too near or too far,
// `median`, `bilateral`, `flying` and `erode` read one image and write another, `mean_over_time` goes on with the image
// that is left of the frames before, and `reproject` makes a point of every pixel. Depths are metres, 0 where nothing
// was measured; there are no infinities and nothing that is no number.

// Mirror: render/gpu/gpu_data.rs.
struct DepthImaging {
    size_px: vec2u,
    near_m: f32,
    far_m: f32,
    // What the middle of the points is moved to, in the frame of the camera.
    origin: vec3f,
    // Whether samples are numbers of 16 bits, two in a word, that the table explains; else they are metres.
    is_coded: u32,
    // Exponent of 2 by the square of the distance in pixels.
    exponent_per_px2: f32,
    // Of the bilateral filter, if it is the same everywhere, else 0.
    sigma_m: f32,
    noise_factor: f32,
    // Within what neighbours are near.
    flying_m: f32,
    flying_share: f32,
    least_neighbours: f32,
    newest_share: f32,
    same_m: f32,
    fill_frames: u32,
    has_colors: u32,
    // Of all points where there is no image of colours: red, green, blue, alpha.
    one_color: u32,
    unused: u32,
}

@group(DEPTH_GROUP) @binding(0) var<uniform> imaging: DepthImaging;
@group(DEPTH_GROUP) @binding(1) var<storage, read> samples: array<u32>;
// Metres of each number.
@group(DEPTH_GROUP) @binding(2) var<storage, read> table: array<f32>;
@group(DEPTH_GROUP) @binding(3) var<storage, read> before: array<f32>;
@group(DEPTH_GROUP) @binding(4) var<storage, read_write> after: array<f32>;
// Of the frames so far, and for how many frames each pixel was a hole.
@group(DEPTH_GROUP) @binding(5) var<storage, read_write> mean: array<f32>;
@group(DEPTH_GROUP) @binding(6) var<storage, read_write> ages: array<u32>;
// x and y at a depth of 1; NO_RAY where the lens shows nothing.
@group(DEPTH_GROUP) @binding(7) var<storage, read> rays: array<vec2f>;
// Bytes of red, green and blue, one pixel after the other.
@group(DEPTH_GROUP) @binding(8) var<storage, read> colors: array<u32>;
@group(DEPTH_GROUP) @binding(9) var<storage, read_write> made_points: array<PointRecord>;

// The pixels of a workgroup with those around them that it reads.
var<workgroup> tile: array<f32, DEPTH_TILE_VALUES>;

fn is_in_image(pixel: vec2u) -> bool {
    return all(pixel < imaging.size_px);
}

fn index_of(pixel: vec2u) -> u32 {
    return pixel.y * imaging.size_px.x + pixel.x;
}

// Edge of a tile that has so many pixels around those of its workgroup.
fn tile_edge(reach: u32) -> u32 {
    return DEPTH_TILE_PX + 2u * reach;
}

// Reads the tile of a workgroup; beside the image nothing was measured.
fn read_tile(reach: u32, group: vec2u, local: u32) {
    let edge = tile_edge(reach);
    let corner = vec2i(group * DEPTH_TILE_PX) - i32(reach);
    for (var place = local; place < edge * edge; place += DEPTH_TILE_PX * DEPTH_TILE_PX) {
        let pixel = corner + vec2i(vec2u(place % edge, place / edge));
        var depth = 0.0;
        if (all(pixel >= vec2i(0)) && all(pixel < vec2i(imaging.size_px))) {
            depth = before[index_of(vec2u(pixel))];
        }
        tile[place] = depth;
    }
    workgroupBarrier();
}
