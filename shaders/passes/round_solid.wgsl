// Opaque geometry with round points.

#import common/quads.wgsl

fn left(in: Varyings) -> vec4f {
    if (is_outside_disk(in.quad)) {
        discard;
    }
    return vec4f(shaded(in), 1.0);
}
