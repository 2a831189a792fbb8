// Disparities of rectified pairs. Twin of `stereo`, whose files give the reasons: census.rs, semi_global and local.rs,
// winner.rs and contrast.rs, refine.rs, filters.rs.
//
// Passes in order: `census` of both images; `along_path` eight times, or `sum_columns` and `sum_squares`;
// `find_winners`, `choose`; `meet` and `lay_on_planes` where positions between labels come from lines; `median`. Costs
// are computed where they are needed. Sums and labels match the CPU bit for bit.

#import generated/bindings
#import generated/stereo

fn is_in_image(pixel: vec2u) -> bool {
    return all(pixel < matching.size_px);
}

fn index_of(pixel: vec2u) -> u32 {
    return pixel.y * matching.size_px.x + pixel.x;
}

fn pixel_count() -> u32 {
    return matching.size_px.x * matching.size_px.y;
}

// Words per pixel that hold its labels.
fn word_count() -> u32 {
    return matching.count / 2u;
}

// Brightness of a pixel of either image.
fn brightness(index: u32) -> u32 {
    return (pixels[index / 4u] >> (8u * (index % 4u))) & 0xffu;
}

// The first pixel of a line of the right image.
fn right_line(y: u32) -> u32 {
    return pixel_count() + y * matching.size_px.x;
}

// Column of the right image that a label points to. It may be outside the image.
fn partner_of(x: u32, label: u32) -> i32 {
    return i32(x) - matching.min_px - i32(label);
}

// Hamming distance. Columns outside the other image repeat its border.
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
