//! Curved splats: disks are bent with the surface; each becomes several smaller ones on the quadric that fits its
//! neighbours.
//!
//! How it works: a disk of radius r lies on the tangent plane of a surface of curvature κ, so its edge is κr²/2 above
//! it, and beyond an outline it reaches by as much. In the tangent plane of a point the surface is `h = (a u² + 2b uv +
//! c v²) / 2`; the three numbers are least squares of the heights and the slopes of its neighbours, each divided by the
//! quantity it grows with (the squared distance, the distance), so that all are curvatures. Where the largest curvature
//! turns the normal noticeably within the disk, and the neighbours agree on it, the disk becomes 7 or 19 in a hexagon,
//! each at its height and turned to its slope. Half the radius has a quarter of the error.
//!
//! When it wins: on few points of a smooth surface, whose disks are large: in input images, outlines of an object are
//! next to its background. Many points have small disks; at creases, leaves and noise the neighbours disagree, and the
//! disks stay as they are. After the quadrics of osculating jets (Cazals and Pouget 2005, *Estimating differential
//! quantities using polynomial fitting of osculating jets*), of degree two with the normal known.

use crate::analysis::nearest_neighbours;
use glam::{DMat3, DVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Neighbours whose heights and slopes are fitted.
const NEIGHBOURS: usize = 12;

/// Neighbours farther away than this many radii say nothing of the disk.
const REACH: f32 = 4.0;

/// Minimum cosine between normals of one surface.
const SAME_SURFACE: f32 = 0.5;

/// Thresholds of the turn of the normal from the centre of a disk to its edge, radians: below the first, the disk stays
/// as it is; from the second on it becomes 19; more than the third is rejected.
const TURNS: [f32; 3] = [0.06, 0.15, 0.8];

/// Maximum residual of neighbours from the quadric, as a fraction of its largest curvature.
const OF_ONE_MIND: f32 = 0.5;

/// Three of each neighbour: four of them.
const MIN_ROWS: f64 = 12.0;

/// Minimum determinant of the mean matrix of the least squares; 0.02 where neighbours are all around.
const MIN_DETERMINANT: f64 = 1e-4;

/// Positions of small disks on a disk of radius 1, after the one at its centre: a hexagon, and the corners and
/// midpoints of the sides of one twice as large.
const HEXAGON: [[f32; 2]; 18] = {
    const H: f32 = 0.866_025_4;
    [
        [1.0, 0.0],
        [0.5, H],
        [-0.5, H],
        [-1.0, 0.0],
        [-0.5, -H],
        [0.5, -H],
        [2.0, 0.0],
        [1.5, H],
        [1.0, 2.0 * H],
        [0.0, 2.0 * H],
        [-1.0, 2.0 * H],
        [-1.5, H],
        [-2.0, 0.0],
        [-1.5, -H],
        [-1.0, -2.0 * H],
        [0.0, -2.0 * H],
        [1.0, -2.0 * H],
        [1.5, -H],
    ]
};

/// Spacing and size of small disks, in radii of the disk, for 7 and 19.
const SEVEN: (usize, f32, f32) = (6, 0.66, 0.55);
const NINETEEN: (usize, f32, f32) = (18, 0.40, 0.34);

/// A round splat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Centre of the disk.
    pub position: Vec3,
    /// Unit normal, of either sign.
    pub normal: Vec3,
    /// Its radius.
    pub radius: f32,
}

/// The disks that replace each of `disks`, and the index of that one. `is_used` are those that are of the surface;
/// others stay, and say nothing of it. `None` where all stay as they are. Precondition: all numbers are finite.
pub fn curved_splats(disks: &[Disk], is_used: impl Fn(usize) -> bool + Sync) -> Option<Vec<(usize, Disk)>> {
    let used: Vec<usize> = (0..disks.len()).filter(|&at| is_used(at)).collect();
    let positions: Vec<Vec3> = used.iter().map(|&at| disks[at].position).collect();
    let neighbours = nearest_neighbours(&positions, NEIGHBOURS);
    let of_used = |at: usize| {
        let disk = &disks[used[at]];
        let around = neighbours.of(at).iter().map(|&other| &disks[used[other as usize]]);
        Quadric::of(disk, around)
    };
    let quadrics: Vec<Option<Quadric>> = (0..used.len()).into_par_iter().map(of_used).collect();
    if quadrics.iter().all(Option::is_none) {
        return None;
    }
    let mut of_disk = vec![None; disks.len()];
    for (&at, quadric) in used.iter().zip(quadrics) {
        of_disk[at] = quadric;
    }
    let mut curved = Vec::with_capacity(2 * disks.len());
    for (at, (disk, quadric)) in disks.iter().zip(of_disk).enumerate() {
        match quadric {
            Some(quadric) => quadric.add_disks(disk, |disk| curved.push((at, disk))),
            None => curved.push((at, *disk)),
        }
    }
    Some(curved)
}

/// Quadric of the surface around a point: heights above its tangent plane.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    axes: [Vec3; 2],
    /// Coefficients of u², of uv twice, of v².
    curvatures: Vec3,
    max: f32,
}

impl Quadric {
    /// The quadric of a disk with these neighbours, if it bends the disk.
    fn of<'a>(disk: &Disk, around: impl Iterator<Item = &'a Disk>) -> Option<Self> {
        let normal = disk.normal;
        let across = normal.any_orthonormal_vector();
        let axes = [across, normal.cross(across)];
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        let (mut squares, mut count) = (0.0_f64, 0.0_f64);
        for other in around {
            let way = other.position - disk.position;
            let at = Vec2::new(way.dot(axes[0]), way.dot(axes[1]));
            let length = at.length();
            let upright = normal.dot(other.normal);
            let is_near = length > 1e-3 * disk.radius && way.length() < REACH * disk.radius;
            if !is_near || upright.abs() < SAME_SURFACE {
                continue;
            }
            let slope = Vec2::new(axes[0].dot(other.normal), axes[1].dot(other.normal)) / -upright;
            let (direction, height) = (at / length, way.dot(normal));
            let [u, v] = direction.as_dvec2().to_array();
            let rows = [
                (DVec3::new(u * u, 2.0 * u * v, v * v), 2.0 * height / (length * length)),
                (DVec3::new(u, v, 0.0), slope.x / length),
                (DVec3::new(0.0, u, v), slope.y / length),
            ];
            for (row, value) in rows {
                let value = f64::from(value);
                matrix += DMat3::from_cols(row.x * row, row.y * row, row.z * row);
                right += value * row;
                squares += value * value;
                count += 1.0;
            }
        }
        // Neighbours on one line give no information across it.
        if count < MIN_ROWS || matrix.determinant() < MIN_DETERMINANT * count.powi(3) {
            return None;
        }
        let found = matrix.inverse() * right;
        let max = largest(found.as_vec3());
        let turn = max * disk.radius;
        let off = ((squares - found.dot(right)).max(0.0) / (count - 3.0)).sqrt();
        let is_curved = turn > TURNS[0] && off <= f64::from(OF_ONE_MIND * max);
        if !is_curved {
            return None;
        }
        let scale = (TURNS[2] / turn).min(1.0);
        Some(Self {
            axes,
            curvatures: scale * found.as_vec3(),
            max: scale * max,
        })
    }

    /// The disks that replace a disk.
    fn add_disks(&self, disk: &Disk, mut add: impl FnMut(Disk)) {
        let is_strong = self.max * disk.radius > TURNS[1];
        let (count, step, radius) = if is_strong { NINETEEN } else { SEVEN };
        let [a, b, c] = self.curvatures.to_array();
        let around = HEXAGON[..count].iter().map(|&at| step * disk.radius * Vec2::from(at));
        for at in std::iter::once(Vec2::ZERO).chain(around) {
            let slope = Vec2::new(a * at.x + b * at.y, b * at.x + c * at.y);
            let place = at.x * self.axes[0] + at.y * self.axes[1] + 0.5 * slope.dot(at) * disk.normal;
            let normal = disk.normal - slope.x * self.axes[0] - slope.y * self.axes[1];
            add(Disk {
                position: disk.position + place,
                normal: normal.normalize(),
                radius: radius * disk.radius,
            });
        }
    }
}

/// The larger of both principal curvatures, without its sign.
fn largest(curvatures: Vec3) -> f32 {
    let [a, b, c] = curvatures.to_array();
    (0.5 * (a + c)).abs() + (0.5 * (a - c)).hypot(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f32::consts::{PI, TAU};

    const SPACING: f32 = 0.1;

    fn disk(position: Vec3, normal: Vec3) -> Disk {
        Disk {
            position,
            normal,
            radius: SPACING,
        }
    }

    /// A tube of radius 0.3 along z, about [`SPACING`] apart, longer than the examined part.
    fn tube() -> Vec<Disk> {
        (0..40 * 19)
            .map(|at| {
                let turn = TAU * ((at % 19) as f32 + 0.5 * (at / 19 % 2) as f32) / 19.0;
                let normal = Vec3::new(turn.cos(), turn.sin(), 0.0);
                disk(0.3 * normal + SPACING * (at / 19) as f32 * Vec3::Z, normal)
            })
            .collect()
    }

    fn ball(radius: f32, count: usize) -> Vec<Disk> {
        let golden = PI * (3.0 - 5.0_f32.sqrt());
        (0..count)
            .map(|at| {
                let z = 1.0 - (2.0 * at as f32 + 1.0) / count as f32;
                let (sin, cos) = (golden * at as f32).sin_cos();
                let across = (1.0 - z * z).sqrt();
                let normal = Vec3::new(across * cos, across * sin, z);
                disk(radius * normal, normal)
            })
            .collect()
    }

    fn plane() -> Vec<Disk> {
        (0..400)
            .map(|at| disk(SPACING * Vec3::new((at % 20) as f32, (at / 20) as f32, 0.0), Vec3::Z))
            .collect()
    }

    /// Points on the edges of disks, which show beyond outlines.
    fn rim(disk: &Disk) -> [Vec3; 8] {
        let across = disk.normal.any_orthonormal_vector();
        let axes = [across, disk.normal.cross(across)];
        std::array::from_fn(|at| {
            let (sin, cos) = (TAU * at as f32 / 8.0).sin_cos();
            disk.position + disk.radius * (cos * axes[0] + sin * axes[1])
        })
    }

    #[test]
    fn curved_splats_of_a_tube_lie_on_it_and_overhang_a_quarter_as_far() {
        let flat = tube();
        let curved = curved_splats(&flat, |_| true).unwrap();
        let beyond = |disk: &Disk| {
            let reach = rim(disk).map(|place| place.truncate().length() - 0.3);
            reach.into_iter().fold(0.0, f32::max)
        };
        let inside = |disk: &Disk| disk.position.z > 0.5 && disk.position.z < 3.4;
        let max =
            |disks: &mut dyn Iterator<Item = Disk>| disks.filter(inside).map(|disk| beyond(&disk)).fold(0.0, f32::max);
        let before = max(&mut flat.iter().copied());
        let after = max(&mut curved.iter().map(|&(_, disk)| disk));
        assert!(before > 0.015 && after < 0.25 * before, "{before} {after}");
        for (_, disk) in curved.iter().filter(|(_, disk)| inside(disk)) {
            let upright = disk.position.with_z(0.0).normalize();
            assert!((disk.position.truncate().length() - 0.3).abs() < 2e-3, "{disk:?}");
            assert!(
                disk.normal.dot(upright) > 0.998 && disk.normal.is_normalized(),
                "{disk:?}"
            );
        }
    }

    /// Seen from outside, nothing of a ball that was covered is open.
    #[test]
    fn curved_splats_leave_no_hole() {
        let flat = ball(0.8, 800);
        let curved = curved_splats(&flat, |_| true).unwrap();
        assert_eq!(curved.len(), 7 * flat.len(), "each is bent a little");
        for at in ball(0.8, 5000) {
            let is_covered = curved.iter().any(|(_, disk)| {
                let way = at.position - disk.position;
                (way - way.dot(disk.normal) * disk.normal).length() <= disk.radius && way.length() < 0.2
            });
            assert!(is_covered, "{at:?}");
        }
    }

    #[test]
    fn planes_and_undetermined_curvature_leave_disks_flat() {
        assert_eq!(curved_splats(&plane(), |_| true), None);
        assert_eq!(curved_splats(&[], |_| true), None);
        assert_eq!(curved_splats(&tube()[..1], |_| true), None);
        assert_eq!(curved_splats(&tube(), |_| false), None);
        // Disks on a line give no information across it.
        let line: Vec<Disk> = (0..30).map(|at| disk(SPACING * at as f32 * Vec3::X, Vec3::Z)).collect();
        assert_eq!(curved_splats(&line, |_| true), None);
        // Normals perturbed at random.
        let mut noisy = plane();
        for (at, disk) in noisy.iter_mut().enumerate() {
            let (sin, cos) = (2.4 * (at * at) as f32).sin_cos();
            disk.normal = Vec3::new(0.3 * cos, 0.3 * sin, 1.0).normalize();
        }
        let curved = curved_splats(&noisy, |_| true).map_or(0, |curved| curved.len() - noisy.len());
        assert!(curved < 6 * noisy.len() / 4, "{curved}");
    }

    #[test]
    fn excluded_disks_stay_flat_and_do_not_bend_others() {
        let mut disks = tube();
        disks.push(disk(Vec3::new(0.5, 0.0, 2.0), Vec3::X));
        let last = disks.len() - 1;
        let with = curved_splats(&disks, |at| at != last).unwrap();
        let without = curved_splats(&disks[..last], |_| true).unwrap();
        assert_eq!(with.last(), Some(&(last, disks[last])));
        assert_eq!(with[..with.len() - 1], without[..]);
    }

    proptest! {
        /// For any disks, the resulting ones are finite, no larger, and within their reach.
        #[test]
        fn curved_splats_stay_within_their_disks(
            disks in prop::collection::vec(
                (prop::array::uniform3(-1.0_f32..1.0), prop::array::uniform3(-1.0_f32..1.0), 0.0_f32..0.5), 0..60),
        ) {
            let disks: Vec<Disk> = disks.into_iter().map(|(position, normal, radius)| Disk {
                position: position.into(),
                normal: Vec3::from(normal).normalize_or(Vec3::Z),
                radius,
            }).collect();
            for (of, disk) in curved_splats(&disks, |_| true).unwrap_or_default() {
                prop_assert!(disk.position.is_finite() && disk.normal.is_normalized());
                prop_assert!(disk.radius <= disks[of].radius);
                prop_assert!(disk.position.distance(disks[of].position) <= disks[of].radius);
            }
        }
    }
}
