// What the passes over records summed up at a pixel: the blended surface, on which light falls, and of which
// photographs are asked.

#import common/view.wgsl

struct BlendedSurface {
    // Of all splats; 0 where nothing is, and nothing else is known.
    weight: f32,
    // Display-referred.
    color: vec3f,
    // In view space.
    place: vec3f,
    // Of length 1.
    to_eye: vec3f,
    // Towards the eye, of length 1; zero where nobody knows it.
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
    // Sums are relative to each other: half floats have no squares of small ones.
    let per_weight = 1.0 / sum.a;
    let mean_normal = textureLoad(normals, pixel, 0).xyz * per_weight;
    let length2 = dot(mean_normal, mean_normal);
    // Blended like normals. Not from the depth buffer: its depths are pushed back by a splat radius.
    let distance = view.usual_distance / max(1.0 + textureLoad(nearnesses, pixel, 0).r * per_weight, 1e-6);
    let ray = ray_through(position);
    let to_eye = -normalize(ray);
    let unit = select(mean_normal / sqrt(length2), vec3f(0.0), length2 == 0.0);
    // Surfaces have two sides.
    let normal = select(unit, -unit, dot(unit, to_eye) < 0.0);
    return BlendedSurface(sum.a, sum.rgb * per_weight, ray * distance, to_eye, normal);
}
