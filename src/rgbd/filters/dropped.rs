//! Pixels dropped by the depth filters, counted filter by filter.
//!
//! Filters that the user chose are applied. The default ones are for a typical sensor in a typical room: in another
//! scene they may drop most pixels. A default filter that would drop more than half of the measured pixels is not
//! applied, and one that drops more than a fifth is named: in the recordings tested (Redwood, PCL's grabbers) the
//! default filters drop a few per cent.

use super::parameters::KINDS;
use super::{FilterKind, Filters};
use crate::rgbd::DepthImage;

/// Share of the measured pixels above which a usual filter is named.
pub const NOTICEABLE_SHARE: f64 = 0.2;

/// Share of the measured pixels above which a usual filter is not applied.
const MAX_SHARE: f64 = 0.5;

/// Pixels that one filter dropped, or would drop.
#[derive(Debug, Clone, Copy)]
pub struct DroppedPixels {
    /// The filter.
    pub filter: &'static FilterKind,
    /// Fraction of the measured pixels.
    pub share: f64,
}

/// Filters that were applied to one image, and the fate of its pixels.
#[derive(Debug, Clone, Default)]
pub struct FilterReport {
    /// The filters that were applied.
    pub applied: Filters,
    /// Applied filters that dropped pixels.
    pub dropped: Vec<DroppedPixels>,
    /// Filters that were not applied, as they would drop most of the image.
    pub skipped: Vec<DroppedPixels>,
}

impl Filters {
    /// As [`Filters::apply`]. Where `is_automatic`, a filter that would drop more than half of the measured pixels is
    /// skipped.
    pub fn apply_and_count(&self, depth: DepthImage, is_automatic: bool) -> (DepthImage, FilterReport) {
        let measured = depth.valid_count();
        let mut report = FilterReport {
            applied: *self,
            ..FilterReport::default()
        };
        let mut image = depth;
        for kind in KINDS.iter().filter(|kind| (kind.is_on)(self)) {
            let before = image.valid_count();
            let after = self.only(kind).apply(image.clone());
            let count = before.saturating_sub(after.valid_count());
            let dropped = DroppedPixels {
                filter: kind,
                share: count as f64 / measured.max(1) as f64,
            };
            if is_automatic && dropped.share > MAX_SHARE {
                (kind.set_on)(&mut report.applied, false);
                report.skipped.push(dropped);
                continue;
            }
            if count > 0 {
                report.dropped.push(dropped);
            }
            image = after;
        }
        (image, report)
    }

    /// One of these filters with its parameters, and no other.
    fn only(&self, kind: &FilterKind) -> Self {
        let mut only = *self;
        for other in KINDS.iter().filter(|other| other.name != kind.name) {
            (other.set_on)(&mut only, false);
        }
        only
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::filters::test_images::noise;

    fn wall(far_share: f64) -> DepthImage {
        let far_rows = (100.0 * far_share) as usize;
        let depth = |at: usize| if at / 50 < far_rows { 12.0 } else { 2.0 };
        DepthImage::new([50, 100], (0..5000).map(depth).collect()).unwrap()
    }

    #[test]
    fn applying_filters_one_by_one_matches_applying_all() {
        for image in [noise([45, 27], 0.2), noise([64, 48], 0.0), wall(0.3)] {
            let (counted, report) = Filters::USUAL.apply_and_count(image.clone(), false);
            assert_eq!(counted, Filters::USUAL.apply(image));
            assert_eq!(report.applied, Filters::USUAL);
        }
    }

    #[test]
    fn a_default_filter_that_would_drop_most_is_skipped() {
        let (image, report) = Filters::USUAL.apply_and_count(wall(0.9), true);
        // All except the corners of two rectangles, which have too few neighbours for `flying`.
        assert_eq!(image.valid_count(), 5000 - 8);
        assert_eq!(report.applied.near, None);
        assert_eq!(report.applied.flying, Filters::USUAL.flying);
        assert_eq!(report.skipped.len(), 1);
        assert_eq!(report.skipped[0].filter.name, "near");
        assert!((report.skipped[0].share - 0.9).abs() < 1e-9);
        // An explicit choice is applied.
        let (image, report) = Filters::USUAL.apply_and_count(wall(0.9), false);
        assert_eq!((image.valid_count(), report.skipped.len()), (500 - 4, 0));
        assert_eq!(report.dropped[0].filter.name, "near");
    }

    #[test]
    fn losses_below_half_are_counted() {
        let (image, report) = Filters::USUAL.apply_and_count(wall(0.3), true);
        assert_eq!(image.valid_count(), 3500 - 4);
        assert!((report.dropped[0].share - 0.3).abs() < 1e-9 && report.skipped.is_empty());
    }
}
