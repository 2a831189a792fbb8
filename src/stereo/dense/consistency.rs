//! Depth consistency check: keeps depths that several views agree on.
//!
//! A depth of one view is a position in the world, and that position has a depth in each other view. Where the depth
//! map of the other has the same depth, two views agree, each by matches of its own. Errors seldom agree by chance, so
//! depths that at least three views agree on are retained (Merrell et al. 2007).

use crate::rgbd::{Camera, DepthImage};
use crate::stereo::StereoError;
use crate::stereo::View;
use crate::stereo::views::view::check_pinhole;
use glam::{DAffine3, DVec2};
use rayon::prelude::*;

/// Criteria for depths to count as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consistency {
    /// Number of views that have to agree, including the view itself. With fewer views, all of them.
    pub min_views: usize,
    /// Two depths agree if they differ by at most this part.
    pub tolerance: f64,
}

impl Default for Consistency {
    fn default() -> Self {
        Self {
            min_views: 3,
            tolerance: 0.01,
        }
    }
}

/// The depths of `maps` that enough views agree on; the others become 0. Each map is of the view of the same number.
///
/// # Errors
/// [`StereoError::CountsDiffer`], [`StereoError::OtherCamera`] for a map that differs in size from its camera,
/// [`StereoError::NoPinhole`], [`StereoError::NoPose`].
pub fn consistent(
    maps: &[DepthImage],
    views: &[View<'_>],
    consistency: Consistency,
) -> Result<Vec<DepthImage>, StereoError> {
    if maps.len() != views.len() {
        return Err(StereoError::CountsDiffer {
            maps: maps.len(),
            views: views.len(),
        });
    }
    for (index, (map, view)) in maps.iter().zip(views).enumerate() {
        check_pinhole(view.camera, view.camera_from_world, index)?;
        if map.size_px() != view.camera.size_px() {
            return Err(StereoError::OtherCamera {
                view: index,
                image: map.size_px(),
                camera: view.camera.size_px(),
            });
        }
    }
    let needed = consistency.min_views.min(maps.len());
    let filtered = |index: usize| {
        let others: Vec<Other<'_>> = (0..maps.len())
            .filter(|&other| other != index)
            .map(|other| Other {
                map: &maps[other],
                camera: views[other].camera,
                from_first: views[other].camera_from_world * views[index].camera_from_world.inverse(),
            })
            .collect();
        let (camera, width) = (views[index].camera, maps[index].width());
        let keep = |(at, &depth): (usize, &f32)| {
            let pixel = DVec2::new((at % width) as f64, (at / width) as f64);
            let ray = camera.ray(pixel).filter(|_| depth > 0.0);
            let is_retained = ray.is_some_and(|ray| {
                let agreeing = others
                    .iter()
                    .filter(|other| other.agrees(ray * f64::from(depth), consistency.tolerance));
                // One is the view itself.
                agreeing.take(needed).count() + 1 >= needed
            });
            if is_retained { depth } else { 0.0 }
        };
        let depths = maps[index].metres().par_iter().enumerate().map(keep).collect();
        DepthImage::new(maps[index].size_px(), depths).unwrap_or_else(|| maps[index].clone())
    };
    Ok((0..maps.len()).map(filtered).collect())
}

struct Other<'a> {
    map: &'a DepthImage,
    camera: &'a Camera,
    /// From the frame of the first camera to this one's.
    from_first: DAffine3,
}

impl Other<'_> {
    /// Returns true if the depth map of this view agrees with `point`, given in the frame of the first view.
    fn agrees(&self, point: glam::DVec3, tolerance: f64) -> bool {
        let point = self.from_first.transform_point3(point);
        let Some(pixel) = self.camera.pixel(point).filter(|&pixel| self.camera.contains(pixel)) else {
            return false;
        };
        let last = DVec2::new(self.map.width() as f64 - 1.0, self.map.height() as f64 - 1.0);
        let pixel = pixel.round().clamp(DVec2::ZERO, last);
        let depth = f64::from(self.map.metres()[pixel.y as usize * self.map.width() + pixel.x as usize]);
        depth > 0.0 && (depth - point.z).abs() <= tolerance * point.z
    }
}
