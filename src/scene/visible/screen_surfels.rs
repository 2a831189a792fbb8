//! Screen-space surfels of the visible points of an image, with normals and radii from the image
//! ([`crate::analysis::screen`]).
//!
//! **How it works.** They are created where packets are: a packet has records of visible points like those of a cut of
//! levels of detail, and renderers, picking and exports need no more. A GPU creates them itself and gets all points
//! once ([`Content::Visible`]); then a view costs it no upload, and the CPU nothing. As long as view, points and
//! purpose stay, the records are the same allocations.
//!
//! Images of more than 2²³ pixels are processed in coarser steps.

use super::visible_points::{PointImages, ScreenStats, VisiblePoints, VisibleSurfels};
use crate::analysis::screen::{ScreenCloud, ScreenEstimator, ScreenView};
use crate::locks::lock;
use crate::scene::{Content, Surfels, ViewTransform};
use std::sync::{Arc, Mutex};

/// Maximum number of pixels by which points are distinguished.
const MAX_PIXELS: f32 = (1 << 23) as f32;

/// Inputs that screen-space surfels depend on.
#[derive(Debug, Clone)]
pub(in crate::scene) struct ScreenInput {
    /// The points; where errors are shown with the normals that are held to be true.
    pub(in crate::scene) content: Content,
    /// Images that its points were created from, if they are all there and in those colours.
    pub(in crate::scene) images: Option<PointImages>,
    pub(in crate::scene) view: ViewTransform,
    pub(in crate::scene) viewport_px: [u32; 2],
    pub(in crate::scene) cloud: ScreenCloud,
    pub(in crate::scene) shows_errors: bool,
    /// True if the renderer creates them, unless errors are shown.
    pub(in crate::scene) is_left_to_card: bool,
}

/// The last surfels of the screen.
#[derive(Debug, Default)]
pub(in crate::scene) struct ScreenSurfels {
    estimator: Arc<Mutex<ScreenEstimator>>,
    last: Option<(ScreenInput, Made)>,
}

/// Resulting surfels.
#[derive(Debug, Clone)]
enum Made {
    Here(VisibleSurfels),
    Left(Arc<VisiblePoints>),
}

impl Made {
    fn content(&self) -> Content {
        match self {
            Self::Here(VisibleSurfels { points, shapes, .. }) => Content::Surfels(Surfels {
                points: Arc::clone(points),
                shapes: Arc::clone(shapes),
            }),
            Self::Left(visible) => Content::Visible(Arc::clone(visible)),
        }
    }
}

impl ScreenSurfels {
    /// Returns the content to draw; content without points stays unchanged.
    pub(in crate::scene) fn content(&mut self, from: ScreenInput) -> Content {
        if let Some((of, made)) = &self.last
            && *of == from
        {
            return made.content();
        }
        let Some(points) = from.content.points() else {
            self.last = None;
            return from.content;
        };
        let view = screen_view(&from.view, from.viewport_px);
        let made = if from.is_left_to_card && !from.shows_errors {
            let estimator = Arc::clone(&self.estimator);
            let visible = VisiblePoints::new(Arc::clone(points), from.images.clone(), view, from.cloud, estimator);
            Made::Left(Arc::new(visible))
        } else {
            let truth = from.content.shapes().filter(|_| from.shows_errors);
            let truth = truth.map(|truth| truth.as_slice());
            let mut estimator = lock(&self.estimator);
            Made::Here(VisibleSurfels::make(&mut estimator, points, &view, &from.cloud, truth))
        };
        let content = made.content();
        self.last = Some((from, made));
        content
    }

    /// Returns the statistics of the CPU's work for the last image, if it had such surfels.
    pub(in crate::scene) fn stats(&self) -> Option<ScreenStats> {
        match self.last.as_ref().map(|(_, made)| made)? {
            Made::Here(surfels) => Some(surfels.stats),
            Made::Left(visible) => visible.stats(),
        }
    }

    /// Another image was made, without them.
    pub(in crate::scene) fn forget(&mut self) {
        self.last = None;
    }
}

/// Images follow from the content.
impl PartialEq for ScreenInput {
    fn eq(&self, other: &Self) -> bool {
        self.content == other.content
            && self.view == other.view
            && self.viewport_px == other.viewport_px
            && self.cloud == other.cloud
            && self.shows_errors == other.shows_errors
            && self.is_left_to_card == other.is_left_to_card
    }
}

/// Returns a view with the pixels by which points are distinguished.
pub fn screen_view(view: &ViewTransform, viewport_px: [u32; 2]) -> ScreenView {
    let [width, height] = viewport_px.map(|edge| edge.max(1) as f32);
    let scale = (MAX_PIXELS / (width * height)).sqrt().min(1.0);
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
        center_px: [half[0] * (1.0 + right), half[1] * (1.0 - up)],
    }
}
