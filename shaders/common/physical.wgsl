// Metallic–roughness shading with an environment map. The formulas: scene/light/physical_light.rs.

#import effects/shadow.wgsl
#import generated/constants

// The environment prefiltered for the roughness, and one more row with the curve of reflected and lost light.

// Linear light, by interaction with the surface: four sums, so that colours are multiplied in once, not for each light.
struct Light {
    // Reflected per unit of reflectance at normal incidence, and in addition to that.
    mirrored: vec3f,
    grazing: vec3f,
    // Light lost to further bounces, and light transmitted into the surface.
    lost: vec3f,
    let_in: vec3f,
}

// A lamp seen from a position: the direction to it, its cosine with the normal, its light there.
struct Toward {
    to_lamp: vec3f,
    facing: f32,
    color: vec3f,
}

// The interpolated entry of the curve: reflected per unit of reflectance, and in addition to that; lost; transmitted.
fn entry_at(cosine: f32) -> vec4f {
    let place = min(cosine, 1.0) * f32(ALBEDO_ENTRIES - 1u);
    let first = min(u32(place), ALBEDO_ENTRIES - 2u);
    let row = ENVIRONMENT_EDGE + 2u;
    let before = textureLoad(environment, vec2u(first, row), 0);
    let after = textureLoad(environment, vec2u(first + 1u, row), 0);
    return mix(before, after, place - f32(first));
}

fn in_environment(direction: vec3f) -> vec3f {
    return parts.physical.environment_from_view_x.xyz * direction.x
        + parts.physical.environment_from_view_y.xyz * direction.y
        + parts.physical.environment_from_view_z.xyz * direction.z;
}

// The environment's light reflected by a matt white surface with this normal.
fn harmonics_at(n: vec3f) -> vec3f {
    let c = parts.physical.harmonics;
    let light = c[0] + c[1] * n.y + c[2] * n.z + c[3] * n.x + c[4] * (n.x * n.y) + c[5] * (n.y * n.z)
        + c[6] * (3.0 * n.z * n.z - 1.0) + c[7] * (n.x * n.z) + c[8] * (n.x * n.x - n.y * n.y);
    return max(light.rgb, vec3f(0.0));
}

// The light reflected from a direction: bilinear between the centres of four texels of the unfolded octahedron.
fn environment_at(direction: vec3f) -> vec3f {
    let on_octahedron = direction / max(dot(abs(direction), vec3f(1.0)), 1e-37);
    let above = on_octahedron.xz;
    let below = (1.0 - abs(above.yx)) * select(vec2f(-1.0), vec2f(1.0), above >= vec2f(0.0));
    let square = select(above, below, on_octahedron.y < 0.0);
    // Adds the border of one texel, less half a texel.
    let place = (square * 0.5 + 0.5) * f32(ENVIRONMENT_EDGE) + 0.5;
    let first = floor(place);
    let beyond = place - first;
    let corner = vec2u(first);
    // Not a sampler: texture filtering differs between adapters, blending four texels here does not.
    let upper = mix(
        textureLoad(environment, corner, 0),
        textureLoad(environment, corner + vec2u(1u, 0u), 0),
        beyond.x,
    );
    let lower = mix(
        textureLoad(environment, corner + vec2u(0u, 1u), 0),
        textureLoad(environment, corner + vec2u(1u, 1u), 0),
        beyond.x,
    );
    return parts.physical.environment_light * mix(upper, lower, beyond.y).rgb;
}

fn smith(first: f32, second: f32, alpha2: f32) -> f32 {
    return first * sqrt(second * second * (1.0 - alpha2) + alpha2);
}

// The contribution of a lamp; `facing` is the cosine between normal and eye.
fn of_lamp(toward: Toward, normal: vec3f, to_eye: vec3f, facing: f32, open: f32) -> Light {
    let alpha2 = parts.physical.alpha * parts.physical.alpha;
    let half = normalize(toward.to_lamp + to_eye);
    // 1 - cos², from the difference of two directions: cosines near 1 have too few digits.
    let between = half - normal;
    let short = 0.5 * dot(between, between);
    let sine2 = short * (2.0 - short);
    let spread = (1.0 - sine2) * alpha2 + sine2;
    let visibility = 0.5 / max(smith(facing, toward.facing, alpha2) + smith(toward.facing, facing, alpha2), 1e-37);
    let light = toward.color * toward.facing;
    let highlight = light * (visibility * alpha2 / (spread * spread));
    let grazing = 1.0 - clamp(dot(half, to_eye), 0.0, 1.0);
    let squared = grazing * grazing;
    let fresnel = squared * squared * grazing;
    let entry = entry_at(toward.facing);
    // Ambient occlusion dims a lamp's light except for its specular part: the highlight stays.
    let soft = light * open;
    return Light(highlight * (1.0 - fresnel), highlight * fresnel, soft * entry.z, soft * entry.w);
}

fn sum(a: Light, b: Light) -> Light {
    return Light(a.mirrored + b.mirrored, a.grazing + b.grazing, a.lost + b.lost, a.let_in + b.let_in);
}

// All light at a position in view space; `of_eye` is the entry of the curve for the cosine `facing`.
fn light_on(position: vec3f, normal: vec3f, to_eye: vec3f, facing: f32, of_eye: vec4f, open: f32) -> Light {
    let mirrored = open * environment_at(in_environment(2.0 * facing * normal - to_eye));
    let matt = open * harmonics_at(in_environment(normal));
    var light = Light(
        // The split sum is off by 0.042 of white on average for the built-in environments, and by up to 0.3 for a light
        // in a rough mirror that is seen edge-on; diffuse light by 0.015.
        mirrored * of_eye.x,
        mirrored * of_eye.y,
        matt * parts.physical.mean_loss,
        matt * parts.physical.mean_let_in,
    );
    if (parts.lights.head > 0.0) {
        let head = Toward(to_eye, facing, vec3f(parts.lights.head));
        light = sum(light, of_lamp(head, normal, to_eye, facing, open));
    }
    for (var index = 0u; index < MAX_LAMPS; index++) {
        var color = parts.lights.lamp_colors[index].rgb;
        if (all(color == vec3f(0.0))) {
            continue;
        }
        let way = parts.lights.lamp_places[index].xyz - parts.lights.lamp_places[index].w * position;
        // A surface at the position of a lamp gets no light from it.
        let to_lamp = way * inverseSqrt(max(dot(way, way), 1e-37));
        let lamp_facing = max(dot(normal, to_lamp), 0.0);
        if (index == 0u) {
            color *= light_of_key(shadow_map, position, normal, lamp_facing);
        }
        light = sum(light, of_lamp(Toward(to_lamp, lamp_facing, color), normal, to_eye, facing, open));
    }
    return light;
}

// The fraction of the light of further bounces that takes on the surface's own colour.
fn of_more_bounces(reflectance: vec3f) -> vec3f {
    // The mean of Schlick's formula weighted by the cosine.
    let mean = reflectance * (20.0 / 21.0) + 1.0 / 21.0;
    return mean * mean * (1.0 - parts.physical.mean_loss) / (1.0 - mean * parts.physical.mean_loss);
}

// Linear light reflected at a position in view space by a surface with a linear colour; the fraction `open` of the
// ambient light reaches it.
fn lit(albedo: vec3f, position: vec3f, normal: vec3f, to_eye: vec3f, open: f32) -> vec3f {
    let facing = max(dot(normal, to_eye), 0.0);
    let of_eye = entry_at(facing);
    let light = light_on(position, normal, to_eye, facing, of_eye, open);
    let reflectance = mix(vec3f(DIELECTRIC), albedo, parts.physical.metallic);
    let again = mix(of_more_bounces(vec3f(DIELECTRIC)), of_more_bounces(albedo), parts.physical.metallic);
    let lost = light.lost * (of_eye.z / max(parts.physical.mean_loss, 1e-6));
    let let_in = light.let_in * (of_eye.w / parts.physical.mean_let_in);
    let matt = 1.0 - parts.physical.metallic;
    return reflectance * light.mirrored + light.grazing + again * lost + matt * albedo * let_in;
}
