// Costs of one path, added to the sums: a workgroup follows it, and its lanes share the labels of a pixel. Twin of
// stereo/matching/semi_global.

#import stereo/pair.wgsl

// Costs at two pixels of the path, alternating, each with a label before the first one and after the last that are
// never chosen.
var<workgroup> path: array<u32, STEREO_PATH_VALUES>;
// The minima of three pixels, in rotation: the previous one, the current one, and the one being prepared for the next.
var<workgroup> min_value: array<atomic<u32>, 3>;

// Start of a path and its number of pixels. There is one horizontal path per row and one vertical path per column;
// diagonal ones start at each pixel of two borders.
fn begin_of_path(number: i32) -> vec3i {
    let size = vec2i(matching.size_px);
    let way = matching.path_step;
    // Counted from the corner that the path moves away from.
    var begin = vec2i(number, 0);
    if (way.y == 0) {
        begin = vec2i(0, number);
    } else if (way.x != 0 && number >= size.x) {
        begin = vec2i(0, number - size.x + 1);
    }
    let left = select(size - begin, vec2i(size.x + size.y), way == vec2i(0));
    let place = select(begin, size - 1 - begin, way < vec2i(0));
    return vec3i(place, min(left.x, left.y));
}

fn p2_between(from_index: u32, to_index: u32) -> u32 {
    let from_brightness = i32(brightness(from_index));
    let change = u32(abs(from_brightness - i32(brightness(to_index))));
    return matching.p2_min + matching.p2_above_min * matching.half_change / (matching.half_change + change);
}

@compute @workgroup_size(STEREO_LANES)
fn along_path(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let words = word_count();
    let stride = matching.count + 2u;
    let begin = begin_of_path(i32(group.x));
    let length = u32(begin.z);
    // No path leads to the first pixel: costs of 0 add nothing.
    for (var label = lane; label < stride; label += STEREO_LANES) {
        let is_border = label == 0u || label == stride - 1u;
        path[label] = select(0u, STEREO_NEVER, is_border);
        path[stride + label] = STEREO_NEVER;
    }
    if (lane < 3u) {
        atomicStore(&min_value[lane], select(STEREO_NEVER, 0u, lane == 0u));
    }
    workgroupBarrier();
    for (var number = 0u; number < length; number++) {
        let pixel = vec2u(begin.xy + matching.path_step * i32(number));
        let index = index_of(pixel);
        var p2 = 0u;
        if (number > 0u) {
            p2 = p2_between(index_of(vec2u(vec2i(pixel) - matching.path_step)), index);
        }
        let min_before = atomicLoad(&min_value[number % 3u]);
        let from_place = (number % 2u) * stride;
        let to_place = stride - from_place;
        var min_now = STEREO_NEVER;
        for (var word = lane; word < words; word += STEREO_LANES) {
            let place = from_place + 2u * word;
            let costs = vec4u(path[place], path[place + 1u], path[place + 2u], path[place + 3u]);
            let near = min(costs.xy, costs.zw) + matching.p1;
            let best = min(min(costs.yz, near), vec2u(min_before + p2)) - min_before;
            let both = two_costs(pixel, word);
            let now = vec2u(both & 0xffffu, both >> 16u) + best;
            path[to_place + 2u * word + 1u] = now.x;
            path[to_place + 2u * word + 2u] = now.y;
            min_now = min(min_now, min(now.x, now.y));
            let sum = now.x | (now.y << 16u);
            if (matching.is_first_path != 0u) {
                sums[index * words + word] = sum;
            } else {
                sums[index * words + word] += sum;
            }
        }
        atomicMin(&min_value[(number + 1u) % 3u], min_now);
        if (lane == 0u) {
            atomicStore(&min_value[(number + 2u) % 3u], STEREO_NEVER);
        }
        workgroupBarrier();
    }
}
