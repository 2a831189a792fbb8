//! Surfels of what a picture shows, with normals and radii from the picture ([`crate::analysis::screen`]).
//!
//! **How it works.** They are made where packets are: a packet has records of visible points as it has those of a cut
//! of levels of detail, and whoever draws, picks or exports needs to know no more. So both renderers draw the same
//! records, and a graphics card gets them with each new view. As long as view, points and what they are drawn for stay,
//! the records are the same allocations.
//!
//! Pictures of more than 2²³ pixels are looked at in coarser steps.

use super::{Content, Surfels, ViewTransform};
use crate::analysis::NormalErrors;
use crate::analysis::screen::{ScreenCloud, ScreenEstimator, ScreenView, Search};
use crate::cloud::{PointRecord, ShapeRecord};
use std::sync::Arc;
use std::time::Instant;

/// Most pixels that points are told apart by.
const MOST_PIXELS: f32 = (1 << 23) as f32;

/// What was done for the last picture with normals of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct ScreenStats {
    /// Points that might have been seen.
    pub points: usize,
    /// Those that were.
    pub visible: usize,
    /// Milliseconds of telling them apart.
    pub cull_ms: f64,
    /// Milliseconds of normals and radii.
    pub normals_ms: f64,
    /// Errors of the normals, where these are shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<NormalErrors>,
}

/// What surfels of the screen depend on.
#[derive(Debug, Clone)]
pub(super) struct ScreenInput {
    /// The points; where errors are shown with the normals that are held to be true.
    pub(super) content: Content,
    pub(super) view: ViewTransform,
    pub(super) viewport_px: [u32; 2],
    pub(super) cloud: ScreenCloud,
    pub(super) shows_errors: bool,
}

/// The last surfels of the screen.
#[derive(Debug, Default)]
pub(super) struct ScreenSurfels {
    estimator: ScreenEstimator,
    last: Option<(ScreenInput, Content, ScreenStats)>,
}

impl ScreenSurfels {
    /// What is drawn; content without points stays as it is.
    pub(super) fn content(&mut self, from: ScreenInput) -> Content {
        if let Some((of, content, _)) = &self.last
            && *of == from
        {
            return content.clone();
        }
        let Some(points) = from.content.points() else {
            self.last = None;
            return from.content;
        };
        let (points, truth) = (Arc::clone(points), from.content.shapes().cloned());
        let truth = truth.filter(|_| from.shows_errors);
        let (surfels, stats) = self.make(&from, &points, truth.as_deref().map(Vec::as_slice));
        let content = Content::Surfels(surfels);
        self.last = Some((from, content.clone(), stats));
        content
    }

    /// Of the last picture, if it had such surfels.
    pub(super) fn stats(&self) -> Option<ScreenStats> {
        self.last.as_ref().map(|(_, _, stats)| *stats)
    }

    /// Another picture was made, without them.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }

    fn make(
        &mut self,
        from: &ScreenInput,
        points: &[PointRecord],
        truth: Option<&[ShapeRecord]>,
    ) -> (Surfels, ScreenStats) {
        let view = screen_view(&from.view, from.viewport_px);
        let start = Instant::now();
        let visible = self.estimator.cull(&view, points, &from.cloud);
        let cull_ms = milliseconds_since(start);
        let start = Instant::now();
        let shapes = self.estimator.surface(&visible, &from.cloud, Search::Fixed);
        let normals_ms = milliseconds_since(start);
        let mut drawn: Vec<PointRecord> = visible.slots.iter().map(|&slot| points[slot as usize]).collect();
        let errors = truth.map(|truth| {
            let (errors, colors) = NormalErrors::of(&shapes, truth, &visible.slots);
            for (point, color) in drawn.iter_mut().zip(colors) {
                point.color = color;
            }
            errors
        });
        let stats = ScreenStats {
            points: points.len(),
            visible: visible.len(),
            cull_ms,
            normals_ms,
            errors,
        };
        let surfels = Surfels {
            points: Arc::new(drawn),
            shapes: Arc::new(shapes),
        };
        (surfels, stats)
    }
}

impl PartialEq for ScreenInput {
    fn eq(&self, other: &Self) -> bool {
        self.content == other.content
            && self.view == other.view
            && self.viewport_px == other.viewport_px
            && self.cloud == other.cloud
            && self.shows_errors == other.shows_errors
    }
}

/// A view with the pixels that points are told apart by.
pub fn screen_view(view: &ViewTransform, viewport_px: [u32; 2]) -> ScreenView {
    let [width, height] = viewport_px.map(|edge| edge.max(1) as f32);
    let scale = (MOST_PIXELS / (width * height)).sqrt().min(1.0);
    let size_px = [width, height].map(|edge| (edge * scale).ceil() as u32);
    let half = [0.5 * scale * width, 0.5 * scale * height];
    let [right, up] = view.center_ndc;
    ScreenView {
        rotation: view.view_from_frame_rotation,
        eye_high: view.eye_high,
        eye_low: view.eye_low,
        near: view.near,
        size_px,
        px_per_slope: [view.focal[0] * half[0], -view.focal[1] * half[1]],
        middle_px: [half[0] * (1.0 + right), half[1] * (1.0 - up)],
    }
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
