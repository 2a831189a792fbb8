//! The azimuth at which revolutions are cut.
//!
//! **How it works.** A sensor may be configured to measure in a window of azimuths only, such as 270 to 90 degrees
//! across its front. Cut at azimuth 0, each frame would be the right half of one sweep and the left half of the next.
//! So azimuths are collected at the beginning of a capture ([`Coverage`]); where a large part of the circle is never
//! measured and azimuth 0 is not in it, revolutions are cut in its centre.

/// Azimuths are in hundredths of a degree.
pub(super) const TURN: i32 = 36_000;

const BINS: usize = 720;
const BIN: i32 = TURN / BINS as i32;

/// Smaller parts of a circle that are not measured are lost packets, or the steps of a fast sensor (15 degrees).
const MIN_GAP_BINS: usize = 30;

/// Sensors have one window: of several parts of about the same size none is outside of it.
const MIN_RATIO: usize = 3;

/// The azimuth falls by this much where a revolution begins; less is a stopped head, or a late packet.
const MAX_MIN_FALL: i32 = 2000;

/// Azimuths that were measured.
#[derive(Debug, Clone)]
pub(super) struct Coverage(Vec<bool>);

/// Seam azimuth at which revolutions begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Seam {
    /// An azimuth, from 0 to before [`TURN`].
    pub(super) azimuth: i32,
    /// The azimuth falls by at least as much there, counted from the seam on.
    pub(super) min_fall: i32,
}

impl Default for Seam {
    fn default() -> Self {
        Self {
            azimuth: 0,
            min_fall: MAX_MIN_FALL,
        }
    }
}

impl Seam {
    /// An azimuth counted from the seam on, from 0 to before [`TURN`].
    pub(super) fn after_seam(self, azimuth: i32) -> i32 {
        (azimuth - self.azimuth).rem_euclid(TURN)
    }
}

impl Default for Coverage {
    fn default() -> Self {
        Self(vec![false; BINS])
    }
}

impl Coverage {
    /// Notes a measured azimuth.
    pub(super) fn add(&mut self, azimuth: i32) {
        self.0[(azimuth.rem_euclid(TURN) / BIN) as usize] = true;
    }

    /// The seam of a sensor that measures these azimuths.
    pub(super) fn seam(&self) -> Seam {
        let Some((begin, length)) = self.largest_gap() else {
            return Seam::default();
        };
        let window = (BINS - length) as i32 * BIN;
        let min_fall = MAX_MIN_FALL.min(window / 2);
        let holds_zero = begin + length >= BINS || begin == 0;
        let centre = (begin + length / 2) % BINS;
        Seam {
            azimuth: if holds_zero { 0 } else { centre as i32 * BIN },
            min_fall,
        }
    }

    /// The first bin and the length of the largest part that is not measured; `None` where that is small, or nothing is
    /// measured.
    fn largest_gap(&self) -> Option<(usize, usize)> {
        let first = self.0.iter().position(|&is_measured| is_measured)?;
        let mut largest = (0, 0);
        let mut second = 0;
        let mut length = 0;
        // Once around, from a measured bin back to the same bin.
        for step in 1..=BINS {
            let bin = (first + step) % BINS;
            if self.0[bin] {
                if length > largest.1 {
                    second = largest.1;
                    largest = ((first + step - length) % BINS, length);
                } else {
                    second = second.max(length);
                }
                length = 0;
            } else {
                length += 1;
            }
        }
        let is_single = largest.1 >= MIN_RATIO * second;
        (largest.1 >= MIN_GAP_BINS && is_single).then_some(largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seam(degrees: impl Iterator<Item = i32>) -> i32 {
        let mut coverage = Coverage::default();
        degrees.for_each(|degree| coverage.add(degree * 100));
        coverage.seam().azimuth / 100
    }

    #[test]
    fn revolutions_are_cut_outside_the_window() {
        assert_eq!(seam(0..360), 0);
        // Gaps that include azimuth 0, and small ones.
        assert_eq!(seam(45..315), 0);
        assert_eq!(seam(0..270), 0);
        assert_eq!(seam((0..180).chain(190..360)), 0);
        // Between the last measured half degree and the next.
        assert_eq!(seam((0..90).chain(270..360)), 179);
        assert_eq!(seam((0..30).chain(200..360)), 114);
        assert_eq!(seam((0..10).chain(350..360)), 179);
        assert_eq!(seam(std::iter::empty()), 0);
    }

    #[test]
    fn narrow_windows_have_a_smaller_azimuth_drop() {
        let mut coverage = Coverage::default();
        (-600..600).for_each(|azimuth| coverage.add(azimuth));
        let seam = coverage.seam();
        assert_eq!(seam.min_fall, 600);
        let fall = seam.after_seam(599) - seam.after_seam(-600);
        assert!(fall > seam.min_fall, "{fall}");
    }
}
