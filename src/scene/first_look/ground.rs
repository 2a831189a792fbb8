//! The up axis of clouds that do not stand on zero or on a broad base: maps, terrain, trees.
//!
//! **How it works.** Each rule looks at one thing that gravity or surveying makes:
//!
//! - *Map coordinates.* Eastings and northings are large numbers, elevations are not.
//! - *A narrow foot.* Trees and tables are narrow where they stand; the other end is not, nor are the other axes.
//! - *Undersides alone.* What faces down is seldom all that was scanned: a camera that looks along +Z saw it.
//! - *A height field.* Seen from an aircraft or a drone the ground has one height at each place, though hills may rise
//!   as high as the map is wide.

use super::sample::{CloudSample, quantile};
use super::up::{Up, along};
use crate::math::Aabb;
use crate::scene::UpAxis;
use glam::Vec3;

/// Cells along an edge of a footprint.
const GRID: usize = 24;

/// The axis with small coordinates where the two others are those of a map. `zero` is the zero of the file.
pub(super) fn of_map_coordinates(bounds: &Aabb, zero: Vec3) -> Option<Up> {
    /// Eastings have six digits, northings six or seven; no summit is higher than 9 km.
    const MIN_MAP: f32 = 5e4;
    const MAX_ELEVATION: f32 = 9e3;
    let center = bounds.center() - zero;
    let extent = bounds.extent().max_element();
    let is_map = |axis: usize| center[axis].abs() >= MIN_MAP && center[axis].abs() >= 4.0 * extent;
    let is_elevation = |axis: usize| center[axis].abs() <= MAX_ELEVATION;
    let up = (0..3).find(|&axis| is_elevation(axis) && (0..3).all(|other| other == axis || is_map(other)))?;
    Some(Up::by_points(
        along(up, true),
        "the two other axes are coordinates of a map",
    ))
}

/// The axes of a camera, where the normals of the file say that everything faces -Z: with Z up that would be a ceiling.
pub(super) fn of_undersides(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Shares of normals within 60° of -Z and of +Z.
    const LEAST_BELOW: f32 = 0.6;
    const MOST_ABOVE: f32 = 0.03;
    let share = |is_meant: fn(&Vec3) -> bool| {
        let count = sample.normals.iter().filter(|normal| is_meant(normal)).count();
        count as f32 / sample.normals.len().max(1) as f32
    };
    let faces_camera = share(|normal| normal.z < -0.5) >= LEAST_BELOW && share(|normal| normal.z > 0.5) <= MOST_ABOVE;
    // A map whose heights are counted downwards faces there as well.
    (faces_camera && !bounds.is_flat_along_z()).then(|| {
        Up::by_points(
            UpAxis::NegY,
            "what was scanned faces -Z, towards a camera that looks along +Z: Y is down",
        )
    })
}

/// Things that stand on a narrow foot along Y or Z, such as a trunk.
pub(super) fn of_narrow_foot(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Footprint of the foot, as a share of that of the whole.
    const NARROW: f32 = 0.12;
    /// The other end is so many times as broad as the foot.
    const BROADER: f32 = 2.5;
    /// The foot is this share of the height.
    const FOOT: f64 = 0.12;
    let extent = bounds.extent();
    let mut found = None;
    for axis in [1, 2] {
        if extent[axis] < 0.4 * extent.max_element() {
            continue;
        }
        let ends = [true, false].map(|is_low| footprint_of_end(sample, bounds, (axis, is_low), FOOT));
        for (is_low, [foot, head]) in [(true, ends), (false, [ends[1], ends[0]])] {
            let is_narrow = foot > 0.0 && foot <= NARROW && head >= BROADER * foot;
            if is_narrow && is_below_the_middle(sample, bounds, (axis, is_low), FOOT) {
                // Two narrow ends along different axes say nothing.
                if found.is_some() {
                    return None;
                }
                found = Some(Up::by_points(along(axis, is_low), "it stands on a narrow foot"));
            }
        }
    }
    found
}

/// True if the points near one end are around the middle of the footprint: an arm that sticks out is no foot.
fn is_below_the_middle(sample: &CloudSample, bounds: &Aabb, (axis, is_low): (usize, bool), share: f64) -> bool {
    const MAX_ASIDE: f32 = 0.25;
    let extent = bounds.extent().max(Vec3::splat(f32::MIN_POSITIVE));
    let edge = if is_low { bounds.min[axis] } else { bounds.max[axis] };
    let depth = share as f32 * extent[axis];
    let foot = sample
        .positions
        .iter()
        .filter(|position| (position[axis] - edge).abs() <= depth);
    let (sum, count) = foot.fold((Vec3::ZERO, 0.0), |(sum, count), &position| {
        (sum + position, count + 1.0)
    });
    let aside = (sum / f32::max(count, 1.0) - bounds.center()) / extent;
    (0..3).all(|other| other == axis || aside[other].abs() <= MAX_ASIDE)
}

/// Share of the cells under the cloud along `axis` that the points near one end cover.
fn footprint_of_end(sample: &CloudSample, bounds: &Aabb, (axis, is_low): (usize, bool), share: f64) -> f32 {
    let extent = bounds.extent();
    let edge = if is_low { bounds.min[axis] } else { bounds.max[axis] };
    let depth = share as f32 * extent[axis];
    let mut all = [false; GRID * GRID];
    let mut end = [false; GRID * GRID];
    for &position in &sample.positions {
        let cell = cell_of(position, bounds, axis);
        all[cell] = true;
        end[cell] |= (position[axis] - edge).abs() <= depth;
    }
    let count = |cells: &[bool]| cells.iter().filter(|&&is_met| is_met).count() as f32;
    count(&end) / count(&all).max(1.0)
}

fn cell_of(position: Vec3, bounds: &Aabb, axis: usize) -> usize {
    let extent = bounds.extent().max(Vec3::splat(f32::MIN_POSITIVE));
    let place = (position - bounds.min) / extent * (GRID as f32 - 0.01);
    let place = |axis: usize| (place[axis].max(0.0) as usize).min(GRID - 1);
    place((axis + 1) % 3) * GRID + place((axis + 2) % 3)
}

/// Ground seen from above, in the axes of maps: facades are height fields along the others.
pub(super) fn of_height_field(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Thickness within a cell, as a share of the extent: along the height of a field, and beside the other axes.
    const THIN: f32 = 0.3;
    const THINNER: f32 = 0.5;
    /// Height as a share of the narrower side; a face that was scanned from the front is deeper.
    const LOW: f32 = 0.5;
    let extent = bounds.extent();
    if extent.z > LOW * extent.truncate().min_element() {
        return None;
    }
    let [x, y, z] = [0, 1, 2].map(|axis| thickness(sample, bounds, axis));
    (z <= THIN && z <= THINNER * x.min(y))
        .then(|| Up::by_points(UpAxis::Z, "it has one height at each place, as ground seen from above"))
}

/// Median extent of the points over a cell of the footprint along `axis`, as a share of that of all.
fn thickness(sample: &CloudSample, bounds: &Aabb, axis: usize) -> f32 {
    const MIN_POINTS: usize = 4;
    let mut cells: Vec<Vec<f32>> = vec![Vec::new(); GRID * GRID];
    for &position in &sample.positions {
        cells[cell_of(position, bounds, axis)].push(position[axis]);
    }
    let of_cell = |cell: &mut Vec<f32>| quantile(cell, 0.9) - quantile(cell, 0.1);
    let dense = cells.iter_mut().filter(|cell| cell.len() >= MIN_POINTS);
    let mut thicknesses: Vec<f32> = dense.map(of_cell).collect();
    quantile(&mut thicknesses, 0.5) / bounds.extent()[axis].max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(points: Vec<Vec3>) -> (CloudSample, Aabb) {
        let bounds = Aabb::from_points(&points);
        let spacing = vec![0.1; points.len()];
        let sample = CloudSample {
            positions: points,
            spacing,
            ..CloudSample::default()
        };
        (sample, bounds)
    }

    /// Numbers from 0 to 1 that look random, the same each time.
    fn numbers(count: usize) -> impl Iterator<Item = [f32; 3]> {
        let fraction = |value: f64| value.fract() as f32;
        let step = |index: usize| index as f64 + 0.5;
        (0..count).map(move |index| [0.618_034, 0.754_878, 0.569_840].map(|ratio| fraction(ratio * step(index))))
    }

    /// All ways to put what stands along Z.
    fn turned(points: &[Vec3]) -> Vec<(UpAxis, Vec<Vec3>)> {
        let turn = |up: UpAxis, turn: fn(Vec3) -> Vec3| (up, points.iter().map(|&point| turn(point)).collect());
        vec![
            turn(UpAxis::Z, |p| p),
            turn(UpAxis::NegZ, |p| Vec3::new(p.x, -p.y, -p.z)),
            turn(UpAxis::Y, |p| Vec3::new(p.x, p.z, -p.y)),
            turn(UpAxis::NegY, |p| Vec3::new(p.x, -p.z, p.y)),
        ]
    }

    #[test]
    fn a_tree_stands_on_its_trunk() {
        let tree: Vec<Vec3> = numbers(8000)
            .enumerate()
            .map(|(index, [a, b, c])| {
                let turn = std::f32::consts::TAU * a;
                let (radius, height) = if index % 5 == 0 {
                    (0.15, 4.0 * b)
                } else {
                    (
                        2.5 * (std::f32::consts::PI * (0.15 + 0.8 * b)).sin() * c.sqrt(),
                        4.0 + 6.0 * b,
                    )
                };
                Vec3::new(radius * turn.cos(), radius * turn.sin(), height)
            })
            .collect();
        for (up, points) in turned(&tree) {
            let (sample, bounds) = sample(points);
            assert_eq!(of_narrow_foot(&sample, &bounds).map(|up| up.axis), Some(up));
        }
    }

    #[test]
    fn balls_cubes_and_poles_have_no_foot() {
        let ball = numbers(6000).map(|[a, b, c]| Vec3::new(a - 0.5, b - 0.5, c - 0.5).normalize_or_zero());
        let cube = numbers(6000).map(|[a, b, c]| Vec3::new(a, b, c));
        let pole = numbers(6000).map(|[a, b, c]| Vec3::new(0.1 * a, 0.1 * b, 5.0 * c));
        for points in [ball.collect::<Vec<_>>(), cube.collect(), pole.collect()] {
            let (sample, bounds) = sample(points);
            assert_eq!(of_narrow_foot(&sample, &bounds), None);
        }
    }

    #[test]
    fn a_wall_that_faces_a_camera_has_y_down() {
        let wall: Vec<Vec3> = numbers(4000)
            .map(|[a, b, c]| Vec3::new(3.0 * a, 2.0 * b, 2.0 + 0.8 * c))
            .collect();
        let (mut sample, bounds) = sample(wall);
        assert_eq!(of_undersides(&sample, &bounds), None, "without normals");
        let up = |sample: &CloudSample| of_undersides(sample, &bounds).map(|up| up.axis);
        let front = |index: usize| if index.is_multiple_of(4) { Vec3::X } else { Vec3::NEG_Z };
        sample.normals = (0..4000).map(front).collect();
        assert_eq!(up(&sample), Some(UpAxis::NegY));
        sample.normals.iter_mut().for_each(|normal| *normal = -*normal);
        assert_eq!(up(&sample), None, "ground seen from above");
        let both = |index: usize| if index.is_multiple_of(8) { Vec3::Z } else { Vec3::NEG_Z };
        sample.normals = (0..4000).map(both).collect();
        assert_eq!(up(&sample), None, "seen from both sides");
    }

    #[test]
    fn hills_are_a_height_field_along_z_alone() {
        let hills: Vec<Vec3> = numbers(8000)
            .map(|[a, b, _]| Vec3::new(150.0 * a, 170.0 * b, 12.0 * (10.0 * a).sin() + 10.0 * (9.0 * b).cos()))
            .collect();
        let (all, bounds) = sample(hills.clone());
        assert_eq!(of_height_field(&all, &bounds).map(|up| up.axis), Some(UpAxis::Z));
        let facade: Vec<Vec3> = hills.iter().map(|p| Vec3::new(p.x, p.z, p.y)).collect();
        let (facade, bounds) = sample(facade);
        assert_eq!(of_height_field(&facade, &bounds), None);
    }

    #[test]
    fn elevations_are_small_where_the_others_are_of_a_map() {
        let bounds = Aabb::from_points(&[Vec3::ZERO, Vec3::new(200.0, 150.0, 30.0)]);
        let up = |zero: Vec3| of_map_coordinates(&bounds, zero).map(|up| up.axis);
        assert_eq!(up(Vec3::new(-431_000.0, -4_581_000.0, -120.0)), Some(UpAxis::Z));
        assert_eq!(up(Vec3::new(-431_000.0, -120.0, 4_581_000.0)), Some(UpAxis::Y));
        assert_eq!(up(Vec3::ZERO), None);
        assert_eq!(up(Vec3::splat(-4e6)), None, "geocentric");
    }
}
