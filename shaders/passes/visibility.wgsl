// Visibility pass: only the depths of the disks, pushed back by view.depth_slack so that splats of one surface blend.

#import common/fragments.wgsl

fn left(in: Varyings) {
    if (is_outside_splat(in)) {
        discard;
    }
}
