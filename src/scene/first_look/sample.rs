//! Sample of a few thousand points that represents a frame, with a description of their neighbourhoods.
//!
//! **How it works.** Points of a frame are stored in Morton order, so points close in memory are close in space: the
//! distance to the neighbours of a point, and whether they lie in a plane, are estimated from the points around its
//! slot, without any search. Some neighbours are missed that way at borders of Morton cells; medians over hundreds of
//! places are robust to that.

use crate::cloud::Frame;
use crate::math::SymmetricMat3;
use crate::scene::style::luma;
use glam::Vec3;

/// Maximum number of points that represent a cloud; their statistics are within a per cent.
pub(super) const MAX_POINTS: usize = 1 << 14;
/// Slots to either side among which neighbours are looked for.
const SLOTS_AROUND: usize = 8;
/// The distance to this neighbour is the spacing: one or two may be duplicates or a pair of outliers.
const SPACING_NEIGHBOUR: usize = 4;

/// Distance to the nearest of randomly distributed points, in units of that to the spacing neighbour: √(ln 2/π) versus
/// √(3.67/π).
const RANDOM_SHARE: f32 = 0.43;

/// The widest gap between 10,000 points at random is a circle with the area of nine of them, √(9/π) = 1.7 times as wide
/// as the circle of one; the edges of disks weigh next to nothing.
const MAX_CLOSING: f32 = 2.4;
/// Number of sampled positions of [`typical_spacing`], which is queried during playback: their median is accurate to
/// within two per cent.
const SPACED_PLACES: usize = 1 << 12;
/// Places whose neighbourhoods are fitted by planes.
const PLACES: usize = 512;
/// Points in a row among which the neighbours of a place are looked for.
const RUN: usize = 64;
/// Neighbours that a plane is fitted to, the same number as for normals.
const NEIGHBOURS: usize = 12;

/// Points of a frame, taken evenly, and the distance from each to its surroundings.
#[derive(Debug, Clone, Default)]
pub(super) struct CloudSample {
    /// Relative to the sequence origin.
    pub(super) positions: Vec<Vec3>,
    /// Normals from the file, zero where it gave none; empty if it has none at all.
    pub(super) normals: Vec<Vec3>,
    /// To the fourth neighbour in the frame, scene units.
    pub(super) spacing: Vec<f32>,
    /// Share of places whose neighbours lie in a plane and spread in both of its directions.
    pub(super) planar_share: f32,
}

impl CloudSample {
    /// At most `max_points` of a frame.
    pub(super) fn of(frame: &Frame, max_points: usize) -> Self {
        let positions = frame.positions();
        // Neighbouring slots are close in space (Morton order), so no tree is built for spacing and planes.
        let slots = even_slots(positions.len(), max_points);
        Self {
            positions: slots.iter().map(|&slot| positions[slot]).collect(),
            normals: frame
                .normals()
                .map_or_else(Vec::new, |normals| slots.iter().map(|&slot| normals[slot]).collect()),
            spacing: slots.iter().map(|&slot| spacings_at(positions, slot).1).collect(),
            planar_share: planar_share(positions),
        }
    }

    /// Returns the median of all spacings; 0 without points.
    pub(super) fn median_spacing(&self) -> f32 {
        quantile(&mut self.spacing.clone(), 0.5)
    }

    /// Returns the ratio of the spacing of sparse points (the sparsest twentieth) to the median spacing.
    pub(super) fn spread(&self) -> f32 {
        let sparse = quantile(&mut self.spacing.clone(), 0.95);
        let median = self.median_spacing();
        if median > 0.0 { sparse / median } else { 1.0 }
    }

    /// The points at `retained`.
    pub(super) fn at(&self, retained: &[usize]) -> Self {
        let pick = |values: &[Vec3]| match values {
            [] => Vec::new(),
            values => retained.iter().map(|&index| values[index]).collect(),
        };
        Self {
            positions: pick(&self.positions),
            normals: pick(&self.normals),
            spacing: retained.iter().map(|&index| self.spacing[index]).collect(),
            planar_share: self.planar_share,
        }
    }
}

/// Luma of the colours of the file, 0 to 255, that half of the points are below; `None` without colours.
pub(super) fn median_luma(frame: &Frame) -> Option<f32> {
    let colors = frame.colors()?;
    let slots = even_slots(colors.len(), MAX_POINTS);
    let mut lumas: Vec<f32> = slots
        .iter()
        .map(|&slot| {
            let [red, green, blue, _] = colors[slot];
            luma([red, green, blue])
        })
        .collect();
    (!lumas.is_empty()).then(|| quantile(&mut lumas, 0.5))
}

/// Spacing of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointSpacing {
    /// Scene units; 0 without points.
    pub(crate) typical: f32,
    /// Disks as large as the area of a point close a surface if they are this many times as wide: 1 on a grid, more
    /// where points are at random.
    pub(crate) closing: f32,
}

/// Estimates the point spacing of a frame: the median over some thousand positions.
pub(crate) fn typical_spacing(frame: &Frame) -> PointSpacing {
    let positions = frame.positions();
    let slots = even_slots(positions.len(), SPACED_PLACES);
    let spacings = slots.iter().map(|&slot| spacings_at(positions, slot));
    let (mut nearest, mut further): (Vec<f32>, Vec<f32>) = spacings.unzip();
    let (nearest, typical) = (quantile(&mut nearest, 0.5), quantile(&mut further, 0.5));
    let share = if typical > 0.0 { nearest / typical } else { 1.0 };
    PointSpacing {
        typical,
        closing: 1.0 + (MAX_CLOSING - 1.0) * ((1.0 - share) / (1.0 - RANDOM_SHARE)).clamp(0.0, 1.0),
    }
}

/// Places of at most `max` of `count`, evenly.
fn even_slots(count: usize, max: usize) -> Vec<usize> {
    let taken = count.min(max);
    (0..taken).map(|index| (2 * index + 1) * count / (2 * taken)).collect()
}

/// The value below which `share` of the values are; 0 without values. They are put in another order.
pub(super) fn quantile(values: &mut [f32], share: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let last = values.len() - 1;
    let place = (share * last as f64).round() as usize;
    *values.select_nth_unstable_by(place.min(last), f32::total_cmp).1
}

/// Returns the distance to the nearest point, and to the one that determines the spacing; coincident points count as
/// one.
fn spacings_at(positions: &[Vec3], slot: usize) -> (f32, f32) {
    /// Slots to either side that are looked at where many are copies.
    const MAX_SLOTS: usize = 16 * SLOTS_AROUND;
    let squares = (1..=MAX_SLOTS)
        .flat_map(|step| [slot.checked_sub(step), slot.checked_add(step)])
        .filter_map(|other| Some(positions[slot].distance_squared(*positions.get(other?)?)))
        .filter(|&square| square > 0.0);
    let mut nearest = [f32::INFINITY; 2 * SLOTS_AROUND];
    let mut found = 0;
    for (place, square) in nearest.iter_mut().zip(squares) {
        *place = square;
        found += 1;
    }
    if found == 0 {
        return (0.0, 0.0);
    }
    let place = SPACING_NEIGHBOUR.min(found) - 1;
    let (nearer, further, _) = nearest[..found].select_nth_unstable_by(place, f32::total_cmp);
    let nearest = nearer.iter().copied().fold(*further, f32::min);
    (nearest.sqrt(), further.sqrt())
}

/// Share of places whose neighbours lie in a plane; 0 if there are too few points.
fn planar_share(positions: &[Vec3]) -> f32 {
    if positions.len() < RUN {
        return 0.0;
    }
    let starts = even_slots(positions.len() - RUN + 1, PLACES);
    let planar = starts.iter().filter(|&&start| is_planar(&run_at(positions, start)));
    planar.count() as f32 / starts.len() as f32
}

/// Places of a run that begins at a slot; copies stand together and are one.
fn run_at(positions: &[Vec3], start: usize) -> Vec<Vec3> {
    let mut run: Vec<Vec3> = Vec::with_capacity(RUN);
    for &position in positions[start..].iter().take(16 * RUN) {
        if run.last() != Some(&position) {
            run.push(position);
            if run.len() == RUN {
                break;
            }
        }
    }
    run
}

/// Returns true if the neighbours of the point at the centre of a run are planar, and not collinear as in a scan line.
fn is_planar(run: &[Vec3]) -> bool {
    /// Thickness and width as shares of the whole variance.
    const MAX_THICKNESS: f64 = 0.06;
    const MIN_WIDTH: f64 = 0.05;
    if run.len() <= NEIGHBOURS {
        return false;
    }
    let center = run[run.len() / 2];
    let mut near: Vec<Vec3> = run.iter().map(|&position| position - center).collect();
    near.select_nth_unstable_by(NEIGHBOURS, |a, b| a.length_squared().total_cmp(&b.length_squared()));
    let near = &near[..=NEIGHBOURS];
    let count = near.len() as f64;
    let mean = near.iter().map(|offset| offset.as_dvec3()).sum::<glam::DVec3>() / count;
    let mut matrix = SymmetricMat3::default();
    for offset in near {
        let offset = offset.as_dvec3() - mean;
        matrix.xx += offset.x * offset.x;
        matrix.xy += offset.x * offset.y;
        matrix.xz += offset.x * offset.z;
        matrix.yy += offset.y * offset.y;
        matrix.yz += offset.y * offset.z;
        matrix.zz += offset.z * offset.z;
    }
    let [thickness, width, length] = matrix.eigen().values;
    let whole = thickness + width + length;
    whole > 0.0 && thickness <= MAX_THICKNESS * whole && width >= MIN_WIDTH * whole
}
