//! Dense multi-view stereo from calibrated images: depths of each view from its neighbours, retained where views agree.
//!
//! *How it works.* Images are downscaled far enough; planes are swept before each, between the depths of its sparse
//! points or, without any, within the depth range that its format states, otherwise around the point that all cameras
//! look at; depths that views do not agree on are dropped, and the remaining ones become points. Exactly two images are
//! matched as a pair (`pair.rs`): their viewing directions may be arbitrarily close to parallel, and the depth range
//! need not be known.

use super::cloud::cloud;
use crate::cloud::RawCloud;
use crate::messages::grouped;
use crate::photos::{Extent, Photo, PhotosError, PreparedPhoto, ViewSet};
use crate::progress::Progress;
use crate::rgbd::{ColorImage, DepthImage};
use crate::stereo::Consistency;
use crate::stereo::Matching;
use crate::stereo::PairMatcher;
use crate::stereo::PlaneSweep;
use crate::stereo::SharedMatcher;
use crate::stereo::StereoError;
use crate::stereo::View;
use crate::stereo::consistent;
use crate::stereo::depths_of_pair;
use glam::DVec3;
use rayon::prelude::*;

/// Settings for dense stereo reconstruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Dense {
    /// Maximum side length in pixels: images are halved until no side is longer.
    pub max_side_px: u32,
    /// Number of neighbouring images that each image is compared with.
    pub neighbours: usize,
    /// Consistency criterion for keeping depths.
    pub consistency: Consistency,
    /// Stereo matcher for a set of only two images.
    pub matcher: SharedMatcher,
}

impl Default for Dense {
    fn default() -> Self {
        Self {
            max_side_px: 640,
            neighbours: 4,
            consistency: Consistency::default(),
            matcher: SharedMatcher::default(),
        }
    }
}

/// Error when computing dense points from images.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DenseError {
    /// Too few of them can be read.
    #[error("depth needs two images of the same scene, and {count} could be read: {reason}")]
    TooFew {
        /// Number of images that could be read.
        count: usize,
        /// The reason why others could not.
        reason: String,
    },
    /// They show nothing that two of them agree on.
    #[error("no depth was found in {photos} images: they overlap too little, or their cameras do not fit them")]
    Nothing {
        /// Number of images.
        photos: usize,
    },
    /// Views that do not fit together.
    #[error(transparent)]
    Stereo(#[from] StereoError),
}

/// Maximum number of pixels of all depth maps together: in larger image sets only every second, third … image is swept,
/// each with its nearest neighbours among all. Time and points grow with them, and surfaces in hundreds of images are
/// seen by dozens.
const MAX_PIXELS: u64 = 12 << 20;

/// Best angles between neighbours for depths: smaller ones give none, larger ones show other sides.
pub(super) const ANGLES_DEG: std::ops::RangeInclusive<f64> = 1.5..=40.0;

/// Factor by which the surface may be nearer or farther than its sparse points.
const BEYOND_POINTS: f64 = 1.3;

/// Factor by which the surface may be nearer or farther than the depth range that a format states: LLFF's excludes a
/// thousandth of the points at each end.
const BEYOND_TOLD: f64 = 1.1;

/// Depths that are tried around the place that all cameras look at, in depths of that place.
pub(super) const AROUND_CENTER: [f64; 2] = [0.5, 1.7];

/// Downscaled image that was read.
pub(super) struct Small {
    pub(in crate::stereo) number: usize,
    photo: PreparedPhoto,
    pub(in crate::stereo) image: ColorImage,
}

impl Dense {
    /// The dense points of a set, in its coordinates, with colours. Reports to `progress`, and stops soon after that
    /// was cancelled.
    ///
    /// # Errors
    /// [`DenseError`].
    pub fn cloud(&self, set: &ViewSet, progress: &Progress) -> Result<RawCloud, DenseError> {
        let (small, mut reasons) = read_small(set, self.max_side_px)?;
        let views: Vec<View<'_>> = small.iter().map(Small::view).collect();
        if let Some(mut pair) = of_pair(&small, &views, &*self.matcher.0, &Matching::default())? {
            progress.set(2, 2);
            pair.warnings = reasons;
            return Ok(pair);
        }
        let centers = set.centers();
        let every = every(small.iter().map(|of_one| of_one.image.pixels().len() as u64));
        let swept: Vec<View<'_>> = views.iter().copied().step_by(every).collect();
        if swept.len() < small.len() {
            reasons.push(format!(
                "depths were computed for {} of {} images, evenly chosen: all would take long and show the same",
                grouped(swept.len()),
                grouped(small.len())
            ));
        }
        let mut maps = Vec::with_capacity(swept.len());
        progress.set(0, PlaneSweep::STEPS * swept.len());
        for (of_one, view) in small.iter().step_by(every).zip(&swept) {
            if progress.is_cancelled() {
                return Err(StereoError::Cancelled.into());
            }
            let center = centers[of_one.number];
            let others = self.others(set, of_one, center, &small, &views);
            let nothing = || vec![0.0; of_one.image.pixels().len()];
            let depths = match depth_range(set, of_one.number, Some(center), AROUND_CENTER) {
                Some([near, far]) if !others.is_empty() => {
                    let found = PlaneSweep::between(near, far).depths_observed(view, &others, progress)?;
                    of_one.masked(&found)
                }
                _ => {
                    progress.advance(PlaneSweep::STEPS);
                    nothing()
                }
            };
            maps.extend(DepthImage::new(of_one.image.size_px(), depths));
        }
        let retained = consistent(&maps, &swept, self.consistency)?;
        let mut cloud = cloud(&retained, &swept)?;
        if cloud.positions.is_empty() {
            return Err(DenseError::Nothing { photos: small.len() });
        }
        cloud.warnings = reasons;
        Ok(cloud)
    }

    /// Returns the neighbouring views of one view, nearest first.
    fn others<'a>(
        &self,
        set: &ViewSet,
        one: &Small,
        center: DVec3,
        small: &[Small],
        views: &[View<'a>],
    ) -> Vec<View<'a>> {
        let place = |number: usize| small.iter().position(|other| other.number == number);
        telling(set, center, one.number)
            .filter_map(|other| Some(views[place(other)?]))
            .take(self.neighbours)
            .collect()
    }
}

/// Reads the images of a set, halved until no side is longer, and returns those that can be read and the reasons why
/// others cannot.
///
/// # Errors
/// [`DenseError::TooFew`] of less than two.
pub(super) fn read_small(set: &ViewSet, max_side_px: u32) -> Result<(Vec<Small>, Vec<String>), DenseError> {
    let longest = |photo: &Photo| photo.camera.size_px().into_iter().max().unwrap_or(1);
    let longest = set.photos.iter().map(longest).max().unwrap_or(1);
    let halvings = (0..32)
        .find(|&halvings| longest >> halvings <= max_side_px)
        .unwrap_or(0);
    let read = |(number, photo): (usize, &Photo)| -> Result<Small, PhotosError> {
        let photo = PreparedPhoto::read(photo, Extent::Same, halvings)?;
        let pixels = photo
            .image
            .pixels()
            .iter()
            .map(|&[red, green, blue, _]| [red, green, blue]);
        let image = ColorImage::new(photo.image.size_px(), pixels.collect());
        let image = image.unwrap_or_else(|| unreachable!("the image has that number of pixels"));
        Ok(Small { number, photo, image })
    };
    let there = set.photos.par_iter().enumerate().filter(|(_, photo)| photo.has_file());
    let read: Vec<Result<Small, PhotosError>> = there.map(read).collect();
    let (mut small, mut reasons) = (Vec::new(), Vec::new());
    for read in read {
        match read {
            Ok(read) => small.push(read),
            Err(error) => reasons.push(error.to_string()),
        }
    }
    if small.len() < 2 {
        return Err(DenseError::TooFew {
            count: small.len(),
            reason: reasons.join("; "),
        });
    }
    Ok((small, reasons))
}

impl Small {
    pub(in crate::stereo) fn view(&self) -> View<'_> {
        View {
            image: &self.image,
            camera: &self.photo.camera,
            camera_from_world: self.photo.camera_from_world,
        }
    }

    /// Depths of the object alone.
    pub(super) fn masked(&self, depths: &DepthImage) -> Vec<f32> {
        let pixels = depths.metres().iter().zip(self.photo.image.pixels());
        pixels
            .map(|(&depth, pixel)| if pixel[3] == u8::MAX { depth } else { 0.0 })
            .collect()
    }
}

/// Returns the neighbouring images whose viewing angles at `center` are suited to depth estimation, nearest first.
pub(super) fn telling(set: &ViewSet, center: DVec3, number: usize) -> impl Iterator<Item = usize> {
    let around = set.neighbours_around(center, number, set.photos.len());
    let told = around
        .into_iter()
        .filter(|other| ANGLES_DEG.contains(&other.angle.to_degrees()));
    told.map(|other| other.photo)
}

/// Returns the stride N at which images with these pixel counts are swept: one of every N.
fn every(pixels: impl Iterator<Item = u64>) -> usize {
    let all: u64 = pixels.sum();
    all.div_ceil(MAX_PIXELS).max(1) as usize
}

/// Computes the points of a pair of images, as seen by the first; `None` for other counts, and for two that cannot be
/// rectified or show nothing of one another.
pub(super) fn of_pair(
    small: &[Small],
    views: &[View<'_>],
    matcher: &dyn PairMatcher,
    matching: &Matching,
) -> Result<Option<RawCloud>, StereoError> {
    let ([first, _], &[view, other]) = (small, views) else {
        return Ok(None);
    };
    let Ok(found) = depths_of_pair([view, other], matcher, matching, None) else {
        return Ok(None);
    };
    let Some(map) = DepthImage::new(first.image.size_px(), first.masked(&found)) else {
        return Ok(None);
    };
    let pair = cloud(&[map], &[view])?;
    Ok((!pair.positions.is_empty()).then_some(pair))
}

/// Returns the depth range of the surface in front of an image: if nothing more is known, from one fraction of the
/// depth of `center` to the other.
pub(super) fn depth_range(set: &ViewSet, number: usize, center: Option<DVec3>, parts: [f64; 2]) -> Option<[f64; 2]> {
    told_range(set, number).or_else(|| {
        let depth = set.photos.get(number)?.depth_of(center?);
        (depth > 0.0).then(|| parts.map(|part| part * depth))
    })
}

/// Returns the depth range of the surface estimated from sparse points, or as stated by the format.
fn told_range(set: &ViewSet, number: usize) -> Option<[f64; 2]> {
    let photo = set.photos.get(number)?;
    let points = set.points.positions().iter().enumerate();
    let is_seen = |point: usize, position| {
        let track = set.points.track(point);
        if track.is_empty() {
            photo.pixel(position).is_some()
        } else {
            track.iter().any(|seen| seen.photo as usize == number)
        }
    };
    let mut depths: Vec<f64> = points
        .filter(|&(point, &position)| is_seen(point, position))
        .map(|(_, &position)| photo.depth_of(position))
        .filter(|&depth| depth > 0.0 && depth.is_finite())
        .collect();
    depths.sort_by(f64::total_cmp);
    if depths.len() >= 8 {
        let aside = depths.len() / 50;
        return Some([
            depths[aside] / BEYOND_POINTS,
            depths[depths.len() - 1 - aside] * BEYOND_POINTS,
        ]);
    }
    let [near, far] = photo.depth_range?;
    Some([near / BEYOND_TOLD, far * BEYOND_TOLD])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::SparsePoints;
    use crate::rgbd::{Camera, Distortion};
    use glam::{DAffine3, DVec2};

    #[test]
    fn only_some_of_hundreds_of_images_are_swept() {
        assert_eq!(every(std::iter::repeat_n(640 * 480, 40)), 1);
        assert_eq!(every(std::iter::repeat_n(400 * 400, 100)), 2);
        assert_eq!(every(std::iter::repeat_n(640 * 480, 400)), 10);
        assert_eq!(every(std::iter::empty()), 1);
    }

    #[test]
    fn sweep_planes_span_the_sparse_points_or_the_depth_range_of_the_format() {
        let camera = Camera::new([64, 48], DVec2::splat(50.0), DVec2::new(31.5, 23.5), Distortion::None);
        let photo = Photo {
            name: String::new(),
            path: "a.png".into(),
            camera: camera.unwrap(),
            camera_from_world: DAffine3::IDENTITY,
            mask: None,
            depth: None,
            depth_range: None,
        };
        let mut set = ViewSet {
            photos: vec![photo],
            ..ViewSet::default()
        };
        let range = |set: &ViewSet| depth_range(set, 0, Some(DVec3::new(0.0, 0.0, 10.0)), AROUND_CENTER).unwrap();
        assert_eq!(range(&set), AROUND_CENTER.map(|share| 10.0 * share));
        set.photos[0].depth_range = Some([2.0, 40.0]);
        assert_eq!(range(&set), [2.0 / BEYOND_TOLD, 40.0 * BEYOND_TOLD]);
        let mut points = SparsePoints::default();
        for depth in 4..14 {
            points.push(DVec3::new(0.0, 0.0, f64::from(depth)), [0; 3], []);
        }
        set.points = points;
        assert_eq!(range(&set), [4.0 / BEYOND_POINTS, 13.0 * BEYOND_POINTS]);
    }
}
