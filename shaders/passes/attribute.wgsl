// Attribute pass: sums colour times weight, and weight, of fragments on the visible surface. Additive blending, no
// depth write.

#import common/fragments.wgsl

fn left(in: Varyings) -> vec4f {
    let weight = mask_weight(place_on_splat(in)) * in.weight;
    if (weight == 0.0) {
        discard;
    }
    return vec4f(shaded(in) * weight, weight);
}
