// Disparities of rectified pairs. Twin of `stereo`, whose files say why: census.rs, semi_global and local.rs, winner.rs
// and contrast.rs, refine.rs, filters.rs.
//
// Passes one after the other: `census` of both images; `along_path` eight times, or `sum_columns` and `sum_squares`;
// `find_winners`, `choose`; `meet` and `lay_on_planes` where places between labels are those of lines; `median`. Costs
// are worked out where they are asked for. Sums and labels are the processor's to the bit.

// Mirror: render/gpu/gpu_data.rs.
struct StereoMatching {
    size_px: vec2u,
    // Labels of a pixel, an even number; label k is the disparity `min_px` + k.
    count: u32,
    min_px: i32,
    // From pixel to pixel of a path.
    path_step: vec2i,
    // Whether the path writes sums, as it is the first one; else it adds to them.
    is_first_path: u32,
    radius_px: u32,
    p1: u32,
    p2_least: u32,
    p2_above_least: u32,
    half_change: u32,
    unique_percent: u32,
    // Whether places between labels are those of a parabola.
    by_parabola: u32,
}

@group(STEREO_GROUP) @binding(0) var<uniform> matching: StereoMatching;
// Brightnesses of the left image and behind it those of the right one, four in a word.
@group(STEREO_GROUP) @binding(1) var<storage, read> pixels: array<u32>;
// The bits of each of these pixels.
@group(STEREO_GROUP) @binding(2) var<storage, read> census_bits: array<vec2u>;
@group(STEREO_GROUP) @binding(3) var<storage, read_write> made_census: array<vec2u>;
// Of each pixel and label 16 bits: line by line, pixel by pixel, label by label.
@group(STEREO_GROUP) @binding(4) var<storage, read_write> columns: array<u32>;
@group(STEREO_GROUP) @binding(5) var<storage, read_write> sums: array<u32>;
// The label of each pixel of the left image, with IS_UNIQUE where no other is as good, and behind them those of the
// right one.
@group(STEREO_GROUP) @binding(6) var<storage, read_write> winners: array<u32>;
// Labels, NO_LABEL where there is none.
@group(STEREO_GROUP) @binding(7) var<storage, read> before: array<f32>;
@group(STEREO_GROUP) @binding(8) var<storage, read_write> after: array<f32>;

fn is_in_image(pixel: vec2u) -> bool {
    return all(pixel < matching.size_px);
}

fn index_of(pixel: vec2u) -> u32 {
    return pixel.y * matching.size_px.x + pixel.x;
}

fn pixel_count() -> u32 {
    return matching.size_px.x * matching.size_px.y;
}

// Words of a pixel's labels.
fn word_count() -> u32 {
    return matching.count / 2u;
}

// Of a pixel of either image.
fn brightness(index: u32) -> u32 {
    return (pixels[index / 4u] >> (8u * (index % 4u))) & 0xffu;
}

// The first pixel of a line of the right image.
fn right_line(y: u32) -> u32 {
    return pixel_count() + y * matching.size_px.x;
}

// Column of the right image that a label leads to. It may be beside the image.
fn partner_of(x: u32, label: u32) -> i32 {
    return i32(x) - matching.min_px - i32(label);
}

// How many bits differ. Beyond the other image is its border.
fn cost(own: vec2u, line: u32, partner: i32) -> u32 {
    let column = clamp(partner, 0, i32(matching.size_px.x) - 1);
    let differ = countOneBits(own ^ census_bits[line + u32(column)]);
    return differ.x + differ.y;
}

// The costs of both labels of a word.
fn two_costs(pixel: vec2u, word: u32) -> u32 {
    let own = census_bits[index_of(pixel)];
    let line = right_line(pixel.y);
    let partner = partner_of(pixel.x, 2u * word);
    return cost(own, line, partner) | (cost(own, line, partner - 1) << 16u);
}
