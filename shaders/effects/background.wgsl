// The gradient behind the cloud.

#import common/fullscreen.wgsl
#import common/view.wgsl

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(mix(parts.background.top, parts.background.bottom, position.y / view.viewport_px.y), 1.0);
}
