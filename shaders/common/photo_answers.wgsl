// The image samples of each pixel (`passes/photo_answers.wgsl`), with pixels that no image shows filled in from the
// surroundings (`passes/push.wgsl`).

#import common/blended_surface.wgsl
#import common/photo_table.wgsl
#import generated/constants

fn photo_answer(blended: BlendedSurface, pixel: vec2u) -> PhotoAnswer {
    let color = textureLoad(answered_colors, pixel, 0);
    let normal = textureLoad(answered_normals, pixel, 0);
    let is_filled = normal.w == ANSWER_UNSEEN && color.a > 0.0;
    let length2 = dot(normal.xyz, normal.xyz);
    return PhotoAnswer(
        min(color.rgb / max(color.a, 1e-6), vec3f(1.0)),
        select(normal.w, ANSWER_SHOWN, is_filled),
        select(normal.xyz / sqrt(length2), vec3f(0.0), length2 == 0.0)
    );
}
