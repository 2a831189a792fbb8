//! Up-axis estimation from how objects stand, where neither the format nor the sensor defines it.

use super::sample::{CloudSample, quantile};
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

    /// The up axis by the distribution of the points.
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

/// Models stand on the plane through zero: one end of one axis is there, and zero is well within the others.
pub(super) fn on_zero(bounds: &Aabb, zero: Vec3) -> Option<Up> {
    /// Tolerance as a fraction of the extent: how close to zero the end is, and how far within the others it is.
    const NEAR: f32 = 0.03;
    const WITHIN: f32 = 0.2;
    let extent = bounds.extent();
    let place = (zero - bounds.min) / extent;
    let is_within = |axis: usize| (WITHIN..=1.0 - WITHIN).contains(&place[axis]);
    let mut found = None;
    // A minimal height means nothing: for a flat cloud the centre is at both of its ends.
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

/// Things stand on broad, flat bases: a large share of one side lies in one plane. Upside down, that has to be as broad
/// as the cloud: crowns of trees are flat above as well.
pub(super) fn on_base(sample: &CloudSample, bounds: &Aabb) -> Option<Up> {
    /// Share of the footprint that a base covers, and its ratio to the other side's.
    const BASE: f32 = 0.15;
    const BROADER: f32 = 5.0;
    /// Threshold for a base above, as a fraction of the box as well.
    const BASE_ABOVE: f32 = 0.5;
    const BROADER_ABOVE: f32 = 8.0;
    let mut bases = [1, 2].into_iter().filter_map(|axis| {
        let [low, high] = [true, false].map(|is_low| contact(sample, bounds, axis, is_low));
        let is_above = high.of_footprint.min(high.of_box) >= BASE_ABOVE;
        if low.of_footprint >= BASE && low.of_footprint >= BROADER * high.of_footprint {
            Some(along(axis, true))
        } else if is_above && high.of_footprint >= BROADER_ABOVE * low.of_footprint {
            Some(along(axis, false))
        } else {
            None
        }
    });
    let base = bases.next()?;
    // Two bases indicate a box, a room or chance.
    let is_alone = bases.next().is_none();
    is_alone.then(|| Up::by_points(base, "it stands on a flat base"))
}

/// Contact area at one end of the cloud.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    /// Share of the cells that have points.
    of_footprint: f32,
    /// Share of all cells of the box.
    of_box: f32,
}

/// Cells along an edge of the grid that footprints are counted in.
const GRID: usize = 32;

/// Returns the fraction of the footprint along `axis` that lies at the low or the high end.
fn contact(sample: &CloudSample, bounds: &Aabb, axis: usize, is_low: bool) -> Contact {
    const THICKNESS: f32 = 0.03;
    let extent = bounds.extent();
    if extent[axis] < 0.2 * extent.max_element() {
        return Contact::default();
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
    Contact {
        of_footprint: count(&base) / count(&footprint).max(1.0),
        of_box: count(&base) / base.len() as f32,
    }
}
