// EWA filtering in object space (Ren et al. 2002). The formulas: render/cpu/ewa.rs.

#import common/view.wgsl
#import generated/constants

fn filtered(splat: Splat, center: vec3f) -> Splat {
    let midpoint = rotate_to_view(center);
    let per_distance = 1.0 / max(-midpoint.z, view.near);
    let u = px_along(splat.axes[0] * splat.scale, midpoint, per_distance);
    let v = px_along(splat.axes[1] * splat.scale, midpoint, per_distance);
    // At least as large as for splats that are seen almost edge-on.
    let min_value = pow2(MIN_COSINE * splat.scale * per_distance * view.px_per_slope.x);
    let uu = dot(u, u) + min_value * dot(splat.axes[0], splat.axes[0]);
    let vv = dot(v, v) + min_value * dot(splat.axes[1], splat.axes[1]);
    let uv = dot(u, v);
    let determinant = max(uu * vv - uv * uv, EWA_MIN_DETERMINANT);
    let radius2 = pow2(view.filter_radius_px);
    let widening = radius2 / determinant;
    let root = sqrt(1.0 + (uu + vv + radius2) * widening);
    let a = 1.0 + vv * widening + root;
    let b = -uv * widening;
    let c = 1.0 + uu * widening + root;
    let axes = splat.axes * (mat2x2f(a, b, b, c) * inverseSqrt(a + c));
    let reach = splat.scale * sqrt(0.5 * (dot(axes[0], axes[0]) + dot(axes[1], axes[1])));
    return Splat(axes, splat.scale, reach, ewa_weight(1.0 / root));
}

fn pow2(value: f32) -> f32 {
    return value * value;
}

// The extent in pixels of an edge from a midpoint, to first order.
fn px_along(edge: vec3f, midpoint: vec3f, per_distance: f32) -> vec2f {
    let in_view = rotate_to_view(edge);
    return (in_view.xy + midpoint.xy * (in_view.z * per_distance)) * per_distance * view.px_per_slope;
}

// In units of the weight at which the background is hidden.
fn ewa_weight(height: f32) -> f32 {
    return height * OPAQUE_WEIGHT / mix(EWA_MEAN_WEIGHT, OPAQUE_WEIGHT, height);
}
