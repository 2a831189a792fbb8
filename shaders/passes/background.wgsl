// The gradient behind the cloud.

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(mix(view.background_top, view.background_bottom, position.y / view.viewport_px.y), 1.0);
}
