//! Damage: the region to be repainted, as a few rectangles that share no pixel.
//!
//! **How it works.** Changed shapes hand in their bounds one after the other. A rectangle is merged with an existing
//! one if the rectangle around both costs few more pixels than the two; else the part painted already is cut off it,
//! which leaves up to four parts. Two long thin rectangles that cross therefore stay thin, and glyphs of a line become
//! one. When there are too many, those that cost the least are merged.

use super::PixelRect;

/// More rectangles cost more in going through the list of shapes than their pixels.
const MAX_RECTS: usize = 8;

/// Rectangles that are held before some are joined.
const MAX_HELD: usize = 2 * MAX_RECTS;

/// Number of pixels painted in the time of one more traversal of the shape list.
const SPARE_PX: u64 = 4096;

/// Rectangles that share no pixel.
#[derive(Debug, Clone, Default)]
pub(super) struct Damage {
    rects: Vec<PixelRect>,
}

impl Damage {
    /// Adds a changed rectangle.
    pub(super) fn add(&mut self, rect: PixelRect) {
        if rect.is_empty() {
            return;
        }
        let mut rect = rect;
        let mut index = 0;
        while index < self.rects.len() {
            let held = self.rects[index];
            if held.holds(&rect) {
                return;
            }
            if cost(&held, &rect) <= SPARE_PX {
                // The union may touch rectangles that were already checked.
                rect = rect.union(&held);
                self.rects.swap_remove(index);
                index = 0;
            } else {
                index += 1;
            }
        }
        self.add_cut(rect, 0);
        while self.rects.len() > MAX_HELD {
            self.join_cheapest();
        }
    }

    /// Takes all of it, at most [`MAX_RECTS`].
    pub(super) fn take(&mut self) -> Vec<PixelRect> {
        while self.rects.len() > MAX_RECTS {
            self.join_cheapest();
        }
        std::mem::take(&mut self.rects)
    }

    /// Adds the part of `rect` that is in none of the rectangles from `first` on.
    fn add_cut(&mut self, rect: PixelRect, first: usize) {
        for index in first..self.rects.len() {
            let hole = self.rects[index].intersection(&rect);
            if hole.is_empty() {
                continue;
            }
            for part in around(&rect, &hole) {
                if !part.is_empty() {
                    // The parts of one rectangle do not overlap.
                    self.add_cut(part, index + 1);
                }
            }
            return;
        }
        self.rects.push(rect);
    }

    fn join_cheapest(&mut self) {
        let pairs = (0..self.rects.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
        let cheapest = pairs.min_by_key(|&(a, b)| cost(&self.rects[a], &self.rects[b]));
        let Some((first, second)) = cheapest else {
            return;
        };
        let mut joined = self.rects[first].union(&self.rects[second]);
        self.rects.swap_remove(second);
        self.rects.swap_remove(first);
        // Merges every rectangle that it touches, until none is left.
        while let Some(index) = self.rects.iter().position(|rect| rect.touches(&joined)) {
            joined = joined.union(&self.rects.swap_remove(index));
        }
        self.rects.push(joined);
    }
}

/// Pixels in the rectangle around both and in neither.
fn cost(a: &PixelRect, b: &PixelRect) -> u64 {
    let either = a.area_px() + b.area_px() - a.intersection(b).area_px();
    a.union(b).area_px().saturating_sub(either)
}

/// Returns the parts of `rect` above, below, left and right of `hole`, which lies in it.
fn around(rect: &PixelRect, hole: &PixelRect) -> [PixelRect; 4] {
    let (min, max) = (rect.min, rect.max);
    let rows = [hole.min[1], hole.max[1]];
    let part = |min, max| PixelRect { min, max };
    [
        part(min, [max[0], rows[0]]),
        part([min[0], rows[1]], max),
        part([min[0], rows[0]], [hole.min[0], rows[1]]),
        part([hole.max[0], rows[0]], [max[0], rows[1]]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rect(min: [u32; 2], size: [u32; 2]) -> PixelRect {
        let max = [min[0] + size[0], min[1] + size[1]];
        PixelRect { min, max }
    }

    #[test]
    fn a_line_of_glyphs_is_one_rectangle_and_a_cross_stays_thin() {
        let mut damage = Damage::default();
        for glyph in 0..40 {
            damage.add(rect([10 + 9 * glyph, 20], [7, 12]));
        }
        assert_eq!(damage.take(), [rect([10, 20], [358, 12])]);
        damage.add(rect([0, 400], [1000, 2]));
        damage.add(rect([500, 0], [2, 800]));
        let cross = damage.take();
        let area: u64 = cross.iter().map(PixelRect::area_px).sum();
        assert_eq!(area, 2000 + 1600 - 4);
        assert!(damage.take().is_empty());
    }

    proptest! {
        #[test]
        fn damage_covers_all_changes_and_no_pixel_twice(
            added in prop::collection::vec(([0u32..1200, 0u32..700], [0u32..300, 0u32..120]), 0..60)
        ) {
            let added: Vec<PixelRect> = added.into_iter().map(|(min, size)| rect(min, size)).collect();
            let mut damage = Damage::default();
            for &rect in &added {
                damage.add(rect);
            }
            let rects = damage.take();
            prop_assert!(rects.len() <= MAX_RECTS);
            for (index, rect) in rects.iter().enumerate() {
                prop_assert!(!rect.is_empty());
                prop_assert!(rects[..index].iter().all(|other| !other.touches(rect)));
            }
            for rect in &added {
                let held: u64 = rects.iter().map(|held| held.intersection(rect).area_px()).sum();
                prop_assert_eq!(held, rect.area_px());
            }
        }
    }
}
