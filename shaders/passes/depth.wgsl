// Only depths, of whole quads.

fn left(in: Varyings) {}
