//! Visible points of a cloud in an image, as surfels with normals from the image ([`crate::analysis::screen`]): created
//! here, or by a GPU that has the points.
//!
//! **How it works.** [`VisiblePoints`] holds the inputs of these surfels: points, view and spacing. A GPU needs no more
//! (`render/gpu/visible`). If points come from a depth image in the colours of its camera, it has the images instead
//! and creates points from them (`render/gpu/depth_images`). Code that needs the records themselves, such as picking,
//! requests them from the CPU; once they are created, they stay.

use crate::analysis::NormalErrors;
use crate::analysis::screen::{ScreenCloud, ScreenEstimator, ScreenView, Search};
use crate::cloud::{PointRecord, ShapeRecord};
use crate::locks::lock;
use crate::rgbd::DepthFrame;
use crate::stopwatch::milliseconds_since;
use glam::Vec3;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Instant;

/// Statistics of the work done for the last image with screen-space normals.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct ScreenStats {
    /// Points that might have been seen.
    pub points: usize,
    /// Visible points.
    pub visible: usize,
    /// Milliseconds of the visibility test, if measured: on a GPU, by its own clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cull_ms: Option<f64>,
    /// Milliseconds of normals and radii, in the same way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normals_ms: Option<f64>,
    /// Errors of the normals, where these are shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<NormalErrors>,
}

/// The images that points were made from.
#[derive(Debug, Clone)]
pub struct PointImages {
    /// The images.
    pub frame: Arc<DepthFrame>,
    /// Origin that points are relative to, in the frame of the camera.
    pub origin: Vec3,
    /// The colour of all of them, if it does not come from the colour image.
    pub one_color: Option<[u8; 4]>,
}

/// Points, of which the visible ones are drawn.
#[derive(Debug)]
pub struct VisiblePoints {
    /// All of them.
    pub points: Arc<Vec<PointRecord>>,
    /// Images that they were created from, where a GPU can create the same from them: one point per pixel, holes among
    /// them.
    pub images: Option<PointImages>,
    /// View with the pixels by which they are distinguished.
    pub view: ScreenView,
    /// Further properties of the points.
    pub cloud: ScreenCloud,
    estimator: Arc<Mutex<ScreenEstimator>>,
    made: OnceLock<VisibleSurfels>,
}

/// Surfels of the visible points.
#[derive(Debug, Clone)]
pub struct VisibleSurfels {
    /// Positions and colours.
    pub points: Arc<Vec<PointRecord>>,
    /// Normals and radii.
    pub shapes: Arc<Vec<ShapeRecord>>,
    /// Statistics of their computation.
    pub stats: ScreenStats,
}

impl VisiblePoints {
    /// Creates the visible points of `points`; `estimator` is used by turns.
    pub fn new(
        points: Arc<Vec<PointRecord>>,
        images: Option<PointImages>,
        view: ScreenView,
        cloud: ScreenCloud,
        estimator: Arc<Mutex<ScreenEstimator>>,
    ) -> Self {
        Self {
            points,
            images,
            view,
            cloud,
            estimator,
            made: OnceLock::new(),
        }
    }

    /// Their records, made by the CPU on first request.
    pub fn surfels(&self) -> &VisibleSurfels {
        self.made.get_or_init(|| {
            let mut estimator = lock(&self.estimator);
            VisibleSurfels::make(&mut estimator, &self.points, &self.view, &self.cloud, None)
        })
    }

    /// Returns the number of records that the renderer begins with: for an image one per pixel, whether it is a point
    /// or a hole.
    pub fn record_count(&self) -> usize {
        let pixels = self.images.as_ref().map(|images| images.frame.pixels());
        pixels.unwrap_or(self.points.len())
    }

    /// Returns the statistics of the CPU's work for them, if it was requested.
    pub fn stats(&self) -> Option<ScreenStats> {
        self.made.get().map(|made| made.stats)
    }
}

impl VisibleSurfels {
    /// Computes the visible surfels of `points`. With shapes of all points whose normals are taken as ground truth,
    /// they have the colours of errors.
    pub(in crate::scene) fn make(
        estimator: &mut ScreenEstimator,
        points: &[PointRecord],
        view: &ScreenView,
        cloud: &ScreenCloud,
        truth: Option<&[ShapeRecord]>,
    ) -> Self {
        let start = Instant::now();
        let visible = estimator.cull(view, points, cloud);
        let cull_ms = milliseconds_since(start);
        let start = Instant::now();
        let shapes = estimator.surface(&visible, cloud, Search::Fixed);
        let normals_ms = milliseconds_since(start);
        let mut drawn: Vec<PointRecord> = visible.slots.iter().map(|&slot| points[slot as usize]).collect();
        let errors = truth.map(|truth| {
            let (errors, colors) = NormalErrors::of(&shapes, truth, &visible.slots);
            for (point, color) in drawn.iter_mut().zip(colors) {
                point.color = color;
            }
            errors
        });
        Self {
            points: Arc::new(drawn),
            shapes: Arc::new(shapes),
            stats: ScreenStats {
                points: points.len(),
                visible: visible.len(),
                cull_ms: Some(cull_ms),
                normals_ms: Some(normals_ms),
                errors,
            },
        }
    }
}
