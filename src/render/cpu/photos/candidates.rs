//! Candidate images that see a point, and their angles from the eye's direction: eight of them at a time.

use crate::render::constants::PHOTO_NOT_LOOKING;
use crate::render::cpu::eight::Vectors;
use crate::scene::PhotoView;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use glam::Vec3;

/// Number of images that are evaluated together.
const LANES: usize = 8;

/// One number for each of eight images.
type Eight = [f32; LANES];

/// Group of eight images; unused entries have no pixels.
#[derive(Debug, Clone, Default)]
struct Group {
    /// Rows of the matrices into the spaces of their cameras.
    rows: [[Eight; 4]; 3],
    center: [Eight; 3],
    focal: [Eight; 2],
    principal: [Eight; 2],
    size: [Eight; 2],
}

/// Candidate images of a rendered frame.
#[derive(Debug)]
pub(super) struct Candidates {
    groups: Vec<Group>,
}

/// Scores of the images for one point.
#[derive(Debug, Default)]
pub(super) struct Scores {
    /// The cosine of the angle between the directions to the camera and to the eye; [`Scores::NONE`] where it does not
    /// look.
    cosines: Vec<f32>,
    /// The largest cosine of each eight: most of them need not be searched for the next one.
    largest: Vec<f32>,
    /// Squares of these angles.
    angles2: Vec<f32>,
    /// Position of the point in the images, in texels from the upper left corner.
    places: [Vec<f32>; 2],
    /// Along the axes of their cameras.
    distances: Vec<f32>,
    /// The cosine between the direction to the camera and the normal; 0 without one.
    facings: Vec<f32>,
}

impl Candidates {
    pub(super) fn of(views: &[PhotoView]) -> Self {
        let group = |views: &[PhotoView]| {
            let mut group = Group::default();
            for (lane, view) in views.iter().enumerate() {
                for (row, of_view) in group.rows.iter_mut().zip(&view.camera_from_view) {
                    for (column, value) in row.iter_mut().zip(of_view.to_array()) {
                        column[lane] = value;
                    }
                }
                for axis in 0..3 {
                    group.center[axis][lane] = view.center[axis];
                }
                for axis in 0..2 {
                    group.focal[axis][lane] = view.focal[axis];
                    group.principal[axis][lane] = view.principal[axis];
                    group.size[axis][lane] = view.size[axis];
                }
            }
            group
        };
        Self {
            groups: views.chunks(LANES).map(group).collect(),
        }
    }

    /// Scores all images for a point in view space. `to_eye` has length 1, and `normal` too if it is known.
    #[inline(always)]
    pub(super) fn score<S: Simd>(&self, simd: S, place: Vec3, to_eye: Vec3, normal: Vec3, scores: &mut Scores) {
        let zero = f32x8::splat(simd, 0.0);
        let at = Vectors::splat(simd, place);
        let (to_eye, normal) = (Vectors::splat(simd, to_eye), Vectors::splat(simd, normal));
        scores.resize(LANES * self.groups.len());
        let (cosines, _) = scores.cosines.as_chunks_mut::<LANES>();
        let [columns, rows] = &mut scores.places;
        let (columns, _) = columns.as_chunks_mut::<LANES>();
        let (rows, _) = rows.as_chunks_mut::<LANES>();
        let (distances, _) = scores.distances.as_chunks_mut::<LANES>();
        let (facings, _) = scores.facings.as_chunks_mut::<LANES>();
        let of_groups = cosines
            .iter_mut()
            .zip(columns)
            .zip(rows.iter_mut().zip(distances.iter_mut().zip(facings)));
        let (angles2, _) = scores.angles2.as_chunks_mut::<LANES>();
        let of_groups = of_groups.zip(scores.largest.iter_mut().zip(angles2));
        for (group, (of_group, (largest, angles2))) in self.groups.iter().zip(of_groups) {
            let ((cosines, columns), (rows, (distances, facings))) = of_group;
            let place_in = [along(simd, &group.rows[0], &at), along(simd, &group.rows[1], &at)];
            let distance = along(simd, &group.rows[2], &at);
            let per_distance = 1.0 / distance;
            let column = place_in[0] * per_distance * of(simd, &group.focal[0]) + of(simd, &group.principal[0]);
            let row = place_in[1] * per_distance * of(simd, &group.focal[1]) + of(simd, &group.principal[1]);
            let way = Vectors {
                x: of(simd, &group.center[0]),
                y: of(simd, &group.center[1]),
                z: of(simd, &group.center[2]),
            }
            .minus(at);
            let per_length = 1.0 / way.dot(way).max(f32::MIN_POSITIVE).sqrt();
            let cosine = way.dot(to_eye) * per_length;
            let facing = way.dot(normal) * per_length;
            // Without a normal `facing` is 0 everywhere.
            // Masks of eight lanes: comparisons joined by `&&` prevented vectorisation, and a third of the time went
            // into scores.
            let looks = distance.simd_gt(zero)
                & column.simd_ge(zero)
                & column.simd_lt(of(simd, &group.size[0]))
                & row.simd_ge(zero)
                & row.simd_lt(of(simd, &group.size[1]))
                & facing.simd_ge(zero);
            let none = f32x8::splat(simd, Scores::NONE);
            cosines.copy_from_slice(simd.select_f32x8(looks, cosine, none).as_slice());
            columns.copy_from_slice(column.as_slice());
            rows.copy_from_slice(row.as_slice());
            distances.copy_from_slice(distance.as_slice());
            facings.copy_from_slice(facing.as_slice());
            angles2.copy_from_slice(squared_angles(simd, cosine).as_slice());
            *largest = largest_of(cosines);
        }
    }
}

#[inline(always)]
fn of<S: Simd>(simd: S, eight: &Eight) -> f32x8<S> {
    f32x8::from_slice(simd, eight)
}

/// Along an axis of each camera.
#[inline(always)]
fn along<S: Simd>(simd: S, row: &[Eight; 4], place: &Vectors<S>) -> f32x8<S> {
    let offset = of(simd, &row[3]);
    let offset = of(simd, &row[2]).mul_add(place.z, offset);
    let offset = of(simd, &row[1]).mul_add(place.y, offset);
    of(simd, &row[0]).mul_add(place.x, offset)
}

/// Squares of the angles that have these cosines, to 1e-6: by the polynomial for `acos(x) / √(1 − x)` of Abramowitz and
/// Stegun 1964, 4.4.46, which needs no root where angles are acute.
#[inline(always)]
fn squared_angles<S: Simd>(simd: S, cosine: f32x8<S>) -> f32x8<S> {
    const TERMS: [f64; 8] = [
        -0.001_262_491_1,
        0.006_670_090_1,
        -0.017_088_125_6,
        0.030_891_881_0,
        -0.050_174_304_6,
        0.088_978_987_4,
        -0.214_598_801_6,
        1.570_796_305_0,
    ];
    let one = f32x8::splat(simd, 1.0);
    let size = cosine.abs().min(one);
    let [first, terms @ ..] = TERMS.map(|term| f32x8::splat(simd, term as f32));
    let per_root = terms.into_iter().fold(first, |sum, term| sum.mul_add(size, term));
    let acute2 = (one - size) * per_root * per_root;
    let obtuse = std::f32::consts::PI - acute2.sqrt();
    simd.select_f32x8(cosine.simd_lt(f32x8::splat(simd, 0.0)), obtuse * obtuse, acute2)
}

#[inline(always)]
fn largest_of(cosines: &Eight) -> f32 {
    cosines.iter().copied().fold(Scores::NONE, f32::max)
}

impl Scores {
    const NONE: f32 = PHOTO_NOT_LOOKING;

    fn resize(&mut self, count: usize) {
        if self.cosines.len() != count {
            let [columns, rows] = &mut self.places;
            let [cosines, angles2] = [&mut self.cosines, &mut self.angles2];
            for values in [cosines, angles2, columns, rows, &mut self.distances, &mut self.facings] {
                values.resize(count, Self::NONE);
            }
            self.largest.resize(count / LANES, Self::NONE);
        }
    }

    /// Returns the image that looks from nearest to the eye's direction; it is not found again.
    #[inline(always)]
    pub(super) fn take_best(&mut self) -> Option<usize> {
        let (mut group, mut cosine) = (0, Self::NONE);
        // Not over all cosines: searching all of them for the best took a fifth of the time.
        for (at, &value) in self.largest.iter().enumerate() {
            if value > cosine {
                (group, cosine) = (at, value);
            }
        }
        if cosine == Self::NONE {
            return None;
        }
        let (groups, _) = self.cosines.as_chunks_mut::<LANES>();
        let lanes = &mut groups[group];
        let lane = lanes.iter().position(|&value| value == cosine)?;
        lanes[lane] = Self::NONE;
        self.largest[group] = largest_of(lanes);
        Some(LANES * group + lane)
    }

    /// The square of the angle between the directions to its camera and to the eye.
    pub(super) fn angle2(&self, view: usize) -> f32 {
        self.angles2[view]
    }

    /// Returns the position of the point in an image, in texels from its upper left corner.
    pub(super) fn place(&self, view: usize) -> [f32; 2] {
        [self.places[0][view], self.places[1][view]]
    }

    /// The cosine between the direction to its camera and the normal of the place; 0 without one.
    pub(super) fn facing(&self, view: usize) -> f32 {
        self.facings[view]
    }

    /// Returns the distance of the point along the axis of its camera.
    pub(super) fn distance(&self, view: usize) -> f32 {
        self.distances[view]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use glam::Vec4;

    /// Cameras at these places of view space that look along −z.
    fn looking_down(centers: &[Vec3]) -> Vec<PhotoView> {
        let of = |&center: &Vec3| PhotoView {
            camera_from_view: [
                Vec4::new(1.0, 0.0, 0.0, -center.x),
                Vec4::new(0.0, -1.0, 0.0, center.y),
                Vec4::new(0.0, 0.0, -1.0, center.z),
            ],
            center,
            focal: [100.0; 2],
            principal: [50.0, 40.0],
            size: [100.0, 80.0],
            gain: Vec3::ONE,
        };
        centers.iter().map(of).collect()
    }

    /// For an eye along +z.
    fn score(candidates: &Candidates, place: Vec3, normal: Vec3, scores: &mut Scores) {
        dispatch!(Level::new(), simd => candidates.score(simd, place, Vec3::Z, normal, scores));
    }

    #[test]
    fn candidates_are_unique_and_sorted_by_angle() {
        let centers: Vec<Vec3> = (0..11).map(|at| Vec3::new(0.1 * at as f32 - 0.42, 0.0, 2.0)).collect();
        let candidates = Candidates::of(&looking_down(&centers));
        let mut scores = Scores::default();
        score(&candidates, Vec3::new(0.0, 0.0, -1.0), Vec3::ZERO, &mut scores);
        let mut found = Vec::new();
        while let Some(view) = scores.take_best() {
            let angle = (centers[view] + Vec3::Z).angle_between(Vec3::Z);
            assert!((scores.angle2(view) - angle * angle).abs() < 2e-6, "{view}");
            found.push(view);
        }
        assert_eq!(found, [4, 5, 3, 6, 2, 7, 1, 8, 0, 9, 10]);
        assert_eq!(scores.distance(4), 3.0);
        let [column, row] = scores.place(4);
        assert!((column - (50.0 + 100.0 * 0.02 / 3.0)).abs() < 1e-4 && (row - 40.0).abs() < 1e-4);
    }

    #[test]
    fn squared_angles_are_accurate() {
        for step in 0..=225 {
            let degrees = |lane: usize| 0.1 * (LANES * step + lane) as f64;
            let cosines: Eight = std::array::from_fn(|lane| degrees(lane).to_radians().cos() as f32);
            let mut found = Eight::default();
            dispatch!(Level::new(), simd => {
                found.copy_from_slice(squared_angles(simd, of(simd, &cosines)).as_slice());
            });
            for (cosine, found) in cosines.into_iter().zip(found) {
                let angle = f64::from(cosine).acos();
                assert!((f64::from(found) - angle * angle).abs() < 4e-6, "{angle}: {found}");
            }
        }
    }

    #[test]
    fn cameras_that_do_not_see_a_place_are_not_candidates() {
        let behind = Vec3::new(0.0, 0.0, -3.0);
        let aside = Vec3::new(3.0, 0.0, 2.0);
        let above = Vec3::new(0.0, 0.1, 2.0);
        let candidates = Candidates::of(&looking_down(&[behind, aside, above]));
        let mut scores = Scores::default();
        let place = Vec3::new(0.0, 0.0, -1.0);
        score(&candidates, place, Vec3::ZERO, &mut scores);
        assert_eq!(scores.take_best(), Some(2));
        assert_eq!(scores.take_best(), None);
        // A surface that faces away from it.
        score(&candidates, place, Vec3::new(0.0, -1.0, 0.0), &mut scores);
        assert_eq!(scores.take_best(), None);
    }
}
