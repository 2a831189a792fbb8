// Filters of depth images, and the points of their pixels. Twin of rgbd/filters and rgbd/cloud.rs, whose files have the
// same names as these and give the reasons.
//
// Passes in order: `near` converts the raw values of a camera into metres and drops pixels that are too near or too
// far, `median`, `bilateral`, `flying` and `erode` read one image and write another, `mean_over_time` updates the
// running image of the preceding frames, and `reproject` makes a point of every pixel. Depths are in metres, 0 where
// nothing was measured; there are no infinities or NaNs.

#import common/records.wgsl
#import generated/bindings
#import generated/depth_images

// The pixels of a workgroup with the surrounding ones that it reads.
var<workgroup> tile: array<f32, DEPTH_TILE_VALUES>;

fn is_in_image(pixel: vec2u) -> bool {
    return all(pixel < imaging.size_px);
}

fn index_of(pixel: vec2u) -> u32 {
    return pixel.y * imaging.size_px.x + pixel.x;
}

// Edge of a tile with `reach` pixels around those of its workgroup.
fn tile_edge(reach: u32) -> u32 {
    return DEPTH_TILE_PX + 2u * reach;
}

// Reads the tile of a workgroup; outside the image nothing was measured.
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
