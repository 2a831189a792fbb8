// Quotients as processors have them. Adapters may divide with an error of some units in the last place; then neighbours
// that are exactly a pixel apart would be near one another on one adapter and not on the other.

// `part` of `whole`, from -1 to 1, rounded to the nearest number. Preconditions: 0 < whole < 2^24.
fn exact_share(part: i32, whole: i32) -> f32 {
    let size = u32(abs(part));
    let divisor = u32(whole);
    if (size == 0u) {
        return 0.0;
    }
    if (size >= divisor) {
        return f32(sign(part));
    }
    // Long division until there are 24 digits and one more, which says where to round: no quotient of such numbers is
    // in the middle between two of 24 digits.
    var rest = size;
    var digits = 0u;
    var exponent = 0;
    while (digits < (1u << 24u)) {
        rest <<= 1u;
        digits <<= 1u;
        exponent--;
        if (rest >= divisor) {
            rest -= divisor;
            digits |= 1u;
        }
    }
    let rounded = (digits >> 1u) + (digits & 1u);
    // A power of 2 by its bits: adapters may work it out with an error, too.
    let unit = bitcast<f32>(u32(exponent + 1 + 127) << 23u);
    return f32(sign(part)) * f32(rounded) * unit;
}
