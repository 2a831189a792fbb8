// Plain points: unlit colours, regardless of the lighting.

fn left(in: Varyings) -> vec4f {
    return vec4f(albedo(in), 1.0);
}
