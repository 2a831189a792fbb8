//! Up-axis estimation from shape alone: the effect of gravity on trees, people, buildings and ground.
//!
//! **How it works.** Each rule examines one property:
//!
//! - *A slender object* stands: trees, poles, people.
//! - *Symmetry.* Objects are alike on two sides, mostly left and right, and never above and below: of Y and Z, the axis
//!   along which a cloud is less like its mirror image is up.
//! - *A height field.* Seen from an aircraft or a drone the ground has one height at each position.
//!
//! None of them determines which end is up: it is the positive one. Rules that tried (crowns and ears are narrower than
//! their support) put as many clouds upside down as upright.

use super::sample::{CloudSample, quantile};
use super::up::{Up, along};
use crate::math::Aabb;
use glam::Vec3;

/// The axes that are up in files.
const USUAL_AXES: [usize; 2] = [1, 2];

/// Guesses the up axis of an object that is much longer along Y or Z than along both other axes.
pub(super) fn of_slender(bounds: &Aabb) -> Option<Up> {
    const LONGER: f32 = 2.5;
    let extent = bounds.extent();
    let axis = USUAL_AXES.into_iter().find(|&axis| {
        let others = extent[(axis + 1) % 3].max(extent[(axis + 2) % 3]);
        others > 0.0 && extent[axis] >= LONGER * others
    })?;
    Some(Up::by_points(along(axis, true), "it is tall and slender"))
}

/// Evidence from symmetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Symmetry {
    pub(super) up: Up,
    /// True if it is more reliable than the convention of a format.
    pub(super) is_strong: bool,
}

/// Guesses the up axis of an object that is symmetric along one of Y and Z, and less so along the other.
pub(super) fn of_symmetry(sample: &CloudSample, bounds: &Aabb) -> Option<Symmetry> {
    /// Minimum asymmetry ratio: how many times as unlike its mirror image a cloud is along the up axis.
    const MORE: f32 = 1.3;
    const MUCH_MORE: f32 = 2.0;
    /// Noise alone makes it so unlike.
    const NOISE: f32 = 0.25;
    /// Walls and floors are alike along their edges whichever way they stand.
    const PLATE: f32 = 0.3;
    /// Fewer points are unlike their mirror image by chance.
    const MIN_POINTS: usize = 500;
    if sample.positions.len() < MIN_POINTS {
        return None;
    }
    let [y, z] = USUAL_AXES.map(|axis| asymmetry(sample, axis));
    let axis = match () {
        () if y.max(z) < NOISE => return None,
        () if z >= MORE * y => 2,
        () if y >= MORE * z => 1,
        () => return None,
    };
    let why = "it is symmetric along the other axis, and things are not alike above and below";
    let extent = bounds.extent();
    let narrower = extent[(axis + 1) % 3].min(extent[(axis + 2) % 3]);
    Some(Symmetry {
        up: Up::by_points(along(axis, true), why),
        is_strong: y.max(z) >= MUCH_MORE * y.min(z) && extent[axis] >= PLATE * narrower,
    })
}

/// Returns the asymmetry of a cloud along an axis: the fraction of it that has no mirrored counterpart, 0 to 1, in
/// cells of a tenth of its size.
fn asymmetry(sample: &CloudSample, axis: usize) -> f32 {
    const CELLS: usize = 10;
    /// Ends that a few points may reach.
    const TAIL: f64 = 0.005;
    let range = |axis: usize| {
        let mut values: Vec<f32> = sample.positions.iter().map(|position| position[axis]).collect();
        (quantile(&mut values, TAIL), quantile(&mut values, 1.0 - TAIL))
    };
    let ranges = [0, 1, 2].map(range);
    let place = |position: Vec3, axis: usize| {
        let (low, high) = ranges[axis];
        let share = (position[axis] - low) / (high - low).max(f32::MIN_POSITIVE);
        ((share * CELLS as f32).max(0.0) as usize).min(CELLS - 1)
    };
    let strides = [1, CELLS, CELLS * CELLS];
    let mut counts = vec![0.0f32; CELLS * CELLS * CELLS];
    for &position in &sample.positions {
        let cell: usize = (0..3).map(|axis| strides[axis] * place(position, axis)).sum();
        counts[cell] += 1.0;
    }
    // Square roots: otherwise a dense part would dominate.
    for count in &mut counts {
        *count = count.sqrt();
    }
    let sum: f32 = counts.iter().sum();
    let mirrored = |cell: usize| {
        let place = cell / strides[axis] % CELLS;
        cell - place * strides[axis] + (CELLS - 1 - place) * strides[axis]
    };
    let differences = (0..counts.len()).map(|cell| (counts[cell] - counts[mirrored(cell)]).abs());
    0.5 * differences.sum::<f32>() / sum.max(f32::MIN_POSITIVE)
}

/// Cells along an edge of a footprint.
const GRID: usize = 24;

/// Guesses the up axis of a height field, ground seen from above. Low relief is typical of maps, whose height is Z:
/// facades are height fields along the other axes. Deep relief that fills its whole footprint, and nothing else, is a
/// mountain along either axis.
pub(super) fn of_height_field(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Maximum thickness within a cell, as a fraction of the extent: along the height of a field, and compared with the
    /// other axes.
    const THIN: f32 = 0.3;
    const THINNER: f32 = 0.7;
    /// Height as a share of the narrower side; a face that was scanned from the front is deeper.
    const LOW: f32 = 0.5;
    /// Maximum thickness within a cell for deep relief, and the fractions of their footprints that it and the others
    /// fill.
    const THINNEST: f32 = 0.1;
    const FULL: f32 = 0.95;
    const EMPTY: f32 = 0.75;
    let extent = bounds.extent();
    let fields = [0, 1, 2].map(|axis| Footprint::of(sample, bounds, axis));
    let [x, y, z] = &fields;
    let is_low = extent.z <= LOW * extent.truncate().min_element();
    if is_low && z.thickness <= THIN && z.thickness <= THINNER * x.thickness.min(y.thickness) {
        return Some(Up::by_points(
            along(2, true),
            "it has one height at each place, as ground seen from above",
        ));
    }
    let axis = USUAL_AXES.into_iter().rev().find(|&axis| {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        fields[axis].filled >= FULL
            && fields[axis].thickness <= THINNEST
            && others.into_iter().all(|other| fields[other].filled <= EMPTY)
    })?;
    Some(Up::by_points(
        along(axis, true),
        "it has one height at each place, as mountains seen from above",
    ))
}

/// Footprint of the cloud, as seen along an axis.
struct Footprint {
    /// Median extent of the points over a cell along the axis, as a share of the extent of all.
    thickness: f32,
    /// Share of the cells of the box that have points.
    filled: f32,
}

impl Footprint {
    fn of(sample: &CloudSample, bounds: &Aabb, axis: usize) -> Self {
        const MIN_POINTS: usize = 4;
        let extent = bounds.extent().max(Vec3::splat(f32::MIN_POSITIVE));
        let mut cells: Vec<Vec<f32>> = vec![Vec::new(); GRID * GRID];
        for &position in &sample.positions {
            let place = (position - bounds.min) / extent * (GRID as f32 - 0.01);
            let place = |axis: usize| (place[axis].max(0.0) as usize).min(GRID - 1);
            cells[place((axis + 1) % 3) * GRID + place((axis + 2) % 3)].push(position[axis]);
        }
        let filled = cells.iter().filter(|cell| !cell.is_empty()).count() as f32 / cells.len() as f32;
        let of_cell = |cell: &mut Vec<f32>| quantile(cell, 0.9) - quantile(cell, 0.1);
        let dense = cells.iter_mut().filter(|cell| cell.len() >= MIN_POINTS);
        let mut thicknesses: Vec<f32> = dense.map(of_cell).collect();
        Self {
            thickness: quantile(&mut thicknesses, 0.5) / extent[axis],
            filled,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_clouds::{numbers, sample, turned};
    use super::*;
    use crate::scene::UpAxis;
    use std::f32::consts::TAU;

    fn tree() -> Vec<Vec3> {
        let of_trunk = |[a, b, _]: [f32; 3]| (0.15, 4.0 * b, a);
        let of_crown = |[a, b, c]: [f32; 3]| {
            let radius = 2.5 * (std::f32::consts::PI * (0.15 + 0.8 * b)).sin() * c.sqrt();
            (radius, 4.0 + 6.0 * b, a)
        };
        let place = |(index, numbers): (usize, [f32; 3])| {
            let (radius, height, turn) = if index.is_multiple_of(5) {
                of_trunk(numbers)
            } else {
                of_crown(numbers)
            };
            Vec3::new(radius * (TAU * turn).cos(), radius * (TAU * turn).sin(), height)
        };
        numbers(8000).enumerate().map(place).collect()
    }

    #[test]
    fn a_tree_is_round_with_different_top_and_bottom() {
        for (up, points) in turned(&tree()) {
            let (sample, bounds) = sample(points);
            let found = of_symmetry(&sample, &bounds).unwrap();
            assert_eq!((found.up.axis, found.is_strong), (up, true));
        }
    }

    #[test]
    fn balls_and_cubes_have_no_up_axis() {
        let ball = numbers(6000).map(|[a, b, c]| Vec3::new(a - 0.5, b - 0.5, c - 0.5).normalize_or_zero());
        let cube = numbers(6000).map(|[a, b, c]| Vec3::new(a, b, c));
        for points in [ball.collect::<Vec<_>>(), cube.collect()] {
            let (sample, bounds) = sample(points);
            assert_eq!(of_symmetry(&sample, &bounds), None);
            assert_eq!(of_slender(&bounds), None);
            assert_eq!(of_height_field(&sample, &bounds), None);
        }
    }

    #[test]
    fn poles_are_slender() {
        let pole: Vec<Vec3> = numbers(600)
            .map(|[a, b, c]| Vec3::new(0.1 * a, 0.1 * b, 5.0 * c))
            .collect();
        for (up, points) in turned(&pole) {
            assert_eq!(of_slender(&sample(points).1).map(|up| up.axis), Some(up));
        }
        assert_eq!(of_slender(&Aabb::from_points(&[Vec3::ONE])), None);
    }

    /// Relief of a plain of 150 × 170 metres.
    fn hills(height: f32) -> Vec<Vec3> {
        let place = |[a, b, _]: [f32; 3]| {
            Vec3::new(
                150.0 * a,
                170.0 * b,
                height * ((3.0 * a).sin() + (2.5 * b).cos() + 0.2 * (9.0 * a).sin()),
            )
        };
        numbers(12_000).map(place).collect()
    }

    #[test]
    fn low_hills_are_a_height_field_along_z_alone() {
        let (all, bounds) = sample(hills(12.0));
        assert_eq!(of_height_field(&all, &bounds).map(|up| up.axis), Some(UpAxis::Z));
        let facade: Vec<Vec3> = hills(12.0).iter().map(|p| Vec3::new(p.x, p.z, 0.4 * p.y)).collect();
        let (facade, bounds) = sample(facade);
        assert_ne!(of_height_field(&facade, &bounds).map(|up| up.axis), Some(UpAxis::Z));
    }

    #[test]
    fn mountains_are_a_height_field_along_either_axis() {
        for (up, points) in turned(&hills(70.0)) {
            let (sample, bounds) = sample(points);
            assert_eq!(of_height_field(&sample, &bounds).map(|up| up.axis), Some(up));
        }
    }
}
