//! Rectification: two views rotated about their centres until partners are in one line.
//!
//! Fusiello et al. (2000): both get one orientation. Its x axis is the line from the first camera centre to the second;
//! its y axis is at right angles to that and to the viewing direction (the mean of both here, so that neither is
//! rotated more than the other); z follows. A rotation of a pinhole is a homography of its image. So a pair one above
//! the other becomes one side by side, rotated by 90°, and disparities are above 0 for everything in front of both.
//!
//! Each image keeps a principal point of its own along x, so that both are filled by their content. Along y only the
//! common part is retained. Columns differ by a constant then, which the mapping to positions accounts for
//! ([`Places`]).

use super::view::{check_pinhole, pixels_from_rays, through};
use crate::photos::center_of;
use crate::rgbd::{Camera, ColorImage, DepthImage, Distortion};
use crate::stereo::DisparityMap;
use crate::stereo::Places;
use crate::stereo::StereoError;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Maximum ratio of the pixel count of a rectified image to that of the input image.
const MAX_GROWTH: f64 = 4.0;

/// Cosine of the largest turn: 70°.
const MIN_COSINE: f64 = 0.342;

/// Two views turned to one orientation.
#[derive(Debug, Clone)]
pub struct Rectified {
    cameras: [Camera; 2],
    camera_from_world: [DAffine3; 2],
    /// Homographies from pixels of the input images to pixels of the rectified images.
    homographies: [DMat3; 2],
    /// And back.
    inverses: [DMat3; 2],
    sources: [Camera; 2],
    first_from_world: DAffine3,
}

impl Rectified {
    /// Rectifies two pinholes with their poses (rotations and translations, from the world to the camera).
    ///
    /// # Errors
    /// [`StereoError::NoPinhole`], [`StereoError::NoPose`], [`StereoError::NoBaseline`], and
    /// [`StereoError::NotSideBySide`] if one view sees the position of the other, or looks elsewhere.
    pub fn new(cameras: [&Camera; 2], poses: [DAffine3; 2]) -> Result<Self, StereoError> {
        for index in 0..2 {
            check_pinhole(cameras[index], poses[index], index)?;
        }
        let places = poses.map(center_of);
        let rotation = common_rotation(places, poses)?;
        let focal = cameras
            .iter()
            .map(|camera| camera.focal_px().element_sum() / 4.0)
            .sum::<f64>();
        // First in pixels around an axis through (0, 0), to find the extent of both images.
        let focal_only = DMat3::from_diagonal(DVec3::new(focal, focal, 1.0));
        let turned = [0, 1].map(|index| {
            focal_only * rotation * poses[index].matrix3.transpose() * pixels_from_rays(cameras[index]).inverse()
        });
        let [first, second] = [reach(&turned[0], cameras[0])?, reach(&turned[1], cameras[1])?];
        let top = first[0].y.max(second[0].y).ceil();
        let bottom = first[1].y.min(second[1].y).floor();
        let width = (first[1].x - first[0].x).max(second[1].x - second[0].x).ceil();
        let height = bottom - top;
        let max = cameras.map(|camera| f64::from(camera.size_px()[0]) * f64::from(camera.size_px()[1]) * MAX_GROWTH);
        if height < 1.0 {
            return Err(StereoError::NotSideBySide("they share no line"));
        }
        if (width + 1.0) * (height + 1.0) > max[0].max(max[1]) {
            return Err(StereoError::NotSideBySide(
                "one looks almost along the line between them",
            ));
        }
        let size = [width as u32 + 1, height as u32 + 1];
        // Whole pixels, so that disparities differ from angles by integers. Separate principal points: with a common
        // one, converging views would share only half of their images.
        let left = [first, second].map(|[min, max]| f64::midpoint(min.x, max.x - width).round());
        let rectified = |index: usize| {
            let principal = DVec2::new(-left[index], -top);
            Camera::new(size, DVec2::splat(focal), principal, Distortion::None)
                .map_err(|_| StereoError::NotSideBySide("their focal lengths are none"))
        };
        let rectified = [rectified(0)?, rectified(1)?];
        let homographies = [0, 1].map(|index| DMat3::from_translation(DVec2::new(-left[index], -top)) * turned[index]);
        Ok(Self {
            cameras: rectified,
            camera_from_world: places.map(|place| DAffine3 {
                matrix3: rotation,
                translation: -(rotation * place),
            }),
            inverses: homographies.map(|homography| homography.inverse()),
            homographies,
            sources: cameras.map(Clone::clone),
            first_from_world: poses[0],
        })
    }

    /// Returns the pinholes of both rectified images: with the same size, focal length and principal-point row.
    pub fn cameras(&self) -> &[Camera; 2] {
        &self.cameras
    }

    /// Their poses, of one rotation.
    pub fn camera_from_world(&self) -> &[DAffine3; 2] {
        &self.camera_from_world
    }

    /// Returns the homographies from pixels of the input images to pixels of the rectified images.
    pub fn rectified_from_pixels(&self) -> &[DMat3; 2] {
        &self.homographies
    }

    /// From disparities to places.
    pub fn places(&self) -> Places {
        Places::new(&self.cameras, &self.camera_from_world)
    }

    /// Returns input image `index` (0 or 1) as the rectified camera sees it, interpolated bilinearly between the four
    /// surrounding pixels. Beyond the input image are the colours of its border; see [`Self::is_seen`].
    ///
    /// # Errors
    /// [`StereoError::OtherCamera`] if the input image is not of the size of its camera.
    pub fn image(&self, index: usize, posed_image: &ColorImage) -> Result<ColorImage, StereoError> {
        let (image, camera) = (posed_image.size_px(), self.sources[index].size_px());
        if image != camera {
            return Err(StereoError::OtherCamera {
                view: index,
                image,
                camera,
            });
        }
        let size = self.cameras[index].size_px();
        let homography = &self.inverses[index];
        let color = |row: u32, column: u32| {
            let pixel = DVec2::new(f64::from(column), f64::from(row));
            through(homography, pixel).map_or([0; 3], |at| posed_image.bilinear([at.x as f32, at.y as f32]))
        };
        let rows = (0..size[1]).into_par_iter();
        let pixels = rows.flat_map_iter(|row| (0..size[0]).map(move |column| color(row, column)));
        ColorImage::new(size, pixels.collect()).ok_or(StereoError::NotSideBySide("they share no pixel"))
    }

    /// Returns true if input image `index` shows the content at `pixel` of its rectified image.
    pub fn is_seen(&self, index: usize, pixel: DVec2) -> bool {
        through(&self.inverses[index], pixel).is_some_and(|at| self.sources[index].contains(at))
    }

    /// Removes disparities from `map` that only come from the colours beyond an input image. Precondition: it is of the
    /// first rectified image.
    pub fn keep_seen(&self, map: &mut DisparityMap) {
        let width = map.width();
        map.pixels_mut()
            .par_chunks_exact_mut(width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, disparity) in row.iter_mut().enumerate() {
                    let pixel = DVec2::new(x as f64, y as f64);
                    let partner = pixel - DVec2::new(f64::from(*disparity), 0.0);
                    if !(self.is_seen(0, pixel) && self.is_seen(1, partner)) {
                        *disparity = f32::NAN;
                    }
                }
            });
    }

    /// Returns the depths of the pixels of the first input image, along the axis of its camera; 0 where there are none.
    ///
    /// Between pixels of the rectified image the four surrounding ones are interpolated if they are of one surface
    /// (disparities within a pixel), otherwise the nearest is taken. Precondition: `map` is of the first rectified
    /// image.
    pub fn depths_of_first(&self, map: &DisparityMap) -> DepthImage {
        let size = self.sources[0].size_px();
        let places = self.places();
        let depth = |row: u32, column: u32| {
            let pixel = DVec2::new(f64::from(column), f64::from(row));
            let at = through(&self.homographies[0], pixel)?;
            let disparity = map.between(at)?;
            let point = places.point(at, disparity)?;
            Some(self.first_from_world.transform_point3(point).z as f32)
        };
        let rows = (0..size[1]).into_par_iter();
        let metres = rows.flat_map_iter(|row| (0..size[0]).map(move |column| depth(row, column).unwrap_or(0.0)));
        DepthImage::new(size, metres.collect()).expect("a camera has pixels")
    }
}

/// From the world to the orientation that both get.
fn common_rotation(places: [DVec3; 2], poses: [DAffine3; 2]) -> Result<DMat3, StereoError> {
    let baseline = places[1] - places[0];
    let scale = places[0].length().max(places[1].length());
    if !(baseline.is_finite() && baseline.length() > 1e-12 * scale && baseline.length() > 0.0) {
        return Err(StereoError::NoBaseline);
    }
    let x = baseline.normalize();
    let axes = poses.map(|pose| pose.matrix3.transpose() * DVec3::Z);
    let forward = axes[0] + axes[1];
    let y = forward.cross(x);
    if y.length() <= 1e-6 {
        return Err(StereoError::NotSideBySide("they look along the line between them"));
    }
    // y = z × x.
    let y = y.normalize();
    let z = x.cross(y);
    if axes.iter().any(|axis| axis.dot(z) < MIN_COSINE) {
        return Err(StereoError::NotSideBySide(
            "they look along the line between them, or away from each other",
        ));
    }
    Ok(DMat3::from_cols(x, y, z).transpose())
}

/// Smallest and largest pixel that the image reaches.
fn reach(homography: &DMat3, camera: &Camera) -> Result<[DVec2; 2], StereoError> {
    let [width, height] = camera.size_px().map(|side| f64::from(side) - 1.0);
    let mut min = DVec2::INFINITY;
    let mut max = DVec2::NEG_INFINITY;
    for corner in [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]] {
        let Some(at) = through(homography, corner.into()).filter(|at| at.is_finite()) else {
            return Err(StereoError::NotSideBySide("one sees the line between them"));
        };
        min = min.min(at);
        max = max.max(at);
    }
    Ok([min, max])
}

#[cfg(test)]
mod tests;
