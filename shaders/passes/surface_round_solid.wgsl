// Opaque geometry with round points, for deferred shading.

#import common/fragments.wgsl
#import common/quads.wgsl

fn left(in: Varyings) -> Surface {
    if (is_outside_disk(in.quad)) {
        discard;
    }
    return surface(in, in.normal, 1.0);
}
