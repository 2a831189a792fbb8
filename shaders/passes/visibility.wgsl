// Visibility pass: only the depths of the disks, pushed back by view.depth_slack so that splats of one surface blend.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) {
    if (dot(in.quad, in.quad) > 1.0) {
        discard;
    }
}
