// The sums of the passes over records at a pixel: the blended surface, which is lit and for which the input images are
// sampled.

#import common/view.wgsl

struct BlendedSurface {
    // Total over all splats; 0 where there is none, and then the other fields are unknown.
    weight: f32,
    // Display-referred.
    color: vec3f,
    // In view space.
    place: vec3f,
    // Unit length.
    to_eye: vec3f,
    // Towards the eye, unit length; zero where unknown.
    normal: vec3f,
}

// `position` is @builtin(position).xy.
fn blended_surface(position: vec2f) -> BlendedSurface {
    var surface: BlendedSurface;
    let pixel = vec2u(position);
    let sum = textureLoad(colors, pixel, 0);
    if (sum.a == 0.0) {
        return surface;
    }
    // Divided by the weight first: the squares of small values are not representable in half floats.
    let per_weight = 1.0 / sum.a;
    let mean_normal = textureLoad(normals, pixel, 0).xyz * per_weight;
    let length2 = dot(mean_normal, mean_normal);
    // Blended like normals. Not from the depth buffer: its depths are pushed back by a splat radius.
    let distance = view.usual_distance / max(1.0 + textureLoad(nearnesses, pixel, 0).r * per_weight, 1e-6);
    let ray = ray_through(position);
    let to_eye = -normalize(ray);
    let unit = select(mean_normal / sqrt(length2), vec3f(0.0), length2 == 0.0);
    // Surfaces are two-sided.
    let normal = select(unit, -unit, dot(unit, to_eye) < 0.0);
    return BlendedSurface(sum.a, sum.rgb * per_weight, ray * distance, to_eye, normal);
}
