// Half axes of a disk of radius 1. The 4D media paper §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n and v = n ×
// u.

#import generated/constants

fn half_axes(n: vec3f, ellipse: u32) -> mat2x3f {
    // `a` must not be parallel to n; the paper switches to a' only when it is, we do so where the product loses digits.
    let a = select(vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, -1.0), abs(n.y) > UPRIGHT_NORMAL_Y);
    let u = normalize(cross(a, n));
    return mat2x3f(u, cross(n, u));
}
