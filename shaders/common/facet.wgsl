// A flat patch in space as functions of rays: where the ray through a pixel hits it, without vertices on it. How it
// works, and why: render/cpu/facet.rs.

#import common/view.wgsl

// A patch in view. The ray d with d.z = -1 hits it at the centre + p·u + q·v with p = P/W and q = Q/W.
struct Facet {
    // Dot products with the ray give P, Q and W; W is positive in front of the eye.
    p: vec3f,
    q: vec3f,
    w: vec3f,
    // Reversed depth per unit of W; 0 where nothing is visible: edge-on, or of zero size.
    depth_per_w: f32,
}

// The outline of the disk of a patch whose half axes are u and v.
struct Outline {
    // Minimum and maximum slopes, right and up.
    low: vec2f,
    high: vec2f,
    // Distance along the view direction to the nearest position on the disk.
    nearest: f32,
    // Whether the slopes are invalid, because the patch extends behind the eye.
    is_around_eye: bool,
}

// A centre and two half edges in view space, scaled so that the largest component is 1: products of small or large
// values neither underflow nor overflow.
struct Patch {
    c: vec3f,
    u: vec3f,
    v: vec3f,
    // Distance to the near plane in that unit.
    near: f32,
}

fn patch_of(c: vec3f, u: vec3f, v: vec3f) -> Patch {
    let largest = max(largest_of(c), max(largest_of(u), largest_of(v)));
    let per_unit = 1.0 / max(largest, FACET_MIN_SIZE);
    return Patch(c * per_unit, u * per_unit, v * per_unit, view.near * per_unit);
}

fn largest_of(vector: vec3f) -> f32 {
    let sizes = abs(vector);
    return max(sizes.x, max(sizes.y, sizes.z));
}

fn facet_of(it: Patch) -> Facet {
    let normal = cross(it.u, it.v);
    let determinant = dot(normal, it.c);
    let size = abs(determinant);
    let side = select(1.0, -1.0, determinant < 0.0);
    let depth_per_w = select(0.0, it.near / max(size, FACET_MIN_SIZE), size > FACET_MIN_SIZE);
    return Facet(side * cross(it.v, it.c), side * cross(it.c, it.u), side * normal, depth_per_w);
}

// Whether the front of a patch faces away from the eye.
fn faces_away(it: Patch) -> bool {
    return dot(cross(it.u, it.v), it.c) > 0.0;
}

// A line of pixels touches the disk where the quadratic form P² + Q² − W² has a double root along it.
fn outline_of(it: Patch) -> Outline {
    let c = it.c;
    let u = it.u;
    let v = it.v;
    let half_depth = length(vec2f(u.z, v.z));
    let nearest = -c.z - half_depth;
    let is_around_eye = nearest <= 0.25 * it.near;
    let per_depth2 = 1.0 / select(c.z * c.z - half_depth * half_depth, 1.0, is_around_eye);
    let center = (u.xy * u.z + v.xy * v.z - c.xy * c.z) * per_depth2;
    let p = cross(v, c).yx;
    let q = cross(c, u).yx;
    let w = cross(u, v).yx;
    let reach = sqrt(max(p * p + q * q - w * w, vec2f(0.0))) * per_depth2;
    return Outline(center - reach, center + reach, nearest, is_around_eye);
}
