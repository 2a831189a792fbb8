// Hard disks without blending.

#import common/fragments.wgsl

fn left(in: Varyings) -> vec4f {
    if (is_outside_splat(in)) {
        discard;
    }
    return vec4f(shaded(in), 1.0);
}
