//! Depth from photographs.

mod census;
mod costs;
mod disparity;
mod error;
mod filters;
mod image;
mod local;
mod matcher;
mod pyramid;
mod range;
mod refine;
mod semi_global;
mod winner;

pub use disparity::DisparityMap;
pub use error::StereoError;
pub use image::GrayImage;
pub use matcher::{Gathering, Matching};
pub use range::DisparityRange;
pub use semi_global::Penalties;
pub use winner::Between;
