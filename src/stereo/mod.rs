//! Depth from photographs.

mod census;
mod cloud;
mod consistency;
mod costs;
mod disparity;
mod error;
mod filters;
mod image;
mod local;
mod matcher;
mod pair;
mod places;
mod plane_sweep;
mod pyramid;
mod range;
mod rectify;
mod refine;
mod semi_global;
mod view;
mod winner;

pub use cloud::cloud;
pub use consistency::{Consistency, consistent};
pub use disparity::DisparityMap;
pub use error::StereoError;
pub use image::GrayImage;
pub use matcher::{Gathering, Matching};
pub use pair::depths_of_pair;
pub use places::Places;
pub use plane_sweep::PlaneSweep;
pub use range::DisparityRange;
pub use rectify::Rectified;
pub use semi_global::Penalties;
pub use view::View;
pub use winner::Between;
