// Surfaces take their colours from input images (Yang et al. 2006 §3.2-3.4), and, when relit, normals from the depth
// maps of these (§4.1): scene/photos, render/cpu/photos.

#import common/blended_surface.wgsl
#import common/photo_table.wgsl
#import common/view.wgsl
#import generated/constants

// The projection of a position into an image: texels from the upper left corner of its finest level, and the distance
// along its axis.
struct InPhoto {
    texel: vec2f,
    distance: f32,
    // Of the angle between the directions to the camera and to the eye; below all cosines where the camera does not see
    // it.
    cosine: f32,
    // Cosine between the direction to the camera and the normal.
    facing: f32,
}

fn photo_entry(photo: u32, column: u32) -> vec4f {
    return textureLoad(photo_table, vec2u(column, photo + 1u), 0);
}

fn in_photo(photo: u32, place: vec3f, to_eye: vec3f, normal: vec3f) -> InPhoto {
    let at = vec4f(place, 1.0);
    let distance = dot(photo_entry(photo, 2u), at);
    let lens = photo_entry(photo, 4u);
    let aside = vec2f(dot(photo_entry(photo, 0u), at), dot(photo_entry(photo, 1u), at));
    let texel = aside * (1.0 / distance) * lens.xy + lens.zw;
    let to_camera = photo_entry(photo, 3u).xyz - place;
    let per_length = 1.0 / sqrt(max(dot(to_camera, to_camera), 1e-37));
    let cosine = dot(to_camera, to_eye) * per_length;
    let facing = dot(to_camera, normal) * per_length;
    let size = photo_entry(photo, 5u).xy;
    let is_inside = distance > 0.0 && all(texel >= vec2f(0.0)) && all(texel < size);
    let looks = is_inside && facing >= 0.0;
    return InPhoto(texel, distance, select(PHOTO_NOT_LOOKING, cosine, looks), facing);
}

// Content of an image at the projection of a position: 0 that position, 1 something that occludes it, 2 something
// behind it, 3 that position near a depth discontinuity.
fn seen_there(photo: u32, at: InPhoto) -> u32 {
    let size = photo_entry(photo, 5u).xy;
    let map = photo_entry(photo, 7u);
    let texel = min(vec2u(at.texel / size * map.xy), vec2u(map.xy) - 1u);
    let there = textureLoad(photo_depths, texel, photo, 0).r;
    // Without a depth the relation is unknown.
    if (there == 0.0) {
        return 0u;
    }
    let behind = at.distance - abs(there);
    if (behind > map.z) {
        return 1u;
    }
    if (map.w > 0.0 && behind < -map.z) {
        return 2u;
    }
    return select(0u, 3u, there < 0.0);
}

// Bilinear between the four texels of a level around a position; red, green and blue premultiplied by alpha.
fn photo_bilinear(photo: u32, level: u32, finest: vec2f, texel: vec2f) -> vec4f {
    let size = max(vec2u(finest) >> vec2u(level), vec2u(1u));
    let at = clamp(texel * (vec2f(size) / finest) - 0.5, vec2f(0.0), vec2f(size) - 1.0);
    let before = vec2u(at);
    let after = min(before + 1u, size - 1u);
    let share = at - vec2f(before);
    var sum = vec4f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        let is_after = vec2<bool>((corner & 1u) != 0u, (corner & 2u) != 0u);
        let shares = select(1.0 - share, share, is_after);
        let color = textureLoad(photo_texels, select(before, after, is_after), photo, level);
        let alpha = shares.x * shares.y * color.a;
        sum += vec4f(color.rgb * alpha, alpha);
    }
    return sum;
}

// Weights of four texels at the fraction `t` between the second and the third (Catmull and Rom 1974).
fn cubic_weights(t: f32) -> vec4f {
    let t2 = t * t;
    let t3 = t2 * t;
    return vec4f(
        -0.5 * t3 + t2 - 0.5 * t,
        1.5 * t3 - 2.5 * t2 + 1.0,
        -1.5 * t3 + 2.0 * t2 + 0.5 * t,
        0.5 * (t3 - t2)
    );
}

// Bicubic over the 16 texels of an image around a position, clamped between the minimum and maximum of the nearest
// four: photos/images/texture.rs.
fn photo_on_cubics(photo: u32, finest: vec2f, texel: vec2f) -> vec4f {
    let last = vec2i(finest) - 1;
    let at = clamp(texel - 0.5, vec2f(0.0), vec2f(last));
    let before = vec2i(at);
    let share = at - vec2f(before);
    let across = cubic_weights(share.x);
    let down = cubic_weights(share.y);
    var sum = vec4f(0.0);
    var min_value = vec4f(2.0);
    var max_value = vec4f(-1.0);
    for (var row = 0; row < 4; row++) {
        for (var column = 0; column < 4; column++) {
            let there = clamp(before + vec2i(column, row) - 1, vec2i(0), last);
            let color = textureLoad(photo_texels, there, photo, 0);
            let premultiplied = vec4f(color.rgb * color.a, color.a);
            if ((row == 1 || row == 2) && (column == 1 || column == 2)) {
                min_value = min(min_value, premultiplied);
                max_value = max(max_value, premultiplied);
            }
            sum += across[column] * down[row] * premultiplied;
        }
    }
    return clamp(sum, min_value, max_value);
}

fn photo_trilinear(photo: u32, levels: u32, finest: vec2f, texel: vec2f, lod: f32) -> vec4f {
    let finer = min(u32(max(lod, 0.0)), levels - 1u);
    let share = min(max(lod, 0.0) - f32(finer), 1.0);
    var fine: vec4f;
    if (finer == 0u) {
        fine = photo_on_cubics(photo, finest, texel);
    } else {
        fine = photo_bilinear(photo, finer, finest, texel);
    }
    if (share == 0.0 || finer + 1u == levels) {
        return fine;
    }
    return mix(fine, photo_bilinear(photo, finer + 1u, finest, texel), share);
}

// The footprint of a pixel in an image, with several taps along its long axis. `per_px` has how far the texel moves per
// pixel to the right and per pixel down.
fn photo_sample(photo: u32, texel: vec2f, per_px: mat2x2f) -> vec4f {
    let sizes = photo_entry(photo, 5u);
    let lengths = vec2f(length(per_px[0]), length(per_px[1]));
    let is_first_long = lengths.x >= lengths.y;
    let long = select(per_px[1], per_px[0], is_first_long);
    let long_length = max(lengths.x, lengths.y);
    let taps = clamp(ceil(long_length / max(min(lengths.x, lengths.y), 1.0)), 1.0, PHOTO_MAX_TAPS);
    let lod = log2(max(long_length / taps, 1.0));
    var sum = vec4f(0.0);
    for (var tap = 0.0; tap < taps; tap += 1.0) {
        let along = (tap + 0.5) / taps - 0.5;
        sum += photo_trilinear(photo, u32(sizes.z), sizes.xy, texel + along * long, lod);
    }
    return sum / taps;
}

// How far the surface point moves per pixel along x and y.
fn steps_on_surface(distance: f32, to_eye: vec3f, normal: vec3f) -> mat2x3f {
    let right = vec3f(distance / view.px_per_slope.x, 0.0, 0.0);
    let down = vec3f(0.0, -distance / view.px_per_slope.y, 0.0);
    if (all(normal == vec3f(0.0))) {
        return mat2x3f(right, down);
    }
    // Along the ray, onto the tangent plane.
    let per_cosine = 1.0 / max(dot(normal, to_eye), PHOTO_MIN_COSINE);
    return mat2x3f(
        right - to_eye * (dot(normal, right) * per_cosine),
        down - to_eye * (dot(normal, down) * per_cosine)
    );
}

fn photo_per_px(photo: u32, at: InPhoto, steps: mat2x3f) -> mat2x2f {
    let lens = photo_entry(photo, 4u);
    let slope = (at.texel - lens.zw) / lens.xy;
    let rows = mat3x3f(photo_entry(photo, 0u).xyz, photo_entry(photo, 1u).xyz, photo_entry(photo, 2u).xyz);
    var per_px: mat2x2f;
    for (var step = 0; step < 2; step++) {
        let deeper = dot(rows[2], steps[step]);
        let aside = vec2f(dot(rows[0], steps[step]), dot(rows[1], steps[step]));
        per_px[step] = lens.xy * (1.0 / at.distance) * (aside - slope * deeper);
    }
    return per_px;
}

// Fraction of a surface that an image shows, relative to the eye's view of it.
fn share_seen(facing_eye: f32, facing: f32) -> f32 {
    let share = select(1.0, min(facing / max(facing_eye, PHOTO_MIN_COSINE), 1.0), facing_eye > 0.0);
    return share * share;
}

// How far an image is trusted compared with others: render/cpu/photos/mod.rs.
fn trust(angle2: f32, is_near_step: bool) -> f32 {
    return select(1.0, mix(PHOTO_TRUST_NEAR_STEPS, 1.0, exp(-angle2 * PHOTO_PER_STEP_ANGLE2)), is_near_step);
}

// Images fade towards their borders.
fn photo_rim(texel: vec2f, size: vec2f) -> f32 {
    let inwards = min(texel, size - texel) / (PHOTO_RIM * size);
    return clamp(min(inwards.x, inwards.y), 1e-3, 1.0);
}

// A depth map with the intrinsics of its lens, in its own texels.
struct DepthMap {
    photo: u32,
    last_texel: vec2i,
    focal: vec2f,
    principal: vec2f,
    tolerance: f32,
}

// The position at a texel of a depth map, in camera space; at the camera where unknown. Texels beyond the border repeat
// the border.
fn depth_place(map: DepthMap, texel: vec2i) -> vec3f {
    let there = clamp(texel, vec2i(0), map.last_texel);
    let distance = abs(textureLoad(photo_depths, there, map.photo, 0).r);
    return distance * vec3f((vec2f(there) + 0.5 - map.principal) / map.focal, 1.0);
}

fn is_near_depth(other: vec3f, center: vec3f, tolerance: f32) -> bool {
    return other.z > 0.0 && abs(other.z - center.z) <= tolerance;
}

// The normal at a texel of a depth map in camera space, from the positions around it: zero next to depth
// discontinuities and at grazing angles. render/cpu/photos/normals.rs.
fn depth_normal(map: DepthMap, texel: vec2i) -> vec3f {
    let center = depth_place(map, texel);
    let left = depth_place(map, texel - vec2i(1, 0));
    let right = depth_place(map, texel + vec2i(1, 0));
    let up = depth_place(map, texel - vec2i(0, 1));
    let down = depth_place(map, texel + vec2i(0, 1));
    if (center.z <= 0.0
        || !is_near_depth(left, center, map.tolerance) || !is_near_depth(right, center, map.tolerance)
        || !is_near_depth(up, center, map.tolerance) || !is_near_depth(down, center, map.tolerance)) {
        return vec3f(0.0);
    }
    let across = cross(left - right, up - down);
    let length2 = dot(across, across);
    if (length2 == 0.0) {
        return vec3f(0.0);
    }
    let normal = across / sqrt(length2);
    let facing = -dot(normal, center) / length(center);
    return select(normal * sign(facing), vec3f(0.0), abs(facing) < PHOTO_MIN_FACING);
}

// The normal of the surface in an image, in view space, interpolated between the four texels of its depth map around a
// position; zero where depths do not determine it.
fn photo_normal(photo: u32, texel: vec2f) -> vec3f {
    let of_map = photo_entry(photo, 7u);
    let lens = photo_entry(photo, 4u);
    let scale = of_map.xy / photo_entry(photo, 5u).xy;
    let map = DepthMap(photo, vec2i(of_map.xy) - 1, lens.xy * scale, lens.zw * scale, of_map.z);
    let at = clamp(texel * scale - 0.5, vec2f(0.0), of_map.xy - 1.0);
    let before = vec2i(at);
    let after = min(before + 1, map.last_texel);
    let share = at - vec2f(before);
    var sum = vec3f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        let is_after = vec2<bool>((corner & 1u) != 0u, (corner & 2u) != 0u);
        let shares = select(1.0 - share, share, is_after);
        sum += shares.x * shares.y * depth_normal(map, select(before, after, is_after));
    }
    let rows = mat3x3f(photo_entry(photo, 0u).xyz, photo_entry(photo, 1u).xyz, photo_entry(photo, 2u).xyz);
    return rows * (sum / sqrt(max(dot(sum, sum), 1e-37)));
}

// The result of one image at a position.
struct PhotoShown {
    color: vec3f,
    // Its weight relative to the others.
    share: f32,
    // A factor on that where the images disagree.
    nearness: f32,
}

// The mean colour that the images show at a position, where those that disagree with the others get little weight:
// render/cpu/photos/agreement.rs.
fn photo_agreed(all: array<PhotoShown, PHOTO_MAX_BLENDED>, count: u32) -> vec3f {
    var shown = all;
    var mean = vec3f(0.0);
    for (var round = 0u; round <= PHOTO_AGREEMENT_ROUNDS; round++) {
        var color = vec3f(0.0);
        var sum = 0.0;
        for (var which = 0u; which < count; which++) {
            let one = shown[which];
            let off = one.color - mean;
            let belief = select(1.0 / (1.0 + PHOTO_PER_DISAGREEMENT2 * dot(off, off)), 0.0, round == 0u);
            let of_belief = select(belief, 1.0, round == 0u);
            let share = one.share * of_belief * mix(one.nearness, 1.0, belief);
            color += share * one.color;
            sum += share;
        }
        mean = color / max(sum, 1e-37);
    }
    return mean;
}

// Image sample of the blended surface.
fn photo_answer(blended: BlendedSurface, pixel: vec2u) -> PhotoAnswer {
    let place = blended.place;
    let to_eye = blended.to_eye;
    let normal = blended.normal;
    let header = textureLoad(photo_table, vec2u(0u, 0u), 0);
    let photos = u32(header.x);
    let max_value = u32(header.y);
    let per_sigma2 = header.z;
    let flags = photo_flags();
    let clips_by_vote = (flags & PHOTO_CLIPS_BY_VOTE) != 0u;
    let clips_by_any = (flags & PHOTO_CLIPS_BY_ANY) != 0u;
    let relights = (flags & PHOTO_RELIGHTS) != 0u;
    let is_white = (flags & PHOTO_IS_WHITE) != 0u;
    // The images nearest to the eye's direction, nearest first.
    var nearest: array<u32, PHOTO_MAX_ASKED>;
    var cosines: array<f32, PHOTO_MAX_ASKED>;
    var count = 0u;
    for (var photo = 0u; photo < photos; photo++) {
        let cosine = in_photo(photo, place, to_eye, normal).cosine;
        if (cosine == PHOTO_NOT_LOOKING || count == PHOTO_MAX_ASKED && cosine <= cosines[count - 1u]) {
            continue;
        }
        var slot = min(count, PHOTO_MAX_ASKED - 1u);
        while (slot > 0u && cosines[slot - 1u] < cosine) {
            cosines[slot] = cosines[slot - 1u];
            nearest[slot] = nearest[slot - 1u];
            slot--;
        }
        cosines[slot] = cosine;
        nearest[slot] = photo;
        count = min(count + 1u, PHOTO_MAX_ASKED);
    }
    // The images that see the position, one more than is blended: weights are relative to the last one's.
    var seeing: array<u32, PHOTO_MAX_BLENDED + 1u>;
    var weights: array<f32, PHOTO_MAX_BLENDED + 1u>;
    var angles2: array<f32, PHOTO_MAX_BLENDED + 1u>;
    var trusts: array<f32, PHOTO_MAX_BLENDED + 1u>;
    var found = 0u;
    var through = 0.0;
    var seen = 0.0;
    var min_value = 0.0;
    for (var at = 0u; at < count && found <= max_value; at++) {
        let angle = acos(clamp(cosines[at], -1.0, 1.0));
        if (at == 0u) {
            min_value = angle * angle;
        }
        let weight = exp((min_value - angle * angle) * per_sigma2);
        let asked = in_photo(nearest[at], place, to_eye, normal);
        let what = seen_there(nearest[at], asked);
        let seen_of_it = share_seen(dot(normal, to_eye), asked.facing);
        if (what == 2u) {
            through += seen_of_it * weight;
        } else if (what != 1u) {
            trusts[found] = seen_of_it * trust(angle * angle, what == 3u);
            seeing[found] = nearest[at];
            weights[found] = weight;
            angles2[found] = angle * angle;
            seen += seen_of_it * weight;
            found++;
        }
    }
    let clipped = PhotoAnswer(vec3f(0.0), ANSWER_CLIPPED, vec3f(0.0));
    if (clips_by_vote && through > seen || clips_by_any && through > 0.0) {
        return clipped;
    }
    let unseen = PhotoAnswer(vec3f(0.0), ANSWER_UNSEEN, vec3f(0.0));
    if (found == 0u) {
        return unseen;
    }
    var beyond = select(0.0, weights[max_value] / weights[0], found > max_value);
    // Where the last is as near as the nearest, all have the same weight.
    beyond = select(0.0, beyond, beyond < 0.999);
    let steps = steps_on_surface(-place.z, to_eye, normal);
    var shown: array<PhotoShown, PHOTO_MAX_BLENDED>;
    let same_angle2 = PHOTO_SAME_ANGLE2 / per_sigma2;
    var normals = vec3f(0.0);
    var sum = 0.0;
    var object = 0.0;
    var background = 0.0;
    for (var which = 0u; which < min(found, max_value); which++) {
        let photo = seeing[which];
        let at = in_photo(photo, place, to_eye, normal);
        let sampled = photo_sample(photo, at.texel, photo_per_px(photo, at, steps));
        let sizes = photo_entry(photo, 5u);
        let weight = (weights[which] / weights[0] - beyond) * trusts[which] * photo_rim(at.texel, sizes.xy);
        shown[which].color = photo_entry(photo, 6u).xyz * sampled.rgb / max(sampled.a, 1e-37);
        shown[which].share = weight * sampled.a;
        shown[which].nearness = (angles2[0] + same_angle2) / (angles2[which] + same_angle2);
        sum += weight * sampled.a;
        if (relights) {
            normals += weight * sampled.a * photo_normal(photo, at.texel);
        }
        if (sizes.w > 0.0) {
            object += weight * sampled.a;
            background += weight * (1.0 - sampled.a);
        }
    }
    if (clips_by_vote && background > object || clips_by_any && background > 0.0) {
        return clipped;
    }
    if (sum <= 0.0) {
        return unseen;
    }
    let agreed = photo_agreed(shown, min(found, max_value));
    let color = select(min(agreed, vec3f(1.0)), vec3f(1.0), is_white);
    let length2 = dot(normals, normals);
    return PhotoAnswer(color, ANSWER_SHOWN, select(normals / sqrt(length2), vec3f(0.0), length2 == 0.0));
}
