//! Stereo: depth from images, on the CPU.
//!
//! *Pairs* ([`depths_of_pair`]): two views are rotated until partners are in one line ([`Rectified`]), the range of
//! disparities is estimated on downscaled copies if it is not known ([`Matching::range`]), costs are Hamming distances
//! of the census, summed along eight paths or in squares ([`Gathering`]), the cheapest disparity wins where left and
//! right agree and no other is as good ([`Matching::disparities`]), and one matrix-vector product turns it into a
//! position ([`Places`]). *Many views* ([`PlaneSweep`]): planes are swept through the space before one view, costs and
//! winners are the same; depths that three views agree on are retained ([`consistent`]). In both cases depths become
//! coloured points ([`cloud()`]).
//!
//! All images of a set together become points by [`Dense`], faster by [`Pairwise`].
//!
//! Images are from pinhole cameras, with pixel centres at integers; lens distortion is removed before. Lengths are in
//! the unit of the poses. Results are bitwise identical for any number of threads.

mod dense;
mod error;
mod image;
pub(crate) mod matching;
mod views;

pub use dense::all_views::{Dense, DenseError};
pub use dense::cloud::cloud;
pub use dense::consistency::{Consistency, consistent};
pub use dense::pairwise::Pairwise;
pub use dense::plane_sweep::PlaneSweep;
pub use dense::surface::photo_surface;
pub use error::StereoError;
pub use image::GrayImage;
pub use matching::disparity::DisparityMap;
pub use matching::matcher::{Gathering, Matching, OnProcessor, PairMatcher, SharedMatcher};
pub use matching::range::DisparityRange;
pub use matching::semi_global::Penalties;
pub use matching::winner::Between;
pub use views::pair::depths_of_pair;
pub use views::places::Places;
pub use views::rectify::Rectified;
pub use views::view::View;
