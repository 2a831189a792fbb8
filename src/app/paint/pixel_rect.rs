//! Rectangles of whole pixels.

use egui::Rect;

/// A rectangle of physical pixels, from the top left corner; `max` is the first row and column outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PixelRect {
    /// First column and row.
    pub min: [u32; 2],
    /// The column and row after the last.
    pub max: [u32; 2],
}

impl PixelRect {
    /// No pixel.
    pub const NOTHING: Self = Self {
        min: [0; 2],
        max: [0; 2],
    };

    /// All pixels of a window.
    pub fn of_size(size_px: [u32; 2]) -> Self {
        Self {
            min: [0; 2],
            max: size_px,
        }
    }

    /// Returns true if the rectangle contains no pixel.
    pub fn is_empty(&self) -> bool {
        self.min[0] >= self.max[0] || self.min[1] >= self.max[1]
    }

    /// Columns and rows.
    pub fn size_px(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.max[axis].saturating_sub(self.min[axis]))
    }

    /// Returns the area: the number of pixels in the rectangle.
    pub fn area_px(&self) -> u64 {
        let [width, height] = self.size_px().map(u64::from);
        width * height
    }

    /// Returns the intersection of both rectangles.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let both = Self {
            min: [0, 1].map(|axis| self.min[axis].max(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].min(other.max[axis])),
        };
        if both.is_empty() { Self::NOTHING } else { both }
    }

    /// The smallest rectangle around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        Self {
            min: [0, 1].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Returns true if the rectangles share a pixel.
    pub fn touches(&self, other: &Self) -> bool {
        !self.intersection(other).is_empty()
    }

    /// Returns true if all pixels of `other` are in the rectangle.
    pub fn holds(&self, other: &Self) -> bool {
        other.is_empty() || self.intersection(other) == *other
    }

    /// The pixels of a clip rectangle, which is in points, rounded as `egui-wgpu` rounds its scissors.
    pub(super) fn of_clip(clip_pt: Rect, pixels_per_point: f32, size_px: [u32; 2]) -> Self {
        // Casts saturate: negative values and NaN become 0.
        let round = |edge_pt: f32| (pixels_per_point * edge_pt).round() as u32;
        let min = [
            round(clip_pt.min.x).min(size_px[0]),
            round(clip_pt.min.y).min(size_px[1]),
        ];
        let max = [
            round(clip_pt.max.x).min(size_px[0]),
            round(clip_pt.max.y).min(size_px[1]),
        ];
        let clip = Self { min, max };
        if clip.is_empty() { Self::NOTHING } else { clip }
    }
}
