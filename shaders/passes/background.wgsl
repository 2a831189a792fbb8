// The gradient behind the cloud.

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return mix(vec4f(view.background_top, 1.0), view.background_bottom, position.y / view.viewport_px.y);
}
