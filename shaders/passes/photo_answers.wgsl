// The image samples of each pixel, for the passes that look at its neighbourhood: colours with their confidence, all or
// nothing, and normals with the kind of sample. Works like `fill_holes`: render/cpu/photos/push_pull.rs.

#import common/blended_surface.wgsl
#import common/fullscreen.wgsl
#import common/photos.wgsl
#import generated/constants

struct Answers {
    @location(0) color: vec4f,
    @location(1) normal: vec4f,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> Answers {
    let blended = blended_surface(position.xy);
    if (blended.weight == 0.0) {
        return Answers(vec4f(0.0), vec4f(vec3f(0.0), ANSWER_CLIPPED));
    }
    let answer = photo_answer(blended, vec2u(position.xy));
    let color = select(vec4f(0.0), vec4f(answer.color, 1.0), answer.kind == ANSWER_SHOWN);
    return Answers(color, vec4f(answer.normal, answer.kind));
}
