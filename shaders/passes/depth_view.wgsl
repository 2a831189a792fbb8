// Displays the depths of the visibility pass, Fig. 3 (c): near is light, far is dark, empty pixels show the background.

#import common/fullscreen.wgsl
#import common/view.wgsl
#import generated/constants

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let depth = textureLoad(depths, vec2u(position.xy), 0);
    if (depth == 0.0) {
        discard;
    }
    let distance = view.near / depth;
    let range = parts.depth_view.range;
    let t = clamp((distance - range.x) / (range.y - range.x), 0.0, 1.0);
    return vec4f(vec3f(mix(NEAREST_GREY, FARTHEST_GREY, t)), 1.0);
}
