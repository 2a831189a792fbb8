// Deferred shading (paper 003 §3.6): light falls on the blended surface, once for each pixel. Leaves sums of lit
// colours and weights, as the attribute pass does without it. What light is: `blinn_phong.wgsl`, `physical.wgsl`.
// What colours and normals are: `own_colors.wgsl`, `photographs.wgsl`.

@group(SOURCE_GROUP) @binding(0) var colors: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(1) var normals: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(2) var nearnesses: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(3) var depths: texture_depth_2d;
@group(SOURCE_GROUP) @binding(4) var shadow_map: texture_depth_2d;

// What light falls on.
struct Surface {
    // Display-referred.
    color: vec3f,
    // A factor on its opacity.
    opacity: f32,
    // Towards the eye, of length 1; zero where nobody knows it: no light falls there.
    normal: vec3f,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let sum = textureLoad(colors, pixel, 0);
    if (sum.a == 0.0) {
        return vec4f(0.0);
    }
    // Sums are relative to each other: half floats have no squares of small ones.
    let per_weight = 1.0 / sum.a;
    let albedo = sum.rgb * per_weight;
    let mean_normal = textureLoad(normals, pixel, 0).xyz * per_weight;
    let length2 = dot(mean_normal, mean_normal);
    let distance = view.usual_distance / max(1.0 + textureLoad(nearnesses, pixel, 0).r * per_weight, 1e-6);
    let ray = ray_through(position.xy);
    let to_eye = -normalize(ray);
    let unit = select(mean_normal / sqrt(length2), vec3f(0.0), length2 == 0.0);
    // Surfaces have two sides.
    let normal = select(unit, -unit, dot(unit, to_eye) < 0.0);
    let surface = surface_at(albedo, ray * distance, normal);
    if (surface.opacity == 0.0 || all(surface.normal == vec3f(0.0))) {
        return vec4f(surface.color, 1.0) * (sum.a * surface.opacity);
    }
    let open = openness(depths, vec2i(pixel), surface.normal);
    let light = min(lit(to_linear(surface.color), ray * distance, surface.normal, to_eye, open), vec3f(1.0));
    return vec4f(to_display(light), 1.0) * (sum.a * surface.opacity);
}
