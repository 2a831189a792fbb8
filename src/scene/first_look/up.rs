//! Which axis is up, where neither the format nor the sensor says so: from how things stand.

use super::sample::{CloudSample, quantile};
use super::trim;
use crate::assumption::Evidence;
use crate::math::Aabb;
use crate::scene::UpAxis;
use glam::Vec3;

/// An up axis with its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Up {
    pub(super) axis: UpAxis,
    pub(super) why: &'static str,
    pub(super) evidence: Evidence,
}

impl Up {
    pub(super) fn new(axis: UpAxis, why: &'static str, evidence: Evidence) -> Self {
        Self { axis, why, evidence }
    }

    /// True if the other is along the same axis, upside down.
    pub(super) fn is_opposite(self, other: Self) -> bool {
        self.axis.direction() == -other.axis.direction()
    }

    /// By how the points lie.
    pub(super) fn by_points(axis: UpAxis, why: &'static str) -> Self {
        Self::new(axis, why, Evidence::Statistics)
    }
}

/// The up axis along coordinate `axis`.
pub(super) fn along(axis: usize, is_positive: bool) -> UpAxis {
    match (axis, is_positive) {
        (0, true) => UpAxis::X,
        (0, false) => UpAxis::NegX,
        (1, true) => UpAxis::Y,
        (1, false) => UpAxis::NegY,
        (_, true) => UpAxis::Z,
        (_, false) => UpAxis::NegZ,
    }
}

/// The up axis told by the points alone; `zero` is where the zero of the file is.
pub(super) fn of_standing(sample: &CloudSample, zero: Vec3) -> Option<Up> {
    let bounds = trim::bounds(sample);
    on_zero(&bounds, zero).or_else(|| on_base(sample, &bounds))
}

/// Models stand on the plane through zero: one end of one axis is there, and zero is well within the others.
fn on_zero(bounds: &Aabb, zero: Vec3) -> Option<Up> {
    /// Of the extent: how near the end is to zero, and how far within the others it is.
    const NEAR: f32 = 0.03;
    const WITHIN: f32 = 0.2;
    let extent = bounds.extent();
    let place = (zero - bounds.min) / extent;
    let is_within = |axis: usize| (WITHIN..=1.0 - WITHIN).contains(&place[axis]);
    let mut found = None;
    // A trace of height says nothing: the middle of a flat cloud is both of its ends.
    let tall_enough = |axis: usize| extent[axis] >= 0.1 * extent.max_element();
    for axis in [1, 2] {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        if !others.into_iter().all(is_within) || !tall_enough(axis) {
            continue;
        }
        let guess = if place[axis].abs() <= NEAR {
            Some(Up::by_points(along(axis, true), "it stands on the plane through zero"))
        } else if (place[axis] - 1.0).abs() <= NEAR {
            Some(Up::by_points(
                along(axis, false),
                "it hangs below the plane through zero",
            ))
        } else {
            None
        };
        found = found.or(guess);
    }
    found
}

/// Things stand on what is broad and flat: of one of the six sides a large share lies in one plane.
fn on_base(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Share of the footprint that a base covers: along Y and Z, and along the axes that are hardly ever up.
    const BASE: [f32; 2] = [0.15, 0.35];
    /// A base covers so many times what the side above it does.
    const BROADER: f32 = 5.0;
    let contact = |axis: usize, is_low: bool| contact(sample, bounds, axis, is_low);
    let mut bases = (0..3).flat_map(|axis| {
        let sides = [true, false].map(|is_low| contact(axis, is_low));
        [true, false]
            .into_iter()
            .filter(move |&is_low| {
                let [base, top] = if is_low { sides } else { [sides[1], sides[0]] };
                let is_usual = axis > 0 && is_low;
                base >= BASE[usize::from(!is_usual)] && base >= BROADER * top
            })
            .map(move |is_low| Up::by_points(along(axis, is_low), "it stands on a flat base"))
    });
    let base = bases.next()?;
    // Two bases are a box, a room or chance.
    bases.next().is_none().then_some(base)
}

/// Cells along an edge of the grid that footprints are counted in.
const GRID: usize = 32;

/// The share of the footprint along `axis` that lies at the low or the high end.
fn contact(sample: &CloudSample, bounds: &Aabb, axis: usize, is_low: bool) -> f32 {
    const THICKNESS: f32 = 0.03;
    let extent = bounds.extent();
    if extent[axis] < 0.2 * extent.max_element() {
        return 0.0;
    }
    let mut heights: Vec<f32> = sample.positions.iter().map(|p| p[axis]).collect();
    // A thousandth may be noise below the ground.
    let end = quantile(&mut heights, if is_low { 0.001 } else { 0.999 });
    let (right, forward) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut footprint = [false; GRID * GRID];
    let mut base = [false; GRID * GRID];
    for &position in &sample.positions {
        let place = (position - bounds.min) / extent * (GRID as f32 - 0.01);
        let cell = place[right].max(0.0) as usize * GRID + place[forward].max(0.0) as usize;
        let cell = cell.min(GRID * GRID - 1);
        footprint[cell] = true;
        if (position[axis] - end).abs() <= THICKNESS * extent[axis] {
            base[cell] = true;
        }
    }
    let count = |cells: &[bool]| cells.iter().filter(|&&is_met| is_met).count() as f32;
    count(&base) / count(&footprint).max(1.0)
}
