//! Screen-space surface estimation: the points visible in an image, and the surface around each of these: normals and
//! radii from the image alone.
//!
//! **How it works** (Hofer et al. 2018 §3.4 and §3.5, after the `AutoSplats` of Preiner et al. 2012).
//! [`ScreenEstimator::cull`] draws all points into a depth image of the view and keeps those that lie no deeper than
//! one radius below it (`cull.rs`). [`ScreenEstimator::surface`] searches the neighbours of each of these in the image
//! around it, in a pyramid of cells (`cells.rs`), and fits a plane to them (`planes.rs`). Where the neighbourhood of a
//! fixed radius contains too few, it is searched again with twice the radius.
//!
//! **When it wins.** No nearest-neighbour search is run and no tree is built as for
//! [`estimate_surface`](super::estimate_surface), and hidden points need no plane. So it is the method for frames that
//! are seen once, such as those of a live camera. It loses where the view changes and the cloud does not, as it is
//! repeated for each view, and where pixels are larger than the point spacing.
//!
//! **What the paper leaves open.** The radius is three times the spacing of the points, and no less than two pixels, as
//! there would be no neighbours from afar. Its window is never more than eight by eight cells, of a sufficiently coarse
//! level of the pyramid: the window can have any number of pixels, so a close-up has normals too.
//!
//! Results do not depend on the number of threads.

mod bisect;
mod cells;
mod compact;
pub(crate) mod constants;
mod cull;
mod lanes;
mod planes;
mod ramp;
#[cfg(test)]
mod tests;
mod view;

pub use constants::RADIUS_SPACINGS;
pub(crate) use cull::with_margin_of_splats;
pub use view::{ScreenView, Visible};

use crate::cloud::{PointRecord, ShapeRecord};
use cells::Cells;
use constants::MAX_LEVELS;
use cull::DepthPicture;
use glam::Vec3;
use planes::Planes;
use view::ScreenPoint;

/// Neighbour search method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Search {
    /// Within a fixed radius, or twice that where there are few.
    #[default]
    Fixed,
    /// Within the radius that holds sixteen, which is bisected for each point: `AutoSplats`. For comparison.
    Bisected,
}

/// Properties of a cloud other than its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenCloud {
    /// Typical spacing of its points, scene units.
    pub spacing: f32,
    /// Factor on radii: 1 closes a surface whose points are on a grid; where they are at random, it takes 2 and more.
    pub closing: f32,
    /// Sensor position in the space of the points: normals are oriented towards it, else towards the eye.
    pub sensor: Option<Vec3>,
}

/// Finds visible points and their surface. Keeps its buffers between images, and nothing else.
#[derive(Debug, Default)]
pub struct ScreenEstimator {
    picture: DepthPicture,
    cells: Cells,
}

impl ScreenEstimator {
    /// Culls the points of a cloud to those that an image shows, plus some outside it whose splats may reach into it:
    /// of a point that is excluded, another one covers the pixel of its centre and is nearer by more than the radius;
    /// or it is smaller than a pixel and another one in that pixel is nearer. Points are as wide as they are apart,
    /// eight pixels at most.
    pub fn cull(&mut self, view: &ScreenView, points: &[PointRecord], cloud: &ScreenCloud) -> Visible {
        self.picture.draw(view, points, cloud.spacing);
        self.picture.visible(points)
    }

    /// Normals and radii of visible points, in their order. Precondition: `visible` is of the last
    /// [`ScreenEstimator::cull`].
    ///
    /// A radius is that of a circle with one point's share of the neighbourhood's area, times [`ScreenCloud::closing`]:
    /// that closes the surface. Points without a plane around them have the normal of the nearest one that has, or face
    /// the eye if none is near.
    pub fn surface(&mut self, visible: &Visible, cloud: &ScreenCloud, search: Search) -> Vec<ShapeRecord> {
        let Some(view) = self.picture.view().filter(|_| !visible.is_empty()) else {
            return Vec::new();
        };
        let radius = RADIUS_SPACINGS * cloud.spacing.max(0.0);
        let depths = ScreenPoint::depth_range(&visible.seen);
        let levels = match search {
            Search::Fixed => cells::levels_for(view, radius, depths),
            Search::Bisected => 0..=MAX_LEVELS,
        };
        self.cells.build(self.picture.size_px(), levels, &visible.seen);
        let planes = Planes {
            view,
            cells: &self.cells,
            radius,
            spacing: cloud.spacing,
            closing: cloud.closing,
            sensor: cloud.sensor.map(|sensor| view.offset(sensor.to_array())),
        };
        match search {
            Search::Fixed => planes.fixed(&visible.seen),
            Search::Bisected => planes.bisected(&visible.seen),
        }
    }
}
