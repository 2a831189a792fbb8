//! From two photographs to the depths of the first.

use super::{DisparityRange, GrayImage, Matching, PairMatcher, Rectified, StereoError, View};
use crate::rgbd::DepthImage;

/// Depths of the pixels of the first view, along the axis of its camera, in the unit of the poses; 0 where none was
/// found. The range of disparities is found if `range` is none; it is one of the rectified images. `matcher` does what
/// takes longest.
///
/// # Errors
/// [`StereoError`].
pub fn depths_of_pair(
    views: [View<'_>; 2],
    (matcher, matching): (&dyn PairMatcher, &Matching),
    range: Option<DisparityRange>,
) -> Result<DepthImage, StereoError> {
    for (index, view) in views.iter().enumerate() {
        view.check(index)?;
    }
    let rectified = Rectified::new(views.map(|view| view.camera), views.map(|view| view.camera_from_world))?;
    let left = GrayImage::of_colors(&rectified.image(0, views[0].image)?);
    let right = GrayImage::of_colors(&rectified.image(1, views[1].image)?);
    let range = match range {
        Some(range) => range,
        None => matching.range(&left, &right)?,
    };
    let mut map = matcher.disparities(matching, &left, &right, range)?;
    rectified.keep_seen(&mut map);
    Ok(rectified.depths_of_first(&map))
}
