// Quotients rounded as on CPUs. Adapters may divide with an error of some units in the last place; then neighbours that
// are exactly a pixel apart would count as near one another on one adapter and not on another.

// `part` of `whole`, from -1 to 1, rounded to the nearest number. Precondition: 0 < whole < 2^24.
fn exact_share(part: i32, whole: i32) -> f32 {
    let size = u32(abs(part));
    let divisor = u32(whole);
    if (size == 0u) {
        return 0.0;
    }
    if (size >= divisor) {
        return f32(sign(part));
    }
    // Long division to 24 digits and one more, which decides the rounding: no quotient of such numbers is halfway
    // between two of 24 digits.
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
    // A power of 2 from its bit pattern: adapters may compute it with an error, too.
    let unit = bitcast<f32>(u32(exponent + 1 + 127) << 23u);
    return f32(sign(part)) * f32(rounded) * unit;
}
