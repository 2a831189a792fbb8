// What every geometry pass hands from its vertex to its fragment stage, and the splat's mask.

struct Varyings {
    @builtin(position) position: vec4f,
    // -1 to 1 across the quad.
    @location(0) quad: vec2f,
    @location(1) light: vec2f,
    @location(2) @interpolate(flat) color: u32,
    // In view space. Unpacked here: a splat has four vertices and hundreds of fragments.
    @location(3) @interpolate(flat) normal: vec3f,
    // Factor on the mask, of splats.
    @location(4) @interpolate(flat) weight: f32,
}

fn varyings(instance: Instance) -> Varyings {
    let vertex = amplified_vertex(instance);
    let normal = rotate_to_view(oct_decode(vertex.normal));
    let quad = quad_corner(instance.vertex & 3u);
    return Varyings(vertex.clip, quad, unpack2x16unorm(vertex.light), vertex.color, normal, vertex.weight);
}

fn shaded(in: Varyings) -> vec3f {
    return shade(unpack4x8unorm(in.color).rgb, in.normal, in.light, in.position.xy);
}

// How much of a splat there is: usually by the circular Gaussian mask of paper 000 §V; 0 outside the disk.
fn mask_weight(quad: vec2f) -> f32 {
    let radius2 = dot(quad, quad);
    if (radius2 > 1.0) {
        return 0.0;
    }
    switch view.kernel {
        case KERNEL_HAT: { return 1.0 - sqrt(radius2); }
        case KERNEL_BOX: { return 1.0; }
        default: { return exp(-MASK_FALLOFF * radius2); }
    }
}

// What fragments leave for deferred shading: times a weight, and the weight.
struct Surface {
    // Display-referred.
    @location(0) color: vec4f,
    // In view space.
    @location(1) normal: vec4f,
    // The usual distance over that of the fragment. Blending takes the weight from the fourth number of each target.
    @location(2) nearness: vec4f,
}

fn surface(in: Varyings, normal: vec3f, weight: f32) -> Surface {
    // Half floats end at 65504.
    let nearness = min(in.position.z * view.usual_distance / view.near, 6e4);
    let color = unpack4x8unorm(in.color).rgb;
    return Surface(
        vec4f(color, 1.0) * weight,
        vec4f(normal, 1.0) * weight,
        vec4f(nearness, 0.0, 0.0, 1.0) * weight,
    );
}
