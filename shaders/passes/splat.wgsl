// One-pass splatting, Fig. 3 (a) and (b): the mask is the opacity. The quad's corners are not discarded, so with depth
// writing on they hide what is behind them: the square artefacts that the paper shows.

@vertex
fn vertex(instance: Instance) -> Varyings {
    return varyings(instance);
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4f {
    return vec4f(shaded(in), mask_weight(in.quad));
}
