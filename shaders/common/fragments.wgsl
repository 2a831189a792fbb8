// Fragment outputs, for all kinds of primitives.

#import common/view.wgsl
#import generated/constants

fn is_outside_splat(in: Varyings) -> bool {
    let place = place_on_splat(in);
    return dot(place, place) > 1.0;
}

// The weight of a splat, by default the circular Gaussian mask of the 4D media paper §V; 0 outside the disk.
fn mask_weight(place: vec2f) -> f32 {
    let radius2 = dot(place, place);
    if (radius2 > 1.0) {
        return 0.0;
    }
    switch view.kernel {
        case KERNEL_HAT: { return 1.0 - sqrt(radius2); }
        case KERNEL_BOX: { return 1.0; }
        default: { return exp(-MASK_FALLOFF * radius2); }
    }
}

// Fragment outputs for deferred shading: values times a weight, and the weight.
struct Surface {
    // Display-referred.
    @location(0) color: vec4f,
    // In view space.
    @location(1) normal: vec4f,
    // The reference distance over that of the fragment, less 1: half floats are most precise near 0, and surfaces lie
    // close to it, in orthographic views most of all. Blending takes the weight from the fourth component of each
    // target.
    @location(2) nearness: vec4f,
}

fn surface(in: Varyings, normal: vec3f, weight: f32) -> Surface {
    // The largest half float is 65504.
    let nearness = min(depth_of(in) * view.usual_distance / view.near - 1.0, 6e4);
    return Surface(
        vec4f(albedo(in), 1.0) * weight,
        vec4f(normal, 1.0) * weight,
        vec4f(nearness, 0.0, 0.0, 1.0) * weight,
    );
}
