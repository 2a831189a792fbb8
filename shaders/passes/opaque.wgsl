// Hard disks, not blended.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    if (dot(in.quad, in.quad) > 1.0) {
        discard;
    }
    return vec4f(shaded(in), 1.0);
}
