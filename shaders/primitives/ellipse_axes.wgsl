// Half axes of an ellipse whose quadratic mean is 1. Mirrors cloud/ellipse.rs.

#import generated/constants

fn half_axes(n: vec3f, ellipse: u32) -> mat2x3f {
    // Two unit vectors across n (Duff et al. 2017).
    let sign = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let tangent = vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let bitangent = vec3f(b, sign + n.y * n.y * a, -n.y);
    let x = 2.0 * f32(ellipse >> 16u) / ELLIPSE_STEPS - 1.0;
    let axis = normalize(tangent * x + bitangent * (1.0 - abs(x)));
    // 0 is a circle; no ellipse is so thin that its ratio is 0.
    let steps = ellipse & 0xffffu;
    let ratio = select(f32(steps) / ELLIPSE_STEPS, 1.0, steps == 0u);
    let longer = sqrt(2.0 / (1.0 + ratio * ratio));
    return mat2x3f(axis * longer, cross(n, axis) * (ratio * longer));
}
