// Fragments write a colour and their own depth.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

struct ColorAtDepth {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(in: Varyings) -> ColorAtDepth {
    return ColorAtDepth(left(in), depth_of(in));
}
