//! The pixels of points that are larger than one.

use super::view::PixelRect;
use crate::scene::PointShape;
use std::ops::Range;

/// A point on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sprite {
    pub(super) place_px: [f32; 2],
    /// Half the edge of the square, or radius of the disk.
    pub(super) half_px: f32,
    pub(super) shape: PointShape,
}

impl Sprite {
    /// Calls `visit` with each row of `clip`, and those of its columns, that the sprite covers.
    #[inline(always)]
    pub(super) fn for_each_row(&self, clip: PixelRect, visit: impl FnMut(i32, Range<i32>)) {
        match self.shape {
            PointShape::Square => self.for_each_row_of_square(clip, visit),
            PointShape::Disk | PointShape::Gaussian => self.for_each_row_of_disk(clip, visit),
        }
    }

    #[inline(always)]
    fn for_each_row_of_square(&self, clip: PixelRect, mut visit: impl FnMut(i32, Range<i32>)) {
        let half = self.half_px;
        // Pixels whose centres are inside.
        let range = |axis: usize| {
            let center = self.place_px[axis];
            let [start, end] = [center - half, center + half].map(|end| (end - 0.5).ceil() as i32);
            start.max(clip.start[axis])..end.min(clip.end[axis])
        };
        let columns = range(0);
        for y in range(1) {
            visit(y, columns.clone());
        }
    }

    #[inline(always)]
    fn for_each_row_of_disk(&self, clip: PixelRect, mut visit: impl FnMut(i32, Range<i32>)) {
        let radius = self.half_px;
        let [x_px, y_px] = self.place_px;
        let own = self.place_px.map(|place| place.floor() as i32);
        let [top, bottom] = [y_px - radius, y_px + radius].map(|end| end.floor() as i32);
        for y in top.max(clip.start[1])..bottom.saturating_add(1).min(clip.end[1]) {
            let aside = y as f32 + 0.5 - y_px;
            let half2 = radius * radius - aside * aside;
            // Pixels whose centres are in the circle, and the one that contains the point.
            let half = half2.max(0.0).sqrt();
            let mut start = (x_px - half - 0.5).ceil() as i32;
            let mut end = (x_px + half + 0.5).floor() as i32;
            if y == own[1] {
                start = start.min(own[0]);
                end = end.max(own[0].saturating_add(1));
            } else if half2 < 0.0 {
                continue;
            }
            visit(y, start.max(clip.start[0])..end.min(clip.end[0]));
        }
    }
}
