// Visibility pass: only the depths of the disks, pushed back by view.depth_slack so that splats of one surface blend.

#import common/fragments.wgsl

fn left(in: Varyings) {
    // The 4D media paper draws squares here; the mode `regular` does too, for the artefacts of its Fig. 3a.
    if (is_outside_splat(in)) {
        discard;
    }
}
