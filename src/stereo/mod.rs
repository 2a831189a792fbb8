//! Depth from photographs, on the processor.
//!
//! *Pairs* ([`depths_of_pair`]): two views are turned until partners are in one line ([`Rectified`]), the range of
//! disparities is found on small copies if nobody knows it ([`Matching::range`]), costs are Hamming distances of the
//! census, summed along eight paths or in squares ([`Gathering`]), the cheapest disparity wins where left and right
//! agree and no other is as good ([`Matching::disparities`]), and one product of a matrix and a vector makes it a place
//! ([`Places`]). *Many views* ([`PlaneSweep`]): planes are swept through the space before one view, costs and winners
//! are the same; what three views agree on is kept ([`consistent`]). Either way depths become coloured points
//! ([`cloud()`]).
//!
//! All photographs of a set together become points by [`Dense`], sooner by [`Pairwise`].
//!
//! Photographs are of pinholes, with centres of pixels at integers; lenses are taken out before. Lengths are in the
//! unit of the poses. Results are the same bits for any number of threads.

mod census;
mod cloud;
mod consistency;
pub(crate) mod constants;
mod contrast;
mod costs;
mod dense;
mod disparity;
mod error;
mod filters;
mod image;
mod local;
mod matcher;
mod pair;
mod pairwise;
mod places;
mod plane_sweep;
mod pyramid;
mod range;
mod rectify;
mod refine;
mod semi_global;
mod surface;
mod view;
mod winner;

pub use cloud::cloud;
pub use consistency::{Consistency, consistent};
pub use dense::{Dense, DenseError};
pub use disparity::DisparityMap;
pub use error::StereoError;
pub use image::GrayImage;
pub use matcher::{Gathering, Matching, OnProcessor, PairMatcher, SharedMatcher};
pub use pair::depths_of_pair;
pub use pairwise::Pairwise;
pub use places::Places;
pub use plane_sweep::PlaneSweep;
pub use range::DisparityRange;
pub use rectify::Rectified;
pub use semi_global::Penalties;
pub use surface::photo_surface;
pub use view::View;
pub use winner::Between;
