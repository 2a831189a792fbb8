//! Depth images: the cameras that took them, their points, their colours and their filters.
//!
//! A depth image is filtered first, while neighbours are still next to each other ([`Filters`]); then each pixel
//! becomes a point on its ray ([`RayTable`], [`cloud`]), with the colour that the colour camera has at its place
//! ([`ColorCamera::colors`]). Planes through pixels that are next to each other give its normal ([`put_on_planes`]).
//! Nothing here reads files: see `source/rgbd` for recordings.
//!
//! Coordinates are those of a camera: x to the right, y down, z forward, in metres; centres of pixels are at integers.

mod camera;
mod cloud;
mod depth_frame;
mod distortion;
mod filters;
mod images;
mod planes;
mod rays;
mod registration;
mod rig;

pub use camera::{Camera, CameraError};
pub use cloud::cloud;
pub use depth_frame::{DepthFrame, DepthSamples, DepthTable};
pub use distortion::Distortion;
pub(crate) use filters::constants as filter_constants;
#[cfg(test)]
pub(crate) use filters::test_images;
pub use filters::{
    Bilateral, DepthRange, DroppedPixels, FilterKind, FilterParameter, FilterReport, Filters, FlyingPixels,
    NOTICEABLE_SHARE, ParseFiltersError, Temporal, TemporalFilter, median,
};
pub use images::{ColorImage, DepthImage, is_measured};
pub use planes::{on_planes, put_on_planes};
pub use rays::RayTable;
pub use registration::{ColorCamera, UNSEEN_COLOR};
pub use rig::{Rig, Sensor};
