// Visibility pass: only the depths of the disks, pushed back by view.depth_slack so that splats of one surface blend.

#import common/fragments.wgsl

fn left(in: Varyings) {
    // The 4D media paper draws squares here: the artefacts of its Fig. 3e.
    let is_outside = select(is_outside_splat(in), is_outside_surface(in), view.visibility_shape == VISIBILITY_SQUARE);
    if (is_outside) {
        discard;
    }
}
