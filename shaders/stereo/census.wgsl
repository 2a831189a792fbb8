// Census transform: whether each of the neighbours is darker. Twin of stereo/matching/census.rs.

#import stereo/pair.wgsl

@compute @workgroup_size(STEREO_TILE_PX, STEREO_TILE_PX)
fn census(@builtin(global_invocation_id) id: vec3u) {
    let size = matching.size_px;
    if (id.x >= size.x || id.y >= 2u * size.y) {
        return;
    }
    // The right image is stored below the left one.
    let is_right = id.y >= size.y;
    let first = select(0u, pixel_count(), is_right);
    let pixel = vec2u(id.x, id.y - select(0u, size.y, is_right));
    let own = brightness(first + index_of(pixel));
    let reach = vec2i(CENSUS_HALF_WIDTH, CENSUS_HALF_HEIGHT);
    var bits = vec2u(0u);
    for (var down = -reach.y; down <= reach.y; down++) {
        for (var across = -reach.x; across <= reach.x; across++) {
            if (across == 0 && down == 0) {
                continue;
            }
            let place = clamp(vec2i(pixel) + vec2i(across, down), vec2i(0), vec2i(size) - 1);
            let is_darker = brightness(first + index_of(vec2u(place))) < own;
            bits = vec2u((bits.x << 1u) | (bits.y >> 31u), (bits.y << 1u) | select(0u, 1u, is_darker));
        }
    }
    made_census[first + index_of(pixel)] = bits;
}
