//! Timeline curve of one number per frame.
//!
//! **How it works.** A column of pixels shows the least and the greatest value of the frames that lie in it, so that no
//! spike of a long sequence is lost; painting costs one line per column. Columns are rebuilt when values or width have
//! changed.

use crate::sequence::{FrameFacts, Loader};
use std::ops::Range;

/// Quantity shown by a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Points in the file.
    Points,
    /// Loss of the octree.
    Loss,
    /// Diagonal of the bounds.
    Bounds,
    /// Distance of points from their voxels.
    Error,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Points, Self::Loss, Self::Bounds, Self::Error];

    /// Returns the display name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "Points",
            Self::Loss => "Octree loss",
            Self::Bounds => "Bounds",
            Self::Error => "Voxel error",
        }
    }

    /// Returns the tooltip: description and unit.
    pub fn tooltip(self) -> &'static str {
        match self {
            Self::Points => "Number of points in the file of each frame",
            Self::Loss => "Share of the points that have no octree leaf of their own (%)",
            Self::Bounds => "Diagonal of what holds all points (units of the file)",
            Self::Error => {
                "Distance of points from the centres of the voxels that represent them (RMS, units of the file); of \
                 1,024 points per frame"
            }
        }
    }

    fn of(self, facts: &FrameFacts) -> Option<f32> {
        match self {
            Self::Points => Some(facts.points as f32),
            Self::Loss => facts.loss,
            Self::Bounds => Some(facts.bounds.extent().length()).filter(|_| facts.points > 0),
            Self::Error => facts.voxel_error,
        }
    }
}

/// The values of one quantity and their painted columns.
#[derive(Debug, Default)]
pub(in crate::app) struct Curve {
    key: Option<(Quantity, u64)>,
    /// The frames that have columns.
    frames: Range<usize>,
    values: Vec<Option<f32>>,
    columns: Vec<Option<(f32, f32)>>,
    range: Option<(f32, f32)>,
}

impl Curve {
    /// Updates from `loader`, for a plot of `frames` in `width` columns.
    pub(in crate::app) fn refresh(&mut self, loader: &Loader, quantity: Quantity, frames: &Range<usize>, width: usize) {
        let key = Some((quantity, loader.facts_revision()));
        let is_new = self.key != key;
        if is_new {
            let facts = loader.facts().into_iter();
            self.values = facts.map(|facts| quantity.of(&facts?)).collect();
            self.key = key;
        }
        if is_new || self.columns.len() != width || self.frames != *frames {
            self.frames = frames.clone();
            let shown = self.values.get(frames.clone()).unwrap_or_default();
            self.columns = columns(shown, width);
            let known = self.columns.iter().flatten().copied();
            self.range = known.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        }
    }

    /// Forgets another sequence's values.
    pub(in crate::app) fn forget(&mut self) {
        *self = Self::default();
    }

    /// Least and greatest value in each column; `None` where no frame was prepared yet.
    pub(in crate::app) fn columns(&self) -> &[Option<(f32, f32)>] {
        &self.columns
    }

    /// Least and greatest value of all.
    pub(in crate::app) fn range(&self) -> Option<(f32, f32)> {
        self.range
    }

    /// The value of a frame.
    pub(in crate::app) fn value(&self, frame: usize) -> Option<f32> {
        *self.values.get(frame)?
    }
}

/// Least and greatest of the values whose cells, equally wide, lie in or over each of `width` columns. O(values +
/// width).
fn columns(values: &[Option<f32>], width: usize) -> Vec<Option<(f32, f32)>> {
    let count = values.len();
    let column = |x: usize| {
        let begin = x * count / width;
        let end = ((x + 1) * count).div_ceil(width);
        let known = values[begin..end].iter().flatten();
        known.map(|&v| (v, v)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    (0..width).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wide_frames_span_columns_and_narrow_ones_share_a_column() {
        let values = [Some(1.0), None, Some(3.0)];
        let one = |v: f32| Some((v, v));
        let expected = [one(1.0), one(1.0), None, None, one(3.0), one(3.0)];
        assert_eq!(columns(&values, 6), expected);
        assert_eq!(columns(&values, 1), [Some((1.0, 3.0))]);
        assert_eq!(columns(&[], 2), [None, None]);
        assert_eq!(columns(&values, 0), []);
    }

    proptest! {
        /// No frame is in no column, and none is in a column that it does not touch.
        #[test]
        fn every_frame_covers_the_columns_of_its_cell(count in 1usize..60, width in 1usize..60, frame in 0usize..60) {
            let frame = frame % count;
            let mut values = vec![None; count];
            values[frame] = Some(5.0);
            for (x, column) in columns(&values, width).into_iter().enumerate() {
                // Cells of size `width` and columns of size `count` on a line of length `width · count`.
                let touches = frame * width < (x + 1) * count && (frame + 1) * width > x * count;
                prop_assert_eq!(column.is_some(), touches, "column {}", x);
            }
        }
    }
}
