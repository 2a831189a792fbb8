// Hard disks for deferred shading.

#import common/fragments.wgsl

fn left(in: Varyings) -> Surface {
    if (is_outside_splat(in)) {
        discard;
    }
    return surface(in, in.normal, 1.0);
}
