//! Turning point of a lens polynomial.

/// Tangent of 89 degrees: depth along the axis says nothing about points further aside.
pub(super) const WIDEST: f64 = 57.289_961_630_759_42;

/// Fraction of the turning point of its polynomial up to which a lens is used: nearer to it the inverse loses all
/// digits.
pub(super) const BEFORE_TURN: f64 = 0.999;

/// The first `value` between 0 and `end` at which `is_beyond` is true, by steps and then by halves; `end` where there
/// is none.
pub(super) fn first_beyond(end: f64, steps: u32, is_beyond: impl Fn(f64) -> bool) -> f64 {
    let at = |step: u32| end * f64::from(step) / f64::from(steps);
    let Some(step) = (1..=steps).find(|&step| is_beyond(at(step))) else {
        return end;
    };
    let (mut within, mut beyond) = (at(step - 1), at(step));
    for _ in 0..60 {
        let center = f64::midpoint(within, beyond);
        if is_beyond(center) {
            beyond = center;
        } else {
            within = center;
        }
    }
    within
}
