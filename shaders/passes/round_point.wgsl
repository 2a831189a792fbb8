// Round points: the disk in the square, and in any case the pixel that the point is in.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    if (is_beside_disk(in.quad)) {
        discard;
    }
    return vec4f(albedo(in), 1.0);
}
