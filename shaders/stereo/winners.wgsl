// The first of the cheapest labels of each pixel of both images; a workgroup handles one pixel of each. Twin of
// stereo/matching/winner.rs.

#import stereo/pair.wgsl

// A sum in the upper bits and its label in the lower ones: the smallest of these is the first of the cheapest.
var<workgroup> cheapest: atomic<u32>;
var<workgroup> cheapest_of_right: atomic<u32>;
// The smallest sum of the labels that are not next to the winner.
var<workgroup> other: atomic<u32>;

fn two_sums(index: u32, word: u32) -> vec2u {
    let both = sums[index * word_count() + word];
    return vec2u(both & 0xffffu, both >> 16u);
}

// For a pixel of the right image: the sum of its partner in the left one.
fn right_key(pixel: vec2u, label: u32) -> u32 {
    let column = i32(pixel.x) + matching.min_px + i32(label);
    if (column < 0 || column >= i32(matching.size_px.x)) {
        return STEREO_NEVER;
    }
    let both = two_sums(index_of(vec2u(u32(column), pixel.y)), label / 2u);
    return (both[label % 2u] << 16u) | label;
}

@compute @workgroup_size(STEREO_LANES)
fn find_winners(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = group.xy;
    let index = index_of(pixel);
    let words = word_count();
    if (lane == 0u) {
        atomicStore(&cheapest, STEREO_NEVER);
        atomicStore(&cheapest_of_right, STEREO_NEVER);
        atomicStore(&other, STEREO_NEVER);
    }
    workgroupBarrier();
    var key = STEREO_NEVER;
    var key_of_right = STEREO_NEVER;
    for (var word = lane; word < words; word += STEREO_LANES) {
        let keys = (two_sums(index, word) << vec2u(16u)) | (2u * word + vec2u(0u, 1u));
        key = min(key, min(keys.x, keys.y));
        key_of_right = min(key_of_right, min(right_key(pixel, 2u * word), right_key(pixel, 2u * word + 1u)));
    }
    atomicMin(&cheapest, key);
    atomicMin(&cheapest_of_right, key_of_right);
    workgroupBarrier();
    let found = atomicLoad(&cheapest);
    let label = i32(found & 0xffffu);
    var smallest = STEREO_NEVER;
    for (var word = lane; word < words; word += STEREO_LANES) {
        let both = two_sums(index, word);
        let away = abs(i32(2u * word) + vec2i(0, 1) - label);
        let others = select(both, vec2u(STEREO_NEVER), away <= vec2i(1));
        smallest = min(smallest, min(others.x, others.y));
    }
    atomicMin(&other, smallest);
    workgroupBarrier();
    if (lane == 0u) {
        let is_unique = atomicLoad(&other) * 100u > (found >> 16u) * (100u + matching.unique_percent);
        winners[index] = u32(label) | select(0u, IS_UNIQUE, is_unique);
        winners[pixel_count() + index] = atomicLoad(&cheapest_of_right) & 0xffffu;
    }
}
