// Surfaces take the colours that images show, and, where available, the normals of their depth maps. Sampling the
// images: `photos.wgsl`, `photo_answers.wgsl`.

#import common/blended_surface.wgsl
#import common/photo_table.wgsl
#import generated/constants

fn surface_at(blended: BlendedSurface, pixel: vec2u) -> Surface {
    let answer = photo_answer(blended, pixel);
    if (answer.kind == ANSWER_CLIPPED) {
        return Surface(vec3f(0.0), 0.0, blended.normal);
    }
    if (answer.kind == ANSWER_UNSEEN) {
        let flags = photo_flags();
        let color = select(blended.color, vec3f(1.0), (flags & PHOTO_IS_WHITE) != 0u);
        return Surface(color, select(1.0, 0.0, (flags & PHOTO_LEAVES_HOLES) != 0u), blended.normal);
    }
    if (all(answer.normal == vec3f(0.0))) {
        return Surface(answer.color, PHOTO_OPACITY, blended.normal);
    }
    // Surfaces are two-sided.
    let is_turned = dot(answer.normal, blended.to_eye) < 0.0;
    return Surface(answer.color, PHOTO_OPACITY, select(answer.normal, -answer.normal, is_turned));
}
