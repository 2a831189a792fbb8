// Attribute pass: sums colour times weight, and weight, of what lies at the surface. Additive blending, no depth write.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    let weight = mask_weight(in.quad) * in.weight;
    if (weight == 0.0) {
        discard;
    }
    return vec4f(shaded(in) * weight, weight);
}
