// The picture of the visibility pass, Fig. 3 (c): near is light, far is dark, nothing is background.

@group(SOURCE_GROUP) @binding(0) var depths: texture_depth_2d;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let depth = textureLoad(depths, vec2u(position.xy), 0);
    if (depth == 0.0) {
        discard;
    }
    let distance = view.near / depth;
    let t = clamp((distance - view.depth_range.x) / (view.depth_range.y - view.depth_range.x), 0.0, 1.0);
    return vec4f(vec3f(mix(NEAREST_GREY, FARTHEST_GREY, t)), 1.0);
}
