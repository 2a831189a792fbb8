//! Division by small numbers, many times a node: a product with a number of a table, the same on every machine.

/// Numbers up to this are divided by.
const MAX: usize = 1536;

const BITS: u32 = 32;

static RECIPROCALS: [i64; MAX + 1] = reciprocals();

const fn reciprocals() -> [i64; MAX + 1] {
    let mut table = [0; MAX + 1];
    let mut number = 1;
    while number <= MAX {
        table[number] = (1 << BITS) / number as i64;
        number += 1;
    }
    table
}

/// The quotient, rounded down. Precondition: `divisor` is 1 to 1536, the dividend within 2²⁰ from 0; beyond, the
/// answer may be off.
#[inline(always)]
pub(in crate::reel) fn divided(dividend: i32, divisor: i32) -> i32 {
    // Half a unit above the dividend no quotient is whole, so rounding does no harm.
    (((2 * i64::from(dividend) + 1) * RECIPROCALS[divisor as usize]) >> (BITS + 1)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_are_rounded_down() {
        for divisor in 1..=MAX as i32 {
            for dividend in (-(1 << 20)..1 << 20).step_by(997).chain(-3 * divisor..3 * divisor) {
                assert_eq!(
                    divided(dividend, divisor),
                    dividend.div_euclid(divisor),
                    "{dividend} / {divisor}"
                );
            }
        }
    }
}
