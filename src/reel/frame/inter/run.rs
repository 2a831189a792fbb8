//! Encoder state for frames that follow a key frame: which points belong to which node, and where they are now.

use super::super::levels::{LevelValues, Pose};
use super::super::prepare::GroupPlan;
use super::super::schema::Schema;
use super::super::summaries::{PointValues, children};
use super::changes::{Changes, LevelChanges};
use super::followed::Followed;
use super::{MAX_CHANGE, MAX_POSITION_BITS, motion_scale, part_bits};
use crate::cloud::RawCloud;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Run of frames that are encoded relative to a key frame.
#[derive(Debug)]
pub(in crate::reel) struct Run<'a> {
    plan: &'a GroupPlan,
    schema: &'a Schema,
    /// The points of the key frame in the order of its nodes.
    order: &'a [u32],
    /// Point ranges of each node of the deepest level.
    nodes: Vec<Range<usize>>,
    masks: Vec<Vec<u8>>,
    /// From the mean of the points of a node to its decoded position in the key frame, in parts; empty for individually
    /// stored points.
    anchors: Vec<DVec3>,
    /// Target positions of the finest nodes in the frame that is followed, in parts.
    truth: Vec<DVec3>,
    /// Codes of radii that reach over the node, and over the largest disk in it.
    radii: Option<(Vec<[u16; 1]>, Vec<u16>)>,
    parts_per_unit: f64,
}

impl<'a> Run<'a> {
    /// The run after frame `index` of a group, which is `cloud` and decodes to `pose` and `followed`.
    pub(in crate::reel) fn new(
        plan: &'a GroupPlan,
        index: usize,
        cloud: &RawCloud,
        pose: &Pose,
        followed: &Followed,
    ) -> Option<Self> {
        let schema = &plan.schemas[index];
        let part_bits = part_bits(schema, &plan.grid)?;
        let (_, nodes) = plan.nodes(index);
        let order = plan.order(index);
        let deepest = pose.levels.last()?;
        let radii = schema.radius_single().map(|single| {
            let largest = PointValues::new(schema, &plan.grid, cloud).largest_radii(&nodes, order);
            (deepest.values.singles[single].clone(), largest)
        });
        let mut run = Self {
            plan,
            schema,
            order,
            nodes,
            masks: pose.levels.iter().map(|level| level.masks.clone()).collect(),
            anchors: Vec::new(),
            truth: Vec::new(),
            radii,
            parts_per_unit: f64::from(1u32 << part_bits) / plan.grid.cell,
        };
        if !followed.has_points {
            let means = means(cloud, &run.nodes, run.order);
            let anchor = |(position, mean): (&[i32; 3], DVec3)| {
                DVec3::from_array(position.map(f64::from)) - (mean - plan.grid.min) * run.parts_per_unit
            };
            // The offset of a node from the mean of its points in the key frame is retained, so that the pattern of
            // points moves with the surface and nothing flickers.
            run.anchors = followed
                .levels
                .last()?
                .positions
                .iter()
                .zip(means)
                .map(anchor)
                .collect();
        }
        run.truth = run.truth_of(cloud);
        Some(run)
    }

    /// Computes the changes of frame `index` of the group relative to the one that is followed; `None` if its nodes
    /// move too far.
    pub(in crate::reel) fn changes(&mut self, index: usize, cloud: &RawCloud, followed: &Followed) -> Option<Changes> {
        let depth = self.plan.grid.depth as usize;
        let finest = followed.levels.last()?;
        let truth = self.truth_of(cloud);
        let is_near = |place: &DVec3| place.abs().max_element() < f64::from(1 << MAX_POSITION_BITS);
        if !truth.iter().all(is_near) {
            return None;
        }
        let nodes = truth.iter().zip(&self.truth).zip(&finest.positions).enumerate();
        let step = |(node, ((&now, &before), &position)): (usize, ((&DVec3, &DVec3), &[i32; 3]))| {
            let position = DVec3::from_array(position.map(f64::from));
            let tolerance = self.tolerance(index, node);
            let is_off = (position - before).abs().cmpgt(DVec3::splat(tolerance));
            let from = DVec3::select(is_off, position, before);
            (now - from).round().to_array().map(|along| along as i32)
        };
        let mut steps = vec![Vec::new(); followed.levels.len()];
        *steps.last_mut()? = nodes.map(step).collect();
        if followed.has_points {
            steps[depth] = mean_steps(&steps[depth + 1], &self.nodes);
        }
        for level in (0..depth).rev() {
            steps[level] = mean_steps(&steps[level + 1], &children(&self.masks[level]));
        }
        self.truth = truth;
        let can_be_told = |along: &i32| along.abs() <= MAX_CHANGE;
        if !steps.iter().flatten().flatten().all(can_be_told) {
            return None;
        }
        let values = self.values(cloud, followed.has_points);
        let levels = followed.levels.iter().zip(values).zip(steps);
        let levels = levels.map(|((before, (values, directions)), steps)| {
            LevelChanges::between(&before.values, values, directions, steps)
        });
        Some(Changes {
            levels: levels.collect(),
        })
    }

    /// Returns the position tolerance of a node, or of an individually stored point, in frame `index`, in parts.
    fn tolerance(&self, index: usize, node: usize) -> f64 {
        let scale = motion_scale(self.schema);
        let Some(largest) = self.plan.largest_cells(index) else {
            return scale.tolerance;
        };
        // Minus half a step, and rounding.
        let half = 0.5 * largest[self.order[node] as usize] * self.parts_per_unit;
        (half - 2.1).max(scale.tolerance)
    }

    /// Computes the target positions of the finest nodes, in parts: individually stored points where the file puts
    /// them; a node that stands for several as far from their mean as in the key frame.
    fn truth_of(&self, cloud: &RawCloud) -> Vec<DVec3> {
        let in_parts = |place: DVec3| (place - self.plan.grid.min) * self.parts_per_unit;
        if self.anchors.is_empty() {
            let place = |&point: &u32| in_parts(cloud.positions.get(point as usize));
            return self.order.iter().map(place).collect();
        }
        let means = means(cloud, &self.nodes, self.order);
        means
            .iter()
            .zip(&self.anchors)
            .map(|(&mean, &anchor)| in_parts(mean) + anchor)
            .collect()
    }

    /// The values of all levels, and then of the points; and their normals before they were rounded.
    fn values(&self, cloud: &RawCloud, has_points: bool) -> Vec<(LevelValues, Vec<Vec3>)> {
        let of_points = PointValues::new(self.schema, &self.plan.grid, cloud);
        let mut summaries = of_points.leaves(&self.nodes, self.order);
        if let (Some((covering, largest)), Some(single)) = (&self.radii, self.schema.radius_single()) {
            // A disk that covered the points of a node still does so while these stay together, however they rotate.
            let now = of_points.largest_radii(&self.nodes, self.order);
            let grown = covering
                .iter()
                .zip(largest)
                .zip(now)
                .map(|((&[code], &was), now)| match code {
                    0 => [now],
                    code => [(i32::from(code) + i32::from(now) - i32::from(was)).clamp(1, 255) as u16],
                });
            summaries.set_single(single, grown.collect());
        }
        let mut levels = vec![(LevelValues::default(), Vec::new()); self.masks.len()];
        for level in (0..levels.len()).rev() {
            levels[level].0.take(&summaries);
            levels[level].1 = summaries.directions().to_vec();
            if level > 0 {
                summaries = summaries.above(self.schema, &self.masks[level - 1]);
            }
        }
        if has_points {
            let each: Vec<Range<usize>> = (0..self.order.len()).map(|place| place..place + 1).collect();
            let mut values = LevelValues::default();
            let summaries = of_points.leaves(&each, self.order);
            values.take(&summaries);
            levels.push((values, summaries.directions().to_vec()));
        }
        levels
    }
}

fn means(cloud: &RawCloud, nodes: &[Range<usize>], order: &[u32]) -> Vec<DVec3> {
    let mean = |range: &Range<usize>| {
        let points = order[range.clone()].iter();
        let sum: DVec3 = points.map(|&point| cloud.positions.get(point as usize)).sum();
        sum / range.len() as f64
    };
    nodes.iter().map(mean).collect()
}

fn mean_steps(below: &[[i32; 3]], nodes: &[Range<usize>]) -> Vec<[i32; 3]> {
    let mean = |range: &Range<usize>| {
        let count = range.len().max(1) as f64;
        [0, 1, 2].map(|axis| {
            let sum: i64 = below[range.clone()].iter().map(|step| i64::from(step[axis])).sum();
            (sum as f64 / count).round() as i32
        })
    };
    nodes.iter().map(mean).collect()
}

/// Points whose distances are compared.
const MAX_PAIRS: usize = 4096;

/// Maximum factor by which points may be farther apart than in the key frame.
const MAX_STRETCH: f64 = 2.0;

/// Returns true if frame `other` of a group has the points of frame `key` in the same order, and points that were next
/// to each other still are.
pub(in crate::reel) fn follows(plan: &GroupPlan, clouds: &[&RawCloud], key: usize, other: usize) -> bool {
    let order = plan.order(key);
    let is_alike = plan.schemas[key] == plan.schemas[other]
        && part_bits(&plan.schemas[key], &plan.grid).is_some()
        && clouds[key].positions.len() == clouds[other].positions.len()
        && order.len() == clouds[key].positions.len()
        && plan.order(other).len() == order.len()
        && order.len() > 1;
    // Resampled frames are encoded independently. Block motion, and points tracked within parts of a cell, still took
    // 92 % of the bits of geometry and 82 % of those of colours, at five times the decoding time.
    if !is_alike {
        return false;
    }
    let stride = order.len().div_ceil(MAX_PAIRS);
    let nearly_largest = |cloud: &RawCloud| {
        let pairs = order.windows(2).step_by(stride);
        let position = |point: u32| cloud.positions.get(point as usize);
        let mut lengths: Vec<f64> = pairs
            .map(|pair| position(pair[0]).distance(position(pair[1])))
            .collect();
        let place = lengths.len() * 19 / 20;
        *lengths.select_nth_unstable_by(place, f64::total_cmp).1
    };
    nearly_largest(clouds[other]) <= MAX_STRETCH * nearly_largest(clouds[key]).max(plan.grid.cell)
}
