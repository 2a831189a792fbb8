//! Geometric distance between two clouds: point to point (D1) and point to plane (D2).
//!
//! How it works (Tian, Ochimizu, Feng, Cohen, Vetro: *Geometric distortion metrics for point cloud compression*, ICIP
//! 2017; the tool `pc_error` of ISO/IEC MPEG): each point of one cloud is matched with the nearest one of the other. D1
//! is the length of the difference vector, D2 its component along the normal there: a point that only slid along the
//! surface has a D1 and hardly a D2. Means of squares and maxima (Hausdorff distances) are reported for both
//! directions, since a cloud with a hole is near to the whole one and not the other way round; the symmetric figure is
//! the larger one.
//!
//! As in `pc_error`, only the reference needs normals. A test point takes the mean normal of the reference points whose
//! nearest it is (not renormalised), or else the normal of its own nearest one; and if there is no normal, D2 is D1. Of
//! equally near points the first counts, so clouds on a grid may differ a little from `pc_error`, which decides at
//! random. Coincident points all count. Maxima are distances here, squares there.
//!
//! Distances are computed and summed in f64, in pieces of fixed size: any number of threads gives the same bits.

mod reference;

pub use reference::{CloudError, ReferenceCloud};

use crate::analysis::NearestPoint;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Points whose errors one task adds up. Fixed, as sums depend on where they are cut.
const POINTS_PER_TASK: usize = 1 << 12;

/// Reasons why two clouds have no distance.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CloudMismatch {
    /// One is empty.
    #[error("{0} has no points")]
    Empty(Side),
    /// A coordinate is infinite or no number.
    #[error("point {index} of {side} is not finite")]
    NotFinite {
        /// The cloud of the point.
        side: Side,
        /// Its index.
        index: usize,
    },
    /// Normals are given, but not one for each point of the reference.
    #[error("{normals} normals do not belong to {points} points")]
    NormalCount {
        /// Points of the reference.
        points: usize,
        /// Normals given for them.
        normals: usize,
    },
}

/// One of two clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The truth.
    Reference,
    /// Test cloud that is compared with it.
    Test,
}

impl std::fmt::Display for Side {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Reference => "the reference",
            Self::Test => "the test",
        })
    }
}

/// Distances from every point of one cloud to another one; never NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneWay {
    /// Mean of the squares, scene units squared.
    pub mean_squared: f64,
    /// The largest (one-sided Hausdorff distance), scene units.
    pub largest: f64,
}

/// Distances in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distances {
    /// From each point of the reference to the test: large where something is missing.
    pub from_reference: OneWay,
    /// From each point of the test to the reference: large where something is too much.
    pub from_test: OneWay,
}

impl Distances {
    /// The symmetric mean squared error: the larger of both, scene units squared.
    pub fn mean_squared(&self) -> f64 {
        let Self {
            from_reference,
            from_test,
        } = self;
        from_reference.mean_squared.max(from_test.mean_squared)
    }

    /// The Hausdorff distance: the larger of both, scene units.
    pub fn hausdorff(&self) -> f64 {
        self.from_reference.largest.max(self.from_test.largest)
    }

    /// 10 log10(3 p² / [`Distances::mean_squared`]) decibels, as in `pc_error`; infinite without an error.
    ///
    /// `peak` p is in scene units: 2ᵇ − 1 for clouds on a grid of b bits, and by custom the longest edge of the
    /// reference's box for others; 3 p² is then the squared diagonal of the cube around it. `None` unless it is
    /// positive and finite.
    pub fn psnr_db(&self, peak: f64) -> Option<f64> {
        // Separate logarithms, so that no square overflows.
        let ratio = || 10.0 * (3f64.log10() - self.mean_squared().log10()) + 20.0 * peak.log10();
        (peak > 0.0 && peak.is_finite()).then(ratio)
    }
}

/// Geometric distance between two clouds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeometryError {
    /// D1: lengths of the difference vectors.
    pub point_to_point: Distances,
    /// D2: lengths along the normals, but for rounding never above D1; `None` where no normals were given.
    pub point_to_plane: Option<Distances>,
}

impl GeometryError {
    /// Compares `test` with `reference`, in the same coordinates.
    ///
    /// `normals` are those of the reference's points, of any length and pointing to the same side where they are near
    /// to each other; one that is zero or not finite counts as none.
    pub fn of(reference: &[Vec3], normals: Option<&[Vec3]>, test: &[Vec3]) -> Result<Self, CloudMismatch> {
        check(Side::Reference, reference)?;
        check(Side::Test, test)?;
        let [of_reference, of_test] = [reference, test].map(NearestPoint::new);
        let directions = Directions {
            reference,
            test,
            from_reference: nearest_of_each(reference, &of_test),
            from_test: nearest_of_each(test, &of_reference),
        };
        directions.error(normals)
    }
}

fn check(side: Side, positions: &[Vec3]) -> Result<(), CloudMismatch> {
    if positions.is_empty() {
        return Err(CloudMismatch::Empty(side));
    }
    match positions.iter().position(|position| !position.is_finite()) {
        Some(index) => Err(CloudMismatch::NotFinite { side, index }),
        None => Ok(()),
    }
}

/// For each of `places` the index of the nearest of `cloud`, which is not empty.
fn nearest_of_each(places: &[Vec3], cloud: &NearestPoint) -> Vec<u32> {
    let nearest = places.par_iter().with_min_len(1 << 8);
    nearest.filter_map(|&place| cloud.of(place)).collect()
}

/// Two clouds, and for each point of one the index of the nearest of the other.
struct Directions<'a> {
    reference: &'a [Vec3],
    test: &'a [Vec3],
    from_reference: Vec<u32>,
    from_test: Vec<u32>,
}

/// Start and end of a difference vector.
#[derive(Clone, Copy)]
enum TargetPoint {
    Test(u32),
    Reference(u32),
}

impl Directions<'_> {
    fn error(&self, normals: Option<&[Vec3]>) -> Result<GeometryError, CloudMismatch> {
        let point_to_plane = normals.map(|normals| match normals.len() {
            count if count == self.reference.len() => Ok(self.point_to_plane(normals)),
            count => Err(CloudMismatch::NormalCount {
                points: self.reference.len(),
                normals: count,
            }),
        });
        Ok(GeometryError {
            point_to_point: self.distances(|_, way| way.length_squared()),
            point_to_plane: point_to_plane.transpose()?,
        })
    }

    /// `squared_error` of all difference vectors.
    fn distances(&self, squared_error: impl Fn(TargetPoint, DVec3) -> f64 + Sync) -> Distances {
        let [reference, test] = [self.reference, self.test];
        Distances {
            from_reference: one_way(reference, test, &self.from_reference, |target, way| {
                squared_error(TargetPoint::Test(target), way)
            }),
            from_test: one_way(test, reference, &self.from_test, |target, way| {
                squared_error(TargetPoint::Reference(target), way)
            }),
        }
    }

    fn point_to_plane(&self, normals: &[Vec3]) -> Distances {
        let of_reference: Vec<Option<DVec3>> = normals.iter().map(|normal| normal.as_dvec3().try_normalize()).collect();
        let of_test = self.normals_of_test(&of_reference);
        self.distances(|target, way| {
            let normal = match target {
                TargetPoint::Test(index) => of_test[index as usize],
                TargetPoint::Reference(index) => of_reference[index as usize],
            };
            normal.map_or(way.length_squared(), |normal| way.dot(normal).powi(2))
        })
    }

    /// Returns the normals that `pc_error` assigns to the points of the test.
    fn normals_of_test(&self, of_reference: &[Option<DVec3>]) -> Vec<Option<DVec3>> {
        let mut sums = vec![(DVec3::ZERO, 0u32); self.test.len()];
        for (&nearest, normal) in self.from_reference.iter().zip(of_reference) {
            if let Some(normal) = normal {
                let (sum, count) = &mut sums[nearest as usize];
                *sum += *normal;
                *count += 1;
            }
        }
        sums.into_iter()
            .zip(&self.from_test)
            .map(|((sum, count), &nearest)| match count {
                0 => of_reference[nearest as usize],
                count => Some(sum / f64::from(count)),
            })
            .collect()
    }
}

/// The errors from each of `places` to its nearest point of `cloud`.
fn one_way(
    places: &[Vec3],
    cloud: &[Vec3],
    nearest: &[u32],
    squared_error: impl Fn(u32, DVec3) -> f64 + Sync,
) -> OneWay {
    let parts: Vec<[f64; 2]> = places
        .par_chunks(POINTS_PER_TASK)
        .zip(nearest.par_chunks(POINTS_PER_TASK))
        .map(|(places, nearest)| {
            let (mut sum, mut largest) = (0.0, 0f64);
            for (place, &target) in places.iter().zip(nearest) {
                let way = place.as_dvec3() - cloud[target as usize].as_dvec3();
                let squared = squared_error(target, way);
                sum += squared;
                largest = largest.max(squared);
            }
            [sum, largest]
        })
        .collect();
    let sum: f64 = parts.iter().map(|part| part[0]).sum();
    OneWay {
        mean_squared: sum / places.len() as f64,
        largest: parts.iter().map(|part| part[1]).fold(0.0, f64::max).sqrt(),
    }
}

#[cfg(test)]
mod tests;
