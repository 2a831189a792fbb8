// Visibility pass of whole squares, as in the 4D media paper: the artefacts of its Fig. 3e.

#import common/fragments.wgsl

fn left(in: Varyings) {
    if (is_outside_surface(in)) {
        discard;
    }
}
