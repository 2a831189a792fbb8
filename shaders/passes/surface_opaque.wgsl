// Hard disks for deferred shading.

#import common/fragments.wgsl

fn left(in: Varyings) -> Surface {
    if (is_beside_splat(in)) {
        discard;
    }
    return surface(in, in.normal, 1.0);
}
