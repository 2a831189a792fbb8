//! Pair stereo: from two images to the depths of the first.

use crate::rgbd::DepthImage;
use crate::stereo::DisparityRange;
use crate::stereo::GrayImage;
use crate::stereo::Matching;
use crate::stereo::PairMatcher;
use crate::stereo::Rectified;
use crate::stereo::StereoError;
use crate::stereo::View;
use glam::DVec2;

/// Depths of the pixels of the first view, along the axis of its camera, in the unit of the poses; 0 where none was
/// found. `between` is the nearest and the farthest depth of the surface; if unknown, they are estimated. `matcher`
/// does the most expensive part.
///
/// # Errors
/// [`StereoError`].
pub fn depths_of_pair(
    views: [View<'_>; 2],
    matcher: &dyn PairMatcher,
    matching: &Matching,
    between: Option<[f64; 2]>,
) -> Result<DepthImage, StereoError> {
    for (index, view) in views.iter().enumerate() {
        view.check(index)?;
    }
    let rectified = Rectified::new(views.map(|view| view.camera), views.map(|view| view.camera_from_world))?;
    let left = GrayImage::of_colors(&rectified.image(0, views[0].image)?);
    let right = GrayImage::of_colors(&rectified.image(1, views[1].image)?);
    let range = match between {
        Some(depths) => range_between(&rectified, &views[0], depths).ok_or(StereoError::NotSideBySide(
            "one sees nothing of what is before the other",
        ))?,
        None => matching.range(&left, &right)?,
    };
    let mut map = matcher.disparities(matching, &left, &right, range)?;
    rectified.keep_seen(&mut map);
    Ok(rectified.depths_of_first(&map))
}

/// The disparities of the space between two depths before the first view; `None` if the second sees nothing of it.
fn range_between(rectified: &Rectified, first: &View<'_>, depths: [f64; 2]) -> Option<DisparityRange> {
    let world_from_first = first.camera_from_world.inverse();
    let [width, height] = first.camera.size_px().map(|edge| f64::from(edge - 1));
    let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
    let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
    for [across, down] in places {
        let Some(ray) = first.camera.ray(DVec2::new(across * width, down * height)) else {
            continue;
        };
        for depth in depths {
            let place = world_from_first.transform_point3(ray * depth);
            let columns = [0, 1].map(|index| {
                let seen = rectified.camera_from_world()[index].transform_point3(place);
                let camera = &rectified.cameras()[index];
                (seen.z > 0.0).then(|| camera.focal_px().x * seen.x / seen.z + camera.principal_px().x)
            });
            let [Some(left), Some(right)] = columns else {
                continue;
            };
            min = min.min(left - right);
            max = max.max(left - right);
        }
    }
    (min <= max).then(|| DisparityRange::new(min.floor() as i32 - 1, max.ceil() as i32 + 1).ok())?
}
