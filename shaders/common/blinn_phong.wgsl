// Lambertian shading with the highlights of Blinn 1977. The lights: scene/light/lights.rs.

#import effects/shadow.wgsl
#import generated/constants

// Linear light: the factor on the colour, and the summand.
struct Light {
    diffuse: vec3f,
    specular: vec3f,
}

// The highlight of Blinn 1977 for the cosine between normal and half vector.
fn highlight(cosine: f32) -> f32 {
    return pow(cosine, f32(SHININESS));
}

// All lights together at a position in view space; directions have unit length.
fn light_on(position: vec3f, normal: vec3f, to_eye: vec3f) -> Light {
    let facing = dot(normal, to_eye);
    // The half vector of the headlight is the direction to the eye.
    let head = parts.lights.head * parts.lights.specular * highlight(facing);
    var light = Light(vec3f(parts.lights.ambient + parts.lights.head * facing), vec3f(head));
    for (var index = 0u; index < MAX_LAMPS; index++) {
        let way = parts.lights.lamp_places[index].xyz - parts.lights.lamp_places[index].w * position;
        // A surface at the position of a lamp gets no light from it.
        let to_lamp = way * inverseSqrt(max(dot(way, way), 1e-37));
        let lamp_facing = max(dot(normal, to_lamp), 0.0);
        var color = parts.lights.lamp_colors[index].rgb;
        if (index == 0u) {
            color *= light_of_key(shadow_map, position, normal, lamp_facing);
        }
        light.diffuse += color * lamp_facing;
        if (lamp_facing > 0.0) {
            let along = max(dot(normal, normalize(to_lamp + to_eye)), 0.0);
            light.specular += color * parts.lights.specular * highlight(along);
        }
    }
    return light;
}

// Linear light reflected at a position in view space by a surface with a linear colour; the fraction `open` of the
// ambient light reaches it.
fn lit(albedo: vec3f, position: vec3f, normal: vec3f, to_eye: vec3f, open: f32) -> vec3f {
    let light = light_on(position, normal, to_eye);
    return albedo * light.diffuse * open + light.specular;
}
