//! Reference state for the next frame of a group: the positions of the nodes of every level, and their attributes.

use super::super::geometry::plan_of_points;
use super::super::grid::Grid;
use super::super::levels::{Level, LevelValues, Pose};
use super::super::output::{Places, cloud_of_places, in_file_order};
use super::super::schema::{Retained, Schema};
use super::part_bits;
use crate::cloud::{Positions, RawCloud};
use crate::math::morton;
use crate::reel::attributes::{MISSING, NormalGrid, offset_parts};
use crate::reel::tree::{ALONE, Known, Links, Neighbours, first_children, neighbours_below, plan};
use glam::DVec3;

/// Reference frame that the next one is encoded relative to.
#[derive(Debug, Clone)]
pub(in crate::reel) struct Followed {
    /// The nodes of each level that was decoded, from the root down; then the points, if they are stored individually.
    pub(super) levels: Vec<FollowedLevel>,
    /// Prediction plan of each node.
    pub(super) plans: Vec<Vec<Known>>,
    /// Neighbours and children of the nodes of each level that has something below it.
    pub(super) families: Vec<Family>,
    /// True if the last level consists of points.
    pub(super) has_points: bool,
    /// The index in the file of each point.
    order: Vec<u32>,
    part_bits: u32,
    /// The level of the deepest cells, be it decoded or not.
    pub(super) depth: u32,
}

/// The nodes of a level.
#[derive(Debug, Clone, Default)]
pub(super) struct FollowedLevel {
    /// In parts of the deepest cells, from the smallest corner of the cube on.
    pub(super) positions: Vec<[i32; 3]>,
    pub(super) values: LevelValues,
}

impl Followed {
    /// Creates the reference from a frame that stands alone, or from its first levels, as a decoder has it; `None` if
    /// no frame is encoded relative to it.
    pub(in crate::reel) fn of(schema: &Schema, grid: &Grid, pose: &Pose) -> Option<Self> {
        let part_bits = part_bits(schema, grid)?;
        if pose.points.as_ref().is_some_and(|points| !points.outside.is_empty()) {
            return None;
        }
        let still = |positions: Vec<[i32; 3]>, values: &LevelValues| FollowedLevel {
            positions,
            values: values.clone(),
        };
        let (mut plans, mut families) = plans_of(&pose.levels, pose.points.is_some());
        let mut levels: Vec<FollowedLevel> = (0u32..)
            .zip(&pose.levels)
            .map(|(level, of_level)| {
                let center = |&cell: &u64| {
                    morton::decode(cell).map(|along| ((2 * along as i32 + 1) << (part_bits + grid.depth - level)) >> 1)
                };
                let mut centers: Vec<[i32; 3]> = of_level.cells.iter().map(center).collect();
                lift(schema, part_bits, &of_level.values, &mut centers);
                still(centers, &of_level.values)
            })
            .collect();
        if let (Some(points), Some(deepest), Retained::Bits(bits)) = (&pose.points, pose.levels.last(), schema.retained)
        {
            let bits = u32::from(bits);
            let of_each = points.cell_of_each(&deepest.cells);
            let placed = of_each.zip(&points.below).map(|((cell, missing), below)| {
                let cell = morton::decode(cell);
                // The centre of the range that is resolved by the bits below the cell.
                [0, 1, 2].map(|axis| {
                    let center = (2 * below[axis] as i32 + (1 << missing)) << (part_bits - bits);
                    (cell[axis] << part_bits) as i32 | center >> 1
                })
            });
            levels.push(still(placed.collect(), &points.values));
            plans.push(plan_of_points(points));
            if let Some(family) = families.last_mut() {
                let mut next = 0;
                family.first = std::iter::once(0)
                    .chain(points.counts.iter().map(|&count| {
                        next += count;
                        next
                    }))
                    .collect();
            }
        }
        Some(Self {
            levels,
            plans,
            families,
            has_points: pose.points.is_some(),
            order: pose
                .points
                .as_ref()
                .map_or_else(Vec::new, |points| points.order.clone()),
            part_bits,
            depth: grid.depth,
        })
    }

    /// Nodes of each level.
    pub(super) fn counts(&self) -> Vec<usize> {
        let tree = self.levels.len() - usize::from(self.has_points);
        self.levels[..tree].iter().map(|level| level.positions.len()).collect()
    }

    /// Edge of the cells of a level, in parts.
    pub(super) fn edge_parts(&self, level: usize) -> f64 {
        (f64::from(self.part_bits) + f64::from(self.depth) - level as f64).exp2()
    }
}

/// Moves nodes from the centres of their cells to the surface, where an offset is stored.
fn lift(schema: &Schema, part_bits: u32, values: &LevelValues, centers: &mut [[i32; 3]]) {
    if values.offsets.is_empty() || schema.normal_bits == 0 {
        return;
    }
    let normals = NormalGrid::of(schema.normal_bits);
    let nodes = centers.iter_mut().zip(&values.normals).zip(&values.offsets);
    for ((center, &normal), &offset) in nodes.filter(|((_, normal), _)| **normal != MISSING) {
        let way = offset_parts(normals, normal, offset, schema.offset_bits, part_bits);
        *center = [0, 1, 2].map(|axis| center[axis] + way[axis]);
    }
}

/// The nodes of a level among each other.
#[derive(Debug, Clone)]
pub(super) struct Family {
    /// For each node those around it.
    pub(super) neighbours: Vec<Neighbours>,
    /// For each node its first child, and the end.
    pub(super) first: Vec<u32>,
}

/// Returns the prediction plans of the nodes of every level, and their neighbours where something is below.
fn plans_of(levels: &[Level], has_points: bool) -> (Vec<Vec<Known>>, Vec<Family>) {
    if levels.first().is_none_or(|root| root.cells.is_empty()) {
        let nobody = Family {
            neighbours: Vec::new(),
            first: vec![0],
        };
        return (vec![Vec::new(); levels.len()], vec![nobody; levels.len()]);
    }
    // The root is the only child of a single node.
    let mut masks: &[u8] = &[1];
    let mut families = vec![Family {
        neighbours: vec![ALONE],
        first: first_children(masks),
    }];
    let mut plans = Vec::with_capacity(levels.len());
    for (place, level) in levels.iter().enumerate() {
        let above = &families[place];
        let links = Links {
            neighbours: &above.neighbours,
            masks,
            first: &above.first,
        };
        plans.push(plan(links));
        if place + 1 < levels.len() || has_points {
            let neighbours = neighbours_below(links);
            masks = &level.masks;
            // Points are not octants: their number is encoded differently.
            let first = first_children(masks);
            families.push(Family { neighbours, first });
        }
    }
    families.remove(0);
    (plans, families)
}

/// The cloud of the nodes of a level, or of the points if they are stored individually and `level` is below the
/// deepest. Scalars have the offsets given.
pub(in crate::reel) fn cloud_of_followed(
    schema: &Schema,
    grid: &Grid,
    followed: &Followed,
    level: usize,
    offsets: &[f64],
) -> RawCloud {
    let Some(of_level) = followed.levels.get(level) else {
        return RawCloud::from_positions(Positions::F32(Vec::new()));
    };
    let part = grid.cell / f64::from(1u32 << followed.part_bits);
    let place = |position: &[i32; 3]| grid.min + DVec3::from_array(position.map(f64::from)) * part;
    let is_whole = level + 1 == followed.levels.len() && (followed.has_points || level == grid.depth as usize);
    let places = Places {
        values: &of_level.values,
        at: of_level.positions.iter().map(place),
        closing_edge: (!is_whole || !followed.has_points && schema.retained != Retained::Merged)
            .then(|| grid.edge(level as u32)),
    };
    let mut cloud = cloud_of_places(schema, grid, places, offsets);
    if followed.has_points && is_whole && schema.has_order {
        in_file_order(&followed.order, &mut cloud);
    }
    cloud
}

#[cfg(test)]
mod tests {
    use super::super::changes::Changes;
    use super::super::{decode, encode};
    use super::*;
    use crate::reel::ReelOptions;
    use crate::reel::frame::{GroupPlan, encode_pose, prepare};

    /// No writer makes one, but damaged bytes may contain it.
    #[test]
    fn a_frame_without_points_can_be_followed() {
        let empty = RawCloud::from_positions(Positions::F32(Vec::new()));
        for options in [
            ReelOptions::merged(),
            ReelOptions::default(),
            ReelOptions {
                precision: crate::reel::Precision::Length(1e-3),
                ..ReelOptions::default()
            },
        ] {
            let plan = GroupPlan::new(&[&empty], &options);
            let schema = &plan.schemas[0];
            let mut pose = prepare(&plan, 0, &empty);
            encode_pose(schema, &plan.grid, &mut pose);
            let mut followed = Followed::of(schema, &plan.grid, &pose).unwrap();
            let changes = Changes::none(&followed);
            let sections = encode(schema, &mut followed, changes);
            decode(schema, &mut followed, &sections).unwrap();
            let level = followed.levels.len() - 1;
            let cloud = cloud_of_followed(schema, &plan.grid, &followed, level, &[]);
            assert_eq!(cloud.positions.len(), 0);
        }
    }
}
