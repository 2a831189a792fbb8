// The tone curve (gamma correction): a power of display-referred colours. Why: render/effects/tone.

#import common/fullscreen.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let color = textureLoad(picture, vec2u(position.xy), 0);
    return vec4f(pow(color.rgb, vec3f(parts.tone.exponent)), color.a);
}
