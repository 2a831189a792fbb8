//! Calibrated images of one scene with its sparse points, and measurements on them.
//!
//! *Angles between views.* Views are weighted by the angle between two directions from a point of the surface (Yang et
//! al. 2006, section 3.2). Here the point is the centre of the scene in an image: the median of the points in its
//! tracks; if a format has no tracks, the point closest to the optical axes of all cameras.

use super::photo::Photo;
use super::points::SparsePoints;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::path::PathBuf;

/// Calibrated images of a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ViewSet {
    /// Images in natural order of their names (digits compare as numbers); for a multi-view video, in camera order.
    pub photos: Vec<Photo>,
    /// Sparse points; their tracks refer to images by index.
    pub points: SparsePoints,
    /// Point cloud file that the format names instead of embedding the points, or that lies next to the images.
    pub points_file: Option<PathBuf>,
    /// Dense point cloud that a dense reconstruction stage created from the images: it is shown instead of the sparse
    /// points.
    pub dense_file: Option<PathBuf>,
    /// Notes on skipped and assumed data, one sentence each.
    pub notes: Vec<String>,
}

/// Reprojection error: distances between the observed pixels of points in an image and their projections by its camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReprojectionError {
    /// Observations that were measured.
    pub count: usize,
    /// Observations of points that the camera cannot show, as they are behind it. They are not in the distances.
    pub behind: usize,
    /// Root of the mean square, in pixels.
    pub rms_px: f64,
    /// Half of the distances are shorter, in pixels.
    pub median_px: f64,
}

/// View adjacent to another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Index of the image.
    pub photo: usize,
    /// Angle between the two cameras as seen from the centre of the scene in the first one, in radians.
    pub angle: f64,
}

/// Maximum number of track points used to compute the centre of a view: using more moves it by less than a pixel.
const MAX_POINTS_OF_A_CENTER: usize = 4096;

/// Tolerance for parallel optical axes, at which a single one of 2^53 steps would matter: axes this parallel have no
/// intersection.
const PARALLEL: f64 = 1e-6;

impl ViewSet {
    /// Returns true if a file of points states where the surface is. Otherwise it is known by stereo alone.
    pub fn has_points(&self) -> bool {
        !self.points.is_empty() || self.points_file.is_some() || self.dense_file.is_some()
    }

    /// Returns the reprojection error of image `photo`: the distances between its observations and the projections of
    /// their points by its camera; `None` if no point was observed in it.
    pub fn reprojection_error(&self, photo: usize) -> Option<ReprojectionError> {
        self.reprojection_errors().get(photo).copied().flatten()
    }

    /// Returns [`Self::reprojection_error`] of every image, in a single pass over the points.
    pub fn reprojection_errors(&self) -> Vec<Option<ReprojectionError>> {
        let mut squares: Vec<Vec<f64>> = vec![Vec::new(); self.photos.len()];
        let mut behind = vec![0; self.photos.len()];
        for (point, &position) in self.points.positions().iter().enumerate() {
            for seen in self.points.track(point) {
                let index = seen.photo as usize;
                let Some(photo) = self.photos.get(index) else { continue };
                match photo.project(position) {
                    Some(pixel) => squares[index].push(pixel.distance_squared(seen.pixel.as_dvec2())),
                    None => behind[index] += 1,
                }
            }
        }
        let both = squares.into_iter().zip(behind);
        both.map(|(squares, behind)| ReprojectionError::of(squares, behind))
            .collect()
    }

    /// Returns the `count` views adjacent to image `photo`, nearest first. Iterates over all points, so frequent
    /// callers should keep the result.
    pub fn neighbours(&self, photo: usize, count: usize) -> Vec<Neighbour> {
        let center = self.centers().get(photo).copied();
        center.map_or_else(Vec::new, |center| self.neighbours_around(center, photo, count))
    }

    /// Variant of [`Self::neighbours`] for a known centre of the scene in `photo` ([`Self::centers`]).
    pub fn neighbours_around(&self, center: DVec3, photo: usize, count: usize) -> Vec<Neighbour> {
        let mut found = self.seen_from(center, photo);
        let nearer = |a: &Neighbour, b: &Neighbour| a.angle.total_cmp(&b.angle).then(a.photo.cmp(&b.photo));
        if count < found.len() {
            found.select_nth_unstable_by(count, nearer);
            found.truncate(count);
        }
        found.sort_unstable_by(nearer);
        found
    }

    /// The median of the angles between each view and the one nearest to it, in radians; `None` with less than two
    /// views, and where all are from the same place.
    pub fn median_neighbour_angle(&self) -> Option<f64> {
        let nearest = |(photo, &center): (usize, &DVec3)| {
            let others = self.seen_from(center, photo);
            others.into_iter().map(|other| other.angle).min_by(f64::total_cmp)
        };
        let mut angles: Vec<f64> = self
            .centers()
            .par_iter()
            .enumerate()
            .filter_map(nearest)
            .filter(|&angle| angle > 0.0)
            .collect();
        median(&mut angles)
    }

    /// Returns the point in the world that each image looks at.
    pub fn centers(&self) -> Vec<DVec3> {
        let mut seen: Vec<Vec<DVec3>> = vec![Vec::new(); self.photos.len()];
        for (point, &position) in self.points.positions().iter().enumerate() {
            for observation in self.points.track(point) {
                let Some(of_photo) = seen.get_mut(observation.photo as usize) else {
                    continue;
                };
                if of_photo.len() < MAX_POINTS_OF_A_CENTER {
                    of_photo.push(position);
                }
            }
        }
        let crossing = self.crossing_of_axes();
        let photos = self.photos.iter().zip(seen);
        photos
            .map(|(photo, points)| {
                median_place(&points)
                    .or(crossing)
                    .unwrap_or_else(|| photo.center() + photo.forward())
            })
            .collect()
    }

    /// All views but `photo`, by their angles at `center`.
    fn seen_from(&self, center: DVec3, photo: usize) -> Vec<Neighbour> {
        let direction = |photo: &Photo| photo.center() - center;
        let own = self.photos.get(photo).map_or(DVec3::ZERO, direction);
        let others = self.photos.iter().enumerate().filter(|&(other, _)| other != photo);
        others
            .map(|(photo, other)| Neighbour {
                photo,
                angle: angle_between(own, direction(other)),
            })
            .collect()
    }

    /// The place that the axes of all cameras come nearest to: least squares of the distances to them. `None` where
    /// they are parallel, and where they lead apart.
    pub fn crossing_of_axes(&self) -> Option<DVec3> {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for photo in &self.photos {
            let axis = photo.forward();
            let across = DMat3::IDENTITY - DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
            matrix += across;
            right += across * photo.center();
        }
        let count = self.photos.len() as f64;
        let is_well_posed = matrix.determinant() > PARALLEL * count.powi(3);
        let crossing = matrix.inverse() * right;
        // Diverging axes cross behind their cameras, where nothing is seen.
        let ahead = self.photos.iter().filter(|photo| photo.depth_of(crossing) > 0.0);
        (is_well_posed && crossing.is_finite() && 2 * ahead.count() > self.photos.len()).then_some(crossing)
    }
}

impl ReprojectionError {
    fn of(mut squares: Vec<f64>, behind: usize) -> Option<Self> {
        let count = squares.len();
        if count + behind == 0 {
            return None;
        }
        let rms_px = (squares.iter().sum::<f64>() / count.max(1) as f64).sqrt();
        Some(Self {
            count,
            behind,
            rms_px,
            median_px: median(&mut squares).map_or(0.0, f64::sqrt),
        })
    }
}

/// The upper median; `None` of nothing.
fn median(values: &mut [f64]) -> Option<f64> {
    let center = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(center, f64::total_cmp).1)
}

/// Median of each coordinate.
fn median_place(points: &[DVec3]) -> Option<DVec3> {
    let of = |axis: usize| median(&mut points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    Some(DVec3::new(of(0)?, of(1)?, of(2)?))
}

/// In radians; exact for small angles too, and 0 if one has no direction.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}
