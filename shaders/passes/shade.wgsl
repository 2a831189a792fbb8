// Deferred shading (paper 003 §3.6): light falls on the blended surface, once for each pixel. Leaves sums of lit
// colours and weights, as the attribute pass does without it. The lights: scene/lights.rs.

@group(SOURCE_GROUP) @binding(0) var colors: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(1) var normals: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(2) var nearnesses: texture_2d<f32>;
@group(SOURCE_GROUP) @binding(3) var depths: texture_depth_2d;
@group(SOURCE_GROUP) @binding(4) var shadow_map: texture_depth_2d;

// Linear light: what colours are multiplied with, and what is added.
struct Light {
    diffuse: vec3f,
    specular: vec3f,
}

// The highlight of Blinn 1977 for the cosine between normal and half vector.
fn highlight(cosine: f32) -> f32 {
    return pow(cosine, f32(SHININESS));
}

// All lights together on a place in view space; directions have unit length.
fn light_on(position: vec3f, normal: vec3f, to_eye: vec3f) -> Light {
    let facing = dot(normal, to_eye);
    // The half vector of the head light is the way to the eye.
    let head = view.head_light * view.specular * highlight(facing);
    var light = Light(vec3f(view.ambient + view.head_light * facing), vec3f(head));
    for (var index = 0u; index < MOST_LAMPS; index++) {
        let lamp = view.lamps[index];
        let way = lamp.place.xyz - lamp.place.w * position;
        // A surface at the place of a lamp gets no light of it.
        let to_lamp = way * inverseSqrt(max(dot(way, way), 1e-37));
        let lamp_facing = max(dot(normal, to_lamp), 0.0);
        var color = lamp.color.rgb;
        if (index == 0u) {
            color *= light_of_key(shadow_map, position, normal, lamp_facing);
        }
        light.diffuse += color * lamp_facing;
        if (lamp_facing > 0.0) {
            let along = max(dot(normal, normalize(to_lamp + to_eye)), 0.0);
            light.specular += color * view.specular * highlight(along);
        }
    }
    return light;
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
    if (length2 == 0.0) {
        return sum;
    }
    let distance = view.usual_distance / max(1.0 + textureLoad(nearnesses, pixel, 0).r * per_weight, 1e-6);
    let ray = ray_through(position.xy);
    let to_eye = -normalize(ray);
    let unit = mean_normal / sqrt(length2);
    // Surfaces have two sides.
    let normal = select(unit, -unit, dot(unit, to_eye) < 0.0);
    let light = light_on(ray * distance, normal, to_eye);
    let diffuse = light.diffuse * openness(depths, vec2i(pixel), normal);
    let lit = min(to_linear(albedo) * diffuse + light.specular, vec3f(1.0));
    return vec4f(to_display(lit) * sum.a, sum.a);
}
