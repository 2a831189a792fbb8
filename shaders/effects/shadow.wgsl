// The shadow of the key light (Williams 1978; Reeves et al. 1987). How: scene/light/shadow.rs.

// The fraction of the key light that reaches a position in view space; `facing` is the cosine between its normal and
// the direction to the lamp.
fn light_of_key(shadow_map: texture_depth_2d, position: vec3f, normal: vec3f, facing: f32) -> f32 {
    if (parts.shadow.texel == 0.0 || facing <= 0.0) {
        return 1.0;
    }
    let slope = sqrt(max(1.0 - facing * facing, 0.0));
    let offset = parts.shadow.texel * (SHADOW_OFFSET_TEXELS + SHADOW_SLOPE_TEXELS * slope);
    let place = vec4f(position + normal * offset, 1.0);
    let per_distance = -1.0 / dot(parts.shadow.lamp_from_view_z, place);
    let aside = vec2f(dot(parts.shadow.lamp_from_view_x, place), dot(parts.shadow.lamp_from_view_y, place));
    let ndc = parts.shadow.focal * per_distance * aside;
    let depth = parts.shadow.near * per_distance;
    // The corner of a square of 3×3 texels. It may start between texels, so that shadow edges are continuous.
    let corner = (0.5 + vec2f(0.5, -0.5) * ndc) * SHADOW_EDGE_PX - 1.5;
    let first = floor(corner);
    let beyond = corner - first;
    let last = vec2i(i32(SHADOW_EDGE_PX) - 1);
    var lit = 0.0;
    for (var row = 0; row < 4; row++) {
        let of_row = select(select(1.0, beyond.y, row == 3), 1.0 - beyond.y, row == 0);
        for (var column = 0; column < 4; column++) {
            let of_column = select(select(1.0, beyond.x, column == 3), 1.0 - beyond.x, column == 0);
            let texel = clamp(vec2i(first) + vec2i(column, row), vec2i(0), last);
            lit += select(0.0, of_row * of_column, textureLoad(shadow_map, texel, 0) <= depth);
        }
    }
    return lit / 9.0;
}
