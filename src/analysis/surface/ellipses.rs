//! Elliptical splats that close the surface where circles do, with less area where points are farther apart in one
//! direction.
//!
//! How it works: a Voronoi cell is measured along 32 directions, as in [`super::radii`]. Its longer axis is the axis of
//! its second-order area integral, `∫ r⁴ (cos 2θ, sin 2θ) dθ` for the distance `r` to its end. Its [`Ellipse`] has the
//! distance to the farthest corner, `R`, as the quadratic mean of its half axes: then it is the circle around the cell,
//! or smaller, and where a circle just covers a rectangle, so does the ellipse that is as long in proportion. (One
//! within the circle does not cover the corner unless it is the circle.) So its only freedom is the ratio ρ of the half
//! axes, and it covers the corner at distance `r` and angle φ from the axis if `ρ² cos²φ + sin²φ / ρ² ≤ 2 R² / r² − 1 =
//! K`, which is a min ρ² of `2 sin²φ / (K + √(K² − sin² 2φ))`. The largest of these is the thinnest ellipse that covers
//! the cell. For the farthest corner it is tan φ: the ratio of the sides of a rectangle.
//!
//! Where the cell is open, or reaches beyond the neighbours that are known, there is a circle.
//!
//! When it wins: where rows of points are closer along than across, as in LiDAR sweeps. Measured apart from radii,
//! because it takes longer than they do and circles are drawn by default.

use super::directions::DIRECTIONS;
use super::holes::TWICE_COSINE;
use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{PointTree, SlotPoint};
use crate::cloud::Ellipse;
use glam::Vec3;
use rayon::prelude::*;

/// Directions in half a circle: an ellipse is as long along opposite ones.
const HALF: usize = DIRECTIONS / 2;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 9;

/// Ellipses by slot; `None` where there is a circle. `normals` are unit vectors of any sign, by slot.
pub(in crate::analysis) fn closing_ellipses(
    tree: &PointTree,
    neighbours: &Neighbours,
    normals: &[Vec3],
) -> Vec<Option<Ellipse>> {
    let circle = Circle::new();
    let slots = (0..tree.len()).into_par_iter().with_min_len(POINTS_PER_TASK);
    slots
        .map(|slot| {
            let [tangent, bitangent] = <[Vec3; 2]>::from(normals[slot].any_orthonormal_pair());
            let list = neighbours.of(slot);
            let inverse = circle.inverse_distances(tree.points(), slot, list, [tangent, bitangent])?;
            let [x, y, ratio] = circle.thinnest(&inverse)?;
            Some(Ellipse {
                axis: tangent * x + bitangent * y,
                ratio,
            })
        })
        .collect()
}

/// The directions along which cells are measured.
struct Circle {
    cosines: [f32; DIRECTIONS],
    sines: [f32; DIRECTIONS],
    /// Cosines and sines of the doubled angles of half a circle.
    double_cosines: [f32; HALF],
    double_sines: [f32; HALF],
}

impl Circle {
    fn new() -> Self {
        let angle = |place: usize, count: usize| place as f32 / count as f32 * std::f32::consts::TAU;
        Self {
            cosines: std::array::from_fn(|place| angle(place, DIRECTIONS).cos()),
            sines: std::array::from_fn(|place| angle(place, DIRECTIONS).sin()),
            double_cosines: std::array::from_fn(|place| angle(place, HALF).cos()),
            double_sines: std::array::from_fn(|place| angle(place, HALF).sin()),
        }
    }

    /// One over the distance to the end of a cell along each direction; `None` if it is open or not known to its end.
    fn inverse_distances(
        &self,
        points: &[SlotPoint],
        slot: usize,
        list: &[u32],
        tangents: [Vec3; 2],
    ) -> Option<[f32; DIRECTIONS]> {
        let mut inverse = [0f32; DIRECTIONS];
        let mut reach_squared = 0f32;
        for &other in list {
            let offset = points[other as usize].position - points[slot].position;
            let [x, y] = tangents.map(|tangent| tangent.dot(offset));
            let squared = x * x + y * y;
            if squared == 0.0 {
                // Directly above or below: there is no bisector.
                continue;
            }
            reach_squared = reach_squared.max(squared);
            let (x, y) = (2.0 * x / squared, 2.0 * y / squared);
            for ((inverse, cosine), sine) in inverse.iter_mut().zip(&self.cosines).zip(&self.sines) {
                *inverse = inverse.max(x * cosine + y * sine);
            }
        }
        let known = 1.0 / reach_squared.sqrt();
        let is_closed = (0..DIRECTIONS).all(|direction| {
            let at = |steps: usize| inverse[(direction + steps) % DIRECTIONS];
            // As in `holes`, without checking whether another line closes it.
            let first = (at(0) - TWICE_COSINE * at(1) + at(2)).max(0.0);
            let second = (at(1) - TWICE_COSINE * at(2) + at(3)).max(0.0);
            let meeting = first * (at(1) - known) + second * (at(2) - known - first);
            at(0) >= known && meeting >= 0.0
        });
        is_closed.then_some(inverse)
    }

    /// The direction of the longer axis and the ratio of the thinnest ellipse around a cell; `None` for a circle.
    fn thinnest(&self, inverse: &[f32; DIRECTIONS]) -> Option<[f32; 3]> {
        // An end on one side is covered if the farther of the two is.
        let (low, high) = inverse.split_at(HALF);
        let mut nearness = [0f32; HALF];
        for ((nearness, low), high) in nearness.iter_mut().zip(low).zip(high) {
            *nearness = low.min(*high);
        }
        let farthest = nearness.iter().copied().fold(f32::INFINITY, f32::min);
        let (mut along, mut across) = (0.0, 0.0);
        let doubled = || self.double_cosines.iter().zip(&self.double_sines);
        for ((low, high), (cosine, sine)) in low.iter().zip(high).zip(doubled()) {
            let [low, high] = [low, high].map(|inverse| 1.0 / (inverse * inverse));
            let moment = low * low + high * high;
            along += moment * cosine;
            across += moment * sine;
        }
        let length = along.hypot(across);
        if length.is_nan() || length == 0.0 {
            return None;
        }
        let (double_x, double_y) = (along / length, across / length);
        let mut ratio_squared = 0f32;
        for (nearness, (cosine, sine)) in nearness.iter().zip(doubled()) {
            let share = nearness / farthest;
            let reach = 2.0 * share * share - 1.0;
            let double = cosine * double_x + sine * double_y;
            let root = (reach * reach - 1.0 + double * double).max(0.0).sqrt();
            ratio_squared = ratio_squared.max((1.0 - double) / (reach + root));
        }
        if ratio_squared >= 1.0 {
            return None;
        }
        // The half-angle formula, without a trigonometric function.
        let x = (0.5 * (1.0 + double_x)).max(0.0).sqrt();
        let y = (0.5 * (1.0 - double_x)).max(0.0).sqrt().copysign(double_y);
        Some([x, y, ratio_squared.sqrt()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::splat_ellipses;
    use crate::analysis::splat_radii;
    use crate::analysis::test_shapes::{Random, sphere};

    /// The centre of a lattice with these steps along two axes, rotated by an angle in radians; its axis of smaller
    /// steps.
    fn lattice(steps: [f32; 2], turn: f32) -> (Vec<Vec3>, Vec3) {
        let (sine, cosine) = turn.sin_cos();
        // In the plane across (0, 0.6, 0.8).
        let place = |x: f32, y: f32| {
            let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
            Vec3::new(x, 0.8 * y, -0.6 * y)
        };
        let rows = (-12..=12).flat_map(|i| (-12..=12).map(move |j| (i as f32, j as f32)));
        let positions = rows.map(|(i, j)| place(i * steps[0], j * steps[1])).collect();
        (positions, place(0.0, 1.0))
    }

    const NORMAL: Vec3 = Vec3::new(0.0, 0.6, 0.8);

    /// Ellipses of points that are not near the edge of a [`lattice`].
    fn inner(positions: &[Vec3]) -> Vec<Option<Ellipse>> {
        let ellipses = splat_ellipses(positions, &vec![NORMAL; positions.len()]);
        let is_inner = |index: usize| (8..17).contains(&(index % 25)) && (8..17).contains(&(index / 25));
        let all = ellipses.into_iter().enumerate();
        all.filter(|&(index, _)| is_inner(index))
            .map(|(_, ellipse)| ellipse)
            .collect()
    }

    #[test]
    fn ellipses_have_the_axis_and_ratio_of_their_lattice() {
        for turn in [0.0, 0.3, 0.7, 1.2, 2.0] {
            for (long, ratio) in [(3.0, 1.0 / 3.0), (2.0, 0.5), (4.0, 0.25)] {
                let (positions, axis) = lattice([1.0, long], turn);
                for ellipse in inner(&positions) {
                    let found = ellipse.expect("no circle");
                    let off = found.axis.dot(axis).abs().min(1.0).acos().to_degrees();
                    assert!(off < 4.0, "{off} degrees at {turn}, {long}");
                    assert!(
                        (found.ratio / ratio - 1.0).abs() < 0.25,
                        "{} for {ratio} at {turn}",
                        found.ratio
                    );
                }
            }
            let (positions, _) = lattice([1.0, 1.0], turn);
            for ellipse in inner(&positions) {
                let ratio = ellipse.map_or(1.0, |ellipse| ellipse.ratio);
                assert!(ratio > 0.8, "{ratio} of a square at {turn}");
            }
        }
    }

    /// Share of a fine grid over the centre of a lattice that no ellipse of `scale` times the radius covers.
    fn open_share(positions: &[Vec3], steps: [f32; 2], turn: f32, scale: f32) -> f32 {
        let normals = vec![NORMAL; positions.len()];
        let radii = splat_radii(positions, &normals);
        let ellipses = splat_ellipses(positions, &normals);
        let is_covered = |place: Vec3| {
            (0..positions.len()).any(|index| {
                let offset = place - positions[index];
                let radius = scale * radii[index];
                let Some(ellipse) = ellipses[index] else {
                    return offset.length() <= radius;
                };
                let [longer, shorter] = ellipse.half_axes(ellipse.radius_of_quadratic_mean(radius));
                let along = offset.dot(ellipse.axis);
                let across = offset.dot(NORMAL.cross(ellipse.axis));
                (along / longer).powi(2) + (across / shorter).powi(2) <= 1.0
            })
        };
        let (sine, cosine) = turn.sin_cos();
        let grid = (0..80).flat_map(|i| (0..80).map(move |j| (i as f32, j as f32)));
        let open = grid.filter(|(i, j)| {
            let (x, y) = (i * 0.037 * steps[0], j * 0.037 * steps[1]);
            let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
            !is_covered(Vec3::new(x, 0.8 * y, -0.6 * y))
        });
        open.count() as f32 / 6400.0
    }

    #[test]
    fn ellipses_close_lattices_and_shrunken_ones_do_not() {
        for turn in [0.0, 0.3, 1.2] {
            for steps in [[1.0, 3.0], [1.0, 2.0], [1.0, 1.0]] {
                let (positions, _) = lattice(steps, turn);
                let [open, shrunk] = [1.0, 2.0 / 3.0].map(|scale| open_share(&positions, steps, turn, scale));
                assert_eq!(open, 0.0, "{steps:?} at {turn}");
                assert!(shrunk > 0.02, "{shrunk} of {steps:?} at {turn}");
            }
        }
    }

    #[test]
    fn rows_and_coincident_points_get_circles() {
        let direction = Vec3::new(0.3, 0.7, 0.1);
        let row: Vec<Vec3> = (0..200).map(|i| direction * i as f32).collect();
        for cloud in [row, vec![Vec3::ONE; 30], vec![Vec3::ONE], Vec::new()] {
            let ellipses = splat_ellipses(&cloud, &vec![Vec3::ZERO; cloud.len()]);
            assert_eq!(ellipses, vec![None; cloud.len()]);
        }
    }

    #[test]
    fn ellipses_of_scattered_points_lie_in_their_planes() {
        let shape = sphere(5_000, &mut Random(23));
        let ellipses = splat_ellipses(&shape.positions, &shape.normals);
        let (mut count, mut area) = (0, 0.0);
        for (ellipse, normal) in ellipses.iter().zip(&shape.normals) {
            let Some(ellipse @ Ellipse { axis, ratio }) = *ellipse else {
                continue;
            };
            assert!(axis.is_normalized() && axis.dot(*normal).abs() < 1e-3);
            assert!(ratio > 0.0 && ratio < 1.0, "{ratio}");
            area += ellipse.radius_of_quadratic_mean(1.0).powi(2);
            count += 1;
        }
        assert!(count > 4_000, "{count} of 5000");
        assert!(area < 0.95 * count as f32, "{area} for circles of {count}");
    }
}
