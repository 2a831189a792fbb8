// What every geometry pass hands from its vertex to its fragment stage, and the splat's mask.

struct Varyings {
    @builtin(position) position: vec4f,
    // -1 to 1 across the quad.
    @location(0) quad: vec2f,
    @location(1) light: vec2f,
    @location(2) @interpolate(flat) color: u32,
    // In view space. Unpacked here: a splat has four vertices and hundreds of fragments.
    @location(3) @interpolate(flat) normal: vec3f,
}

fn varyings(instance: Instance) -> Varyings {
    let vertex = amplified_vertex(instance);
    let normal = rotate_to_view(oct_decode(vertex.normal));
    return Varyings(vertex.clip, quad_corner(instance.vertex & 3u), vertex.light, vertex.color, normal);
}

fn shaded(in: Varyings) -> vec3f {
    return shade(unpack4x8unorm(in.color).rgb, in.normal, in.light, in.position.xy);
}

// The circular Gaussian mask of paper 000 §V; 0 outside the disk.
fn mask_weight(quad: vec2f) -> f32 {
    let radius2 = dot(quad, quad);
    return select(0.0, exp(-MASK_FALLOFF * radius2), radius2 <= 1.0);
}

// What fragments leave for deferred shading: times a weight, and the weight.
struct Surface {
    // Display-referred.
    @location(0) color: vec4f,
    // In view space.
    @location(1) normal: vec4f,
    // The usual distance over that of the fragment, less 1: half floats are densest at 0, and surfaces near there, in
    // orthographic views most of all. Blending takes the weight from the fourth number of each target.
    @location(2) nearness: vec4f,
}

fn surface(in: Varyings, normal: vec3f, weight: f32) -> Surface {
    // Half floats end at 65504.
    let nearness = min(in.position.z * view.usual_distance / view.near - 1.0, 6e4);
    let color = unpack4x8unorm(in.color).rgb;
    return Surface(
        vec4f(color, 1.0) * weight,
        vec4f(normal, 1.0) * weight,
        vec4f(nearness, 0.0, 0.0, 1.0) * weight,
    );
}
