// Round points: the disk in the square, and always the pixel that contains the point.

#import common/quads.wgsl

fn left(in: Varyings) -> vec4f {
    if (is_outside_disk(in.quad)) {
        discard;
    }
    return vec4f(albedo(in), 1.0);
}
