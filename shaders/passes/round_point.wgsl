// Round points: the disk in the square, and in any case the pixel that the point is in. Points that are larger than the
// least have it in their disk.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    let aside_px = abs(in.quad) * 0.5 * view.point_least_px;
    let is_own_pixel = max(aside_px.x, aside_px.y) <= 0.5;
    if (dot(in.quad, in.quad) > 1.0 && !is_own_pixel) {
        discard;
    }
    return vec4f(unpack4x8unorm(in.color).rgb, 1.0);
}
