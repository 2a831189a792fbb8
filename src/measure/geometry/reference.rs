//! A reference cloud for comparisons: positions of its points, their colours and their normals.
//!
//! How it works: positions are compared as in [`GeometryError`]. A colour is compared with the colour of the nearest
//! point of the other cloud, from both clouds, and the larger mean of squares counts, as `pc_error` does it; but over
//! red, green and blue as they are stored. A test normal is compared with the normal of the nearest reference point.
//!
//! Points at the same place cannot be distinguished by position. Each counts with the mean of all points there, in both
//! clouds; so a cloud in another order has no error.
//!
//! The reference is sorted once, however many clouds are compared with it.

use super::{CloudMismatch, Directions, GeometryError, Side, check, nearest_of_each};
use crate::analysis::{NearestPoint, estimate_surface};
use crate::cloud::{CloudError as InvalidCloud, Frame, Positions, RawCloud};
use crate::math::Aabb;
use crate::measure::{AngularError, Orientation, psnr_db};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A reference cloud for comparisons.
#[derive(Debug)]
pub struct ReferenceCloud {
    cloud: Comparable,
    /// From here places are near enough to be f32.
    corner: DVec3,
    /// Estimated if the cloud has none and they were requested.
    normals_of_planes: Option<Vec<Vec3>>,
    nearest: NearestPoint,
}

/// Error of a cloud relative to its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudError {
    /// D1, and D2 where the reference has normals.
    pub geometry: GeometryError,
    /// Longest edge of the reference's box, in its unit: the peak value for the PSNR of positions.
    pub peak: f64,
    /// Mean squared difference of a channel, 0 to 255²; `None` unless both have colours.
    pub color_squared: Option<f64>,
    /// Angular error of normals, the side included; `None` unless both have normals.
    pub normals: Option<AngularError>,
}

impl CloudError {
    /// PSNR of distances from point to point; infinite without an error.
    pub fn d1_psnr_db(&self) -> Option<f64> {
        self.geometry.point_to_point.psnr_db(self.peak)
    }

    /// PSNR of distances along normals; infinite without an error.
    pub fn d2_psnr_db(&self) -> Option<f64> {
        self.geometry.point_to_plane?.psnr_db(self.peak)
    }

    /// PSNR of colours; infinite without an error.
    pub fn color_psnr_db(&self) -> Option<f64> {
        self.color_squared.map(psnr_db)
    }
}

impl ReferenceCloud {
    /// Holes of `cloud` do not count.
    ///
    /// # Errors
    /// A cloud without points.
    pub fn new(cloud: &RawCloud) -> Result<Self, CloudMismatch> {
        let (_, bounds) = cloud.positions.finite_bounds();
        let (corner, _) = bounds.ok_or(CloudMismatch::Empty(Side::Reference))?;
        let cloud = Comparable::of(cloud, corner);
        check(Side::Reference, &cloud.positions)?;
        Ok(Self {
            nearest: NearestPoint::new(&cloud.positions),
            normals_of_planes: None,
            corner,
            cloud,
        })
    }

    /// Estimates normals for D2 where the cloud has none.
    ///
    /// # Errors
    /// More points than a frame can hold.
    pub fn with_planes(mut self) -> Result<Self, InvalidCloud> {
        if self.cloud.normals.is_none() {
            let positions = self.cloud.positions.iter().map(Vec3::to_array).collect();
            let raw = RawCloud::from_positions(Positions::F32(positions));
            let frame = Frame::from_raw(raw, DVec3::ZERO)?;
            let estimated = estimate_surface(frame.positions(), None).normals;
            let mut normals = vec![Vec3::ZERO; self.cloud.positions.len()];
            for (&index, normal) in frame.file_index().iter().zip(estimated) {
                normals[index as usize] = normal;
            }
            self.normals_of_planes = Some(normals);
        }
        Ok(self)
    }

    /// Compares `test`, in the same coordinates.
    ///
    /// # Errors
    /// A test without points.
    pub fn compare(&self, test: &RawCloud) -> Result<CloudError, CloudMismatch> {
        let reference = &self.cloud;
        let test = Comparable::of(test, self.corner);
        check(Side::Test, &test.positions)?;
        let directions = Directions {
            reference: &reference.positions,
            test: &test.positions,
            from_reference: nearest_of_each(&reference.positions, &NearestPoint::new(&test.positions)),
            from_test: nearest_of_each(&test.positions, &self.nearest),
        };
        let normals = reference.normals.as_ref().or(self.normals_of_planes.as_ref());
        let colors = reference.colors.as_ref().zip(test.colors.as_ref());
        let own_normals = reference.normals.as_ref().zip(test.normals.as_ref());
        Ok(CloudError {
            geometry: directions.error(normals.map(Vec::as_slice))?,
            peak: f64::from(Aabb::from_points(&reference.positions).extent().max_element()),
            color_squared: colors.map(|(of_reference, of_test)| {
                let from_reference = mean_squared(of_reference, of_test, &directions.from_reference);
                from_reference.max(mean_squared(of_test, of_reference, &directions.from_test))
            }),
            normals: own_normals
                .and_then(|(of_reference, of_test)| angular_error(of_test, of_reference, &directions.from_test)),
        })
    }
}

/// Mean squared difference of a channel between each of `colors` and the one that it is `nearest` to.
fn mean_squared(colors: &[Vec3], others: &[Vec3], nearest: &[u32]) -> f64 {
    let pairs = colors.iter().zip(nearest);
    let sum: f64 = pairs
        .map(|(color, &other)| (*color - others[other as usize]).as_dvec3().length_squared())
        .sum();
    sum / (3 * colors.len()).max(1) as f64
}

fn angular_error(found: &[Vec3], truths: &[Vec3], nearest: &[u32]) -> Option<AngularError> {
    let is_direction = |normal: Vec3| normal.is_finite() && normal != Vec3::ZERO;
    let pairs = found
        .iter()
        .zip(nearest)
        .map(|(&found, &truth)| (found, truths[truth as usize]));
    let (found, truth): (Vec<Vec3>, Vec<Vec3>) = pairs
        .filter(|&(found, truth)| is_direction(found) && is_direction(truth))
        .unzip();
    AngularError::of(&found, &truth, Orientation::Matters)
}

/// The finite points of a cloud, near to a corner.
#[derive(Debug)]
struct Comparable {
    positions: Vec<Vec3>,
    /// Red, green and blue, 0 to 255.
    colors: Option<Vec<Vec3>>,
    normals: Option<Vec<Vec3>>,
}

impl Comparable {
    fn of(cloud: &RawCloud, corner: DVec3) -> Self {
        let finite: Vec<usize> = (0..cloud.positions.len())
            .filter(|&index| cloud.positions.get(index).is_finite())
            .collect();
        let position = |&index: &usize| (cloud.positions.get(index) - corner).as_vec3();
        let [red, green, blue] = [0, 1, 2];
        // Red, green and blue as stored; `pc_error` converts to luma and chroma first.
        let color = |color: &[u8; 4]| Vec3::from([red, green, blue].map(|channel: usize| f32::from(color[channel])));
        let colors = cloud.attributes.colors.as_ref();
        let normals = cloud.attributes.normals.as_ref();
        let mut comparable = Self {
            positions: finite.iter().map(position).collect(),
            colors: colors.map(|colors| finite.iter().map(|&index| color(&colors[index])).collect()),
            normals: normals.map(|normals| finite.iter().map(|&index| normals[index].into()).collect()),
        };
        // In both clouds: models have several normals per corner, and a lossless file has zero error in any order.
        comparable.level_coincident();
        comparable
    }

    /// Gives points at the same place the mean of their attributes.
    fn level_coincident(&mut self) {
        if self.colors.is_none() && self.normals.is_none() {
            return;
        }
        let key = |&index: &u32| self.positions[index as usize].to_array().map(f32::to_bits);
        let mut order: Vec<u32> = (0..self.positions.len() as u32).collect();
        order.par_sort_unstable_by_key(key);
        let groups: Vec<&[u32]> = order
            .chunk_by(|a, b| key(a) == key(b))
            .filter(|group| group.len() > 1)
            .collect();
        for values in [&mut self.colors, &mut self.normals].into_iter().flatten() {
            for group in &groups {
                let sum: DVec3 = group.iter().map(|&index| values[index as usize].as_dvec3()).sum();
                let mean = (sum / group.len() as f64).as_vec3();
                for &index in *group {
                    values[index as usize] = mean;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Attributes;

    /// A grid of 8 × 8 × 2 points, coloured and with normals up, the upper layer with normals along X.
    fn layers() -> RawCloud {
        let places = (0..128).map(|index| [index % 8, index / 8 % 8, index / 64].map(|value| value as f32));
        let of_layer = |lower: [f32; 3], upper: [f32; 3]| (0..128).map(move |index| [lower, upper][index / 64]);
        RawCloud {
            attributes: Attributes {
                colors: Some((0..128u8).map(|index| [index, 100, 0, 255]).collect()),
                normals: Some(of_layer([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]).collect()),
                ..Attributes::default()
            },
            ..RawCloud::from_positions(Positions::F32(places.collect()))
        }
    }

    #[test]
    fn the_same_cloud_in_another_order_has_no_error() {
        let mut cloud = layers();
        // Three points at one position that differ in colour and normal, and a hole.
        let Positions::F32(positions) = &mut cloud.positions else {
            panic!("of single precision");
        };
        positions[65] = positions[0];
        positions[3] = positions[0];
        positions[7] = [f32::NAN; 3];
        let reference = ReferenceCloud::new(&cloud).unwrap();
        let mut turned = cloud.clone();
        turned.keep(&(0..128).rev().collect::<Vec<u32>>());
        let error = reference.compare(&turned).unwrap();
        assert_eq!(error.geometry.point_to_point.hausdorff(), 0.0);
        assert_eq!(error.color_squared, Some(0.0));
        assert!(error.normals.unwrap().max_deg < 1e-6, "{error:?}");
        assert_eq!(error.d1_psnr_db(), Some(f64::INFINITY));
        assert_eq!(error.d2_psnr_db(), Some(f64::INFINITY));
        assert_eq!(error.color_psnr_db(), Some(f64::INFINITY));
    }

    #[test]
    fn errors_match_the_construction() {
        let reference = ReferenceCloud::new(&layers()).unwrap();
        assert_eq!(reference.compare(&layers()).unwrap().peak, 7.0);
        // Raised by an eighth: along the normals of the lower layer, perpendicular to those of the upper one.
        let mut lifted = layers();
        let Positions::F32(positions) = &mut lifted.positions else {
            panic!("of single precision");
        };
        for position in positions {
            position[2] += 0.125;
        }
        // Red is off by 6 in every other point; normals are tilted by 45 degrees in the lower layer.
        for color in lifted.attributes.colors.as_mut().unwrap().iter_mut().step_by(2) {
            color[0] += 6;
        }
        lifted.attributes.normals.as_mut().unwrap()[..64].fill([0.5, 0.0, 0.5]);
        let error = reference.compare(&lifted).unwrap();
        assert_eq!(error.geometry.point_to_point.mean_squared(), 0.125 * 0.125);
        assert_eq!(
            error.geometry.point_to_plane.unwrap().mean_squared(),
            0.125 * 0.125 / 2.0
        );
        assert_eq!(error.color_squared, Some(36.0 / 2.0 / 3.0));
        let normals = error.normals.unwrap();
        assert!(
            (normals.mean_deg - 22.5).abs() < 1e-4 && (normals.max_deg - 45.0).abs() < 1e-4,
            "{normals:?}"
        );
        let d1 = 10.0 * (3.0f64 * 49.0 / (0.125 * 0.125)).log10();
        assert!((error.d1_psnr_db().unwrap() - d1).abs() < 1e-9);
        assert!((error.d2_psnr_db().unwrap() - d1 - 10.0 * 2f64.log10()).abs() < 1e-9);
    }

    #[test]
    fn missing_attributes_are_not_compared() {
        let bare = RawCloud::from_positions(layers().positions);
        let reference = ReferenceCloud::new(&bare).unwrap();
        let error = reference.compare(&layers()).unwrap();
        assert_eq!(
            (error.color_squared, error.normals, error.d2_psnr_db()),
            (None, None, None)
        );
        // Planes are estimated where the file has no normals: a point that slides along one stays close to it.
        let plane = (0..400).map(|index| [(index % 20) as f32, (index / 20) as f32, 5.0]);
        let plane = RawCloud::from_positions(Positions::F32(plane.collect()));
        let mut slid = plane.clone();
        let Positions::F32(positions) = &mut slid.positions else {
            panic!("of single precision");
        };
        for position in positions {
            position[0] += 0.25;
        }
        let error = ReferenceCloud::new(&plane)
            .unwrap()
            .with_planes()
            .unwrap()
            .compare(&slid)
            .unwrap();
        assert!(error.geometry.point_to_point.mean_squared() > 0.06);
        assert!(
            error.geometry.point_to_plane.unwrap().mean_squared() < 1e-9,
            "{error:?}"
        );
        let nothing = RawCloud::from_positions(Positions::F32(Vec::new()));
        assert!(matches!(
            ReferenceCloud::new(&nothing),
            Err(CloudMismatch::Empty(Side::Reference))
        ));
        assert!(matches!(
            reference.compare(&nothing),
            Err(CloudMismatch::Empty(Side::Test))
        ));
    }
}
