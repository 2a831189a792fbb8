// Packs a unit vector for `oct_decode`. Twin of `oct_encode` in cloud/record.rs: halves are rounded away from zero,
// where `pack2x16snorm` leaves rounding to the adapter.
fn oct_encode(unit: vec3f) -> u32 {
    let length = abs(unit.x) + abs(unit.y) + abs(unit.z);
    if (length == 0.0) {
        return 0u;
    }
    var folded = unit.xy / length;
    if (unit.z < 0.0) {
        folded = (1.0 - abs(folded.yx)) * select(vec2f(-1.0), vec2f(1.0), folded >= vec2f(0.0));
    }
    let scaled = folded * 32767.0;
    let rounded = vec2i(scaled + select(vec2f(-0.5), vec2f(0.5), scaled >= vec2f(0.0)));
    return (u32(rounded.x) & 0xffffu) | (u32(rounded.y) << 16u);
}
