// One-pass splatting, Fig. 3 (a) and (b): the mask is the opacity. Corners of quads on surfaces are not discarded, so
// with depth writes on they hide surfaces behind them: the square artefacts shown in the paper.

#import common/fragments.wgsl

fn left(in: Varyings) -> vec4f {
    if (is_outside_surface(in)) {
        discard;
    }
    return vec4f(shaded(in), mask_weight(place_on_splat(in)));
}
