//! Ray casting for the ground truth: rays of a view, and their intersections.

use crate::scene::{Background, Camera, Lighting, PhysicalLight};
use glam::{DMat3, DVec2, DVec3};
use std::ops::Range;
use std::sync::Arc;

/// Pixels along each edge of the squares that are worked out at a time.
pub(super) const TILE_PX: u32 = 32;

/// A view in f64, and how its surfaces are lit.
#[derive(Debug, Clone)]
pub struct TruthView {
    pub(super) view_from_frame: DMat3,
    /// In the space of the frame.
    pub(super) eye: DVec3,
    /// Pixels to the right and upwards for a slope of 1.
    pub(super) px_per_slope: DVec2,
    /// The place of the view axis.
    pub(super) axis_px: DVec2,
    pub(super) size_px: [u32; 2],
    pub(super) lighting: Lighting,
    /// Light of an environment on a material, instead of the headlight.
    pub(super) physical: Option<Arc<PhysicalLight>>,
    pub(super) background: Background,
}

/// Ray intersection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    /// Along the view axis.
    pub(super) depth: f64,
    /// Lit; red, green and blue, 0 to 1.
    pub(super) color: DVec3,
    /// See [`Truth::tolerance`].
    pub(super) tolerance: f64,
}

/// Geometry that rays may intersect.
pub(super) trait Visible: Sync {
    /// Intersects the rays of `samples`, row by row.
    fn meet(&self, view: &TruthView, samples: &SampleGrid) -> Vec<Option<Hit>>;
}

/// Sample grid of a rectangle of pixels: `per_edge` along each edge of each pixel, at the centres of equal squares.
pub(super) struct SampleGrid {
    pub(super) columns_px: Range<u32>,
    pub(super) rows_px: Range<u32>,
    /// Along each edge of a pixel.
    pub(super) per_edge: u32,
}

impl TruthView {
    /// Creates the view of `camera` of frames relative to `origin`. Surfaces are lit by the headlight at each sample
    /// unless they are not lit at all.
    pub fn new(camera: &Camera, origin: DVec3, size_px: [u32; 2], lighting: Lighting, background: Background) -> Self {
        let (px_per_slope, axis) = camera.px_per_slope(size_px);
        Self {
            view_from_frame: camera.view_from_world_rotation(),
            eye: camera.eye_in_world() - origin,
            px_per_slope,
            axis_px: DVec2::new(axis.x, f64::from(size_px[1]) - axis.y),
            size_px,
            lighting,
            physical: None,
            background,
        }
    }

    /// Returns the view with the light of an environment on a material, instead of the headlight. Precondition: no lamp
    /// shines.
    #[must_use]
    pub fn with_physical_light(self, physical: PhysicalLight) -> Self {
        Self {
            physical: Some(Arc::new(physical)),
            ..self
        }
    }

    /// The ray through a place of the image, in view space: with a length that makes its depth 1.
    pub(super) fn ray(&self, place_px: [f64; 2]) -> DVec3 {
        DVec3::new(
            (place_px[0] - self.axis_px.x) / self.px_per_slope.x,
            (self.axis_px.y - place_px[1]) / self.px_per_slope.y,
            -1.0,
        )
    }

    pub(super) fn to_view(&self, position_in_frame: DVec3) -> DVec3 {
        self.view_from_frame * (position_in_frame - self.eye)
    }

    pub(super) fn background_at(&self, y_px: f64) -> DVec3 {
        let share = y_px / f64::from(self.size_px[1]);
        let [top, bottom] = [self.background.top, self.background.bottom].map(unit_color);
        top.lerp(bottom, share)
    }
}

impl SampleGrid {
    pub(super) fn size(&self) -> [usize; 2] {
        [&self.columns_px, &self.rows_px].map(|range| range.len() * self.per_edge as usize)
    }

    /// The place of a sample in the image.
    pub(super) fn place_px(&self, column: usize, row: usize) -> [f64; 2] {
        let place = |first: u32, sample: usize| f64::from(first) + (sample as f64 + 0.5) / f64::from(self.per_edge);
        [place(self.columns_px.start, column), place(self.rows_px.start, row)]
    }
}

/// A colour of bytes, 0 to 1.
pub(super) fn unit_color(bytes: [u8; 3]) -> DVec3 {
    DVec3::from_array(bytes.map(|channel| f64::from(channel) / 255.0))
}
