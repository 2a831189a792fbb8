// Double-precision floats (IEEE 754) emulated with integers: bit for bit as on a CPU, on adapters without doubles.
//
// A number is two words, the lower one in x. Sums, products, quotients and roots are rounded to nearest, ties to even.
// Zero is supported; subnormal numbers, infinities and NaN are not.

// 64-bit integers, the lower word in x.
fn add_u64(a: vec2u, b: vec2u) -> vec2u {
    let low = a.x + b.x;
    return vec2u(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn sub_u64(a: vec2u, b: vec2u) -> vec2u {
    return vec2u(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn is_less_u64(a: vec2u, b: vec2u) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

fn is_zero_u64(a: vec2u) -> bool {
    return (a.x | a.y) == 0u;
}

// By less than 64 bits.
fn shifted_left(a: vec2u, bits: u32) -> vec2u {
    if (bits >= 32u) {
        return vec2u(0u, a.x << (bits - 32u));
    }
    if (bits == 0u) {
        return a;
    }
    return vec2u(a.x << bits, (a.y << bits) | (a.x >> (32u - bits)));
}

// Sticky: the lowest bit is set if any set bit is shifted out.
fn shifted_right(a: vec2u, bits: u32) -> vec2u {
    if (bits == 0u) {
        return a;
    }
    if (bits >= 64u) {
        return vec2u(select(1u, 0u, is_zero_u64(a)), 0u);
    }
    if (bits == 32u) {
        return vec2u(a.y | select(1u, 0u, a.x == 0u), 0u);
    }
    if (bits > 32u) {
        let lost = a.x | (a.y << (64u - bits));
        return vec2u((a.y >> (bits - 32u)) | select(1u, 0u, lost == 0u), 0u);
    }
    let lost = a.x << (32u - bits);
    return vec2u((a.y << (32u - bits)) | (a.x >> bits) | select(1u, 0u, lost == 0u), a.y >> bits);
}

fn product_u32(a: u32, b: u32) -> vec2u {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let low = a_low * b_low;
    let center_a = a_low * b_high;
    let center_b = a_high * b_low;
    let center = (low >> 16u) + (center_a & 0xffffu) + (center_b & 0xffffu);
    return vec2u(
        (center << 16u) | (low & 0xffffu),
        a_high * b_high + (center_a >> 16u) + (center_b >> 16u) + (center >> 16u),
    );
}

// A significand has its leading bit at 62.
fn significand(a: vec2u) -> vec2u {
    if (is_zero_u64(vec2u(a.x, a.y & 0x7fffffffu))) {
        return vec2u(0u);
    }
    return shifted_left(vec2u(a.x, (a.y & 0xfffffu) | 0x100000u), 10u);
}

fn exponent(a: vec2u) -> i32 {
    return i32((a.y >> 20u) & 0x7ffu);
}

fn rounded(sign: u32, exponent: i32, significand: vec2u) -> vec2u {
    let rest = significand.x & 0x3ffu;
    var number = vec2u((significand.y << 22u) | (significand.x >> 10u), significand.y >> 10u);
    if (rest > 0x200u || (rest == 0x200u && (number.x & 1u) == 1u)) {
        number = add_u64(number, vec2u(1u, 0u));
    }
    // The leading bit adds one to the exponent.
    return add_u64(vec2u(0u, (u32(exponent - 1) << 20u) | sign), number);
}

fn normalized_f64(sign: u32, exponent: i32, significand: vec2u) -> vec2u {
    if (is_zero_u64(significand)) {
        return vec2u(0u);
    }
    var zeros = countLeadingZeros(significand.y);
    if (significand.y == 0u) {
        zeros = 32u + countLeadingZeros(significand.x);
    }
    if (zeros == 0u) {
        return rounded(sign, exponent + 1, shifted_right(significand, 1u));
    }
    return rounded(sign, exponent - i32(zeros - 1u), shifted_left(significand, zeros - 1u));
}

// `bits` is the bit pattern of the number.
fn f64_of_f32(bits: u32) -> vec2u {
    let sign = bits & 0x80000000u;
    let fraction = bits & 0x7fffffu;
    let exponent = i32((bits >> 23u) & 0xffu);
    if (exponent == 0) {
        return normalized_f64(sign, 896, vec2u(0u, fraction << 8u));
    }
    return vec2u(fraction << 29u, sign | (u32(exponent + 896) << 20u) | (fraction >> 3u));
}

fn negated(a: vec2u) -> vec2u {
    return vec2u(a.x, a.y ^ 0x80000000u);
}

fn magnitude(a: vec2u) -> vec2u {
    return vec2u(a.x, a.y & 0x7fffffffu);
}

fn sum(a: vec2u, b: vec2u) -> vec2u {
    let a_is_larger = !is_less_u64(magnitude(a), magnitude(b));
    let large = select(b, a, a_is_larger);
    let small = select(a, b, a_is_larger);
    if (is_zero_u64(magnitude(small))) {
        return select(large, vec2u(0u, large.y & small.y), is_zero_u64(magnitude(large)));
    }
    let sign = large.y & 0x80000000u;
    let apart = u32(exponent(large) - exponent(small));
    let aligned = shifted_right(significand(small), apart);
    let of_one_sign = sign == (small.y & 0x80000000u);
    let added = add_u64(significand(large), aligned);
    let left = sub_u64(significand(large), aligned);
    return normalized_f64(sign, exponent(large), select(left, added, of_one_sign));
}

fn difference(a: vec2u, b: vec2u) -> vec2u {
    return sum(a, negated(b));
}

fn product(a: vec2u, b: vec2u) -> vec2u {
    let sign = (a.y ^ b.y) & 0x80000000u;
    let one = shifted_left(significand(a), 1u);
    let other = shifted_left(significand(b), 1u);
    if (is_zero_u64(one) || is_zero_u64(other)) {
        return vec2u(0u, sign);
    }
    let lowest = product_u32(one.x, other.x);
    let low = add_u64(product_u32(one.y, other.x), vec2u(lowest.y, 0u));
    let center = add_u64(product_u32(one.x, other.y), vec2u(low.x, 0u));
    let high = add_u64(product_u32(one.y, other.y), vec2u(low.y, 0u));
    var all = add_u64(high, vec2u(center.y, 0u));
    all.x |= select(1u, 0u, (center.x | lowest.x) == 0u);
    return normalized_f64(sign, exponent(a) + exponent(b) - 1023, all);
}

// Precondition: b is not zero.
fn quotient(a: vec2u, b: vec2u) -> vec2u {
    let sign = (a.y ^ b.y) & 0x80000000u;
    let divisor = significand(b);
    var rest = significand(a);
    if (is_zero_u64(rest)) {
        return vec2u(0u, sign);
    }
    var exponent_of = exponent(a) - exponent(b) + 1023;
    if (is_less_u64(rest, divisor)) {
        rest = shifted_left(rest, 1u);
        exponent_of -= 1;
    }
    var digits = vec2u(0u);
    for (var digit = 0u; digit < 56u; digit++) {
        digits = shifted_left(digits, 1u);
        if (!is_less_u64(rest, divisor)) {
            rest = sub_u64(rest, divisor);
            digits.x |= 1u;
        }
        rest = shifted_left(rest, 1u);
    }
    digits = shifted_left(digits, 7u);
    digits.x |= select(1u, 0u, is_zero_u64(rest));
    return rounded(sign, exponent_of, digits);
}

// Precondition: not negative.
fn root(a: vec2u) -> vec2u {
    var radicand = significand(a);
    if (is_zero_u64(radicand)) {
        return vec2u(0u);
    }
    let power = exponent(a) - 1023;
    let odd = power & 1;
    radicand = shifted_left(radicand, u32(odd));
    var rest = vec2u(0u);
    var digits = vec2u(0u);
    for (var digit = 0u; digit < 56u; digit++) {
        rest = shifted_left(rest, 2u);
        rest.x |= radicand.y >> 30u;
        radicand = shifted_left(radicand, 2u);
        var tried = shifted_left(digits, 2u);
        tried.x |= 1u;
        digits = shifted_left(digits, 1u);
        if (!is_less_u64(rest, tried)) {
            rest = sub_u64(rest, tried);
            digits.x |= 1u;
        }
    }
    digits = shifted_left(digits, 7u);
    digits.x |= select(1u, 0u, is_zero_u64(rest));
    return rounded(0u, (power - odd) / 2 + 1023, digits);
}

fn is_negative(a: vec2u) -> bool {
    return (a.y & 0x80000000u) != 0u && !is_zero_u64(magnitude(a));
}

fn is_at_most(a: vec2u, b: vec2u) -> bool {
    return !is_negative(difference(b, a));
}

fn sum_of_products(a: array<vec2u, 3>, b: array<vec2u, 3>) -> vec2u {
    return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}
