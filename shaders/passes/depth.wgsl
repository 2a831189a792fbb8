// Depth only, of whole quads.

fn left(in: Varyings) {}
