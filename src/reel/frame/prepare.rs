//! From clouds to whole numbers: the grid of a group, its schemas, and the levels of each frame.

use super::describe::schema;
use super::floats::{Floats, Lattice, lattice_of};
use super::grid::Grid;
use super::levels::{Level, LevelValues, Pose, PosePoints};
use super::points;
use super::schema::{Kept, Schema};
use super::summaries::{PointValues, offsets};
use crate::cloud::{Positions, RawCloud};
use crate::math::{morton, order_of_codes};
use crate::reel::options::{Precision, ReelOptions};
use crate::reel::tree::masks_of_cells;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A level is as fine as the points are dense while it has so many times the cells of the level above; a surface of
/// which every cell is occupied has four times as many.
const GROWTH: u64 = 2;

/// Larger coordinates, of which products may overflow, are kept outside of cells.
const LARGEST: f64 = 1e150;

/// What the frames of a group have in common, and the cells of each.
#[derive(Debug)]
pub(in crate::reel) struct GroupPlan {
    pub(in crate::reel) grid: Grid,
    /// For each frame.
    pub(in crate::reel) schemas: Vec<Schema>,
    cells: Vec<FrameCells>,
    finest: u32,
}

/// The points of a frame in the order of their cells.
#[derive(Debug, Default)]
struct FrameCells {
    /// Morton codes of the finest cells, ascending.
    codes: Vec<u64>,
    /// The point of each.
    order: Vec<u32>,
    /// Points in no cell.
    outside: Vec<u32>,
}

/// How points become cells.
struct Finest {
    grid: Grid,
    kept: Kept,
    /// What coordinates are whole numbers of, where they are kept to the last bit.
    lattice: Option<Lattice>,
}

impl GroupPlan {
    /// Of frames with at least one entry of every attribute they have for each point.
    pub(in crate::reel) fn new(clouds: &[&RawCloud], options: &ReelOptions) -> Self {
        let mut finest = finest_grid(clouds, options);
        if finest.kept == Kept::Exact {
            finest.lattice = lattice_of(clouds);
        }
        let cells: Vec<FrameCells> = clouds.par_iter().map(|cloud| cells_of(cloud, &finest)).collect();
        let depth = match options.precision {
            Precision::Bits(_) => finest.grid.depth,
            _ => sampling_depth(&cells, finest.grid.depth),
        };
        let below = finest.grid.depth - depth;
        let grid = Grid {
            cell: finest.grid.cell * f64::from(1u32 << below),
            depth,
            ..finest.grid
        };
        let kept = match finest.kept {
            Kept::Bits(bits) => Kept::Bits(bits + below as u8),
            kept => kept,
        };
        let schemas = clouds
            .iter()
            .map(|cloud| schema(cloud, clouds, (kept, finest.lattice), options))
            .collect();
        Self {
            grid,
            schemas,
            cells,
            finest: finest.grid.depth,
        }
    }

    /// The deepest nodes of a frame, and which of its points are in each, in the order of [`GroupPlan::order`].
    pub(in crate::reel) fn nodes(&self, frame: usize) -> (Vec<u64>, Vec<Range<usize>>) {
        let codes = &self.cells[frame].codes;
        let below = 3 * (self.finest - self.grid.depth);
        let mut nodes = Vec::new();
        let mut starts = Vec::new();
        for (place, code) in codes.iter().map(|code| code >> below).enumerate() {
            if nodes.last() != Some(&code) {
                nodes.push(code);
                starts.push(place);
            }
        }
        starts.push(codes.len());
        (nodes, starts.windows(2).map(|ends| ends[0]..ends[1]).collect())
    }

    /// The points of a frame that are in cells, in the order of these.
    pub(in crate::reel) fn order(&self, frame: usize) -> &[u32] {
        &self.cells[frame].order
    }
}

fn is_placed(position: DVec3) -> bool {
    position.abs().cmple(DVec3::splat(LARGEST)).all()
}

fn finest_grid(clouds: &[&RawCloud], options: &ReelOptions) -> Finest {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for cloud in clouds {
        for index in 0..cloud.positions.len() {
            let position = cloud.positions.get(index);
            if is_placed(position) {
                min = min.min(position);
                max = max.max(position);
            }
        }
    }
    if min.x > max.x {
        (min, max) = (DVec3::ZERO, DVec3::ZERO);
    }
    let extent = (max - min).max_element();
    let largest = min.abs().max(max.abs()).max_element();
    let merged = Kept::Merged;
    match options.precision {
        Precision::Bits(bits) => {
            let cells = f64::from(1u32 << bits);
            let cell = if extent > 0.0 {
                extent / (cells - 1.0).max(1.0)
            } else {
                1.0
            };
            let grid = Grid {
                min: min - 0.5 * cell,
                cell,
                depth: u32::from(bits),
            };
            Finest {
                grid,
                kept: merged,
                lattice: None,
            }
        }
        Precision::Length(length) => {
            // The middle of a cell is rounded to the floats of the file once more.
            let has_singles = clouds.iter().any(|cloud| matches!(cloud.positions, Positions::F32(_)));
            let rounding = largest * 2f64.powi(if has_singles { -24 } else { -51 });
            let cell = 2.0 * (length - rounding) * (1.0 - 1e-9);
            let cells = extent / cell + 2.0;
            if cell > 0.0 && cells < (1u64 << 50) as f64 {
                let bits = (cells.log2().ceil() as u32).max(1);
                let depth = bits.min(morton::LEVELS);
                let below = bits - depth;
                let grid = Grid {
                    min: (min / cell).floor() * cell,
                    cell: cell * (1u64 << below) as f64,
                    depth,
                };
                let kept = Kept::Bits(below as u8);
                return Finest {
                    grid,
                    kept,
                    lattice: None,
                };
            }
            Finest {
                grid: power_of_two_grid(min, max, extent, largest),
                kept: Kept::Exact,
                lattice: None,
            }
        }
        Precision::SamplingDensity => Finest {
            grid: power_of_two_grid(min, max, extent, largest),
            kept: merged,
            lattice: None,
        },
        Precision::Lossless => Finest {
            grid: power_of_two_grid(min, max, extent, largest),
            kept: Kept::Exact,
            lattice: None,
        },
    }
}

/// A cube of which edge and place are round numbers, so that groups of a sequence mostly have the same.
fn power_of_two_grid(min: DVec3, max: DVec3, extent: f64, largest: f64) -> Grid {
    let least = if extent > 0.0 { extent } else { 1.0 };
    // Cells that doubles tell apart, and that are no subnormal numbers.
    let mut edge = least.max(largest * 2f64.powi(-30)).max(1e-300).log2().ceil().exp2();
    loop {
        let step = edge / 64.0;
        let corner = (min / step).floor() * step;
        if ((max - corner) / edge).max_element() < 1.0 {
            return Grid {
                min: corner,
                cell: edge / f64::from(1u32 << morton::LEVELS),
                depth: morton::LEVELS,
            };
        }
        edge *= 2.0;
    }
}

fn cells_of(cloud: &RawCloud, finest: &Finest) -> FrameCells {
    let mut cells = FrameCells::default();
    let mut placed = Vec::new();
    let floats = Floats {
        is_double: matches!(cloud.positions, Positions::F64(_)),
        lattice: finest.lattice,
    };
    for index in 0..cloud.positions.len() {
        let position = cloud.positions.get(index);
        if is_placed(position)
            && (finest.kept != Kept::Exact || points::has_rank(floats, &finest.grid, &cloud.positions, index))
        {
            placed.push(index as u32);
            let cell = [0, 1, 2].map(|axis| finest.grid.index(axis, position[axis]) as u32);
            cells.codes.push(morton::encode(cell));
        } else {
            cells.outside.push(index as u32);
        }
    }
    let order = order_of_codes(&cells.codes);
    cells.codes = order.iter().map(|&place| cells.codes[place as usize]).collect();
    cells.order = order.into_iter().map(|place| placed[place as usize]).collect();
    cells
}

/// The deepest level that is as fine as the points are dense.
fn sampling_depth(frames: &[FrameCells], finest: u32) -> u32 {
    let mut begun = [0u64; 23];
    for frame in frames {
        for pair in frame.codes.windows(2) {
            let differing = (pair[0] ^ pair[1]).checked_ilog2();
            if let Some(differing) = differing {
                begun[(finest - differing / 3) as usize] += 1;
            }
        }
    }
    let mut cells = frames.iter().filter(|frame| !frame.codes.is_empty()).count() as u64;
    let mut deepest = 1;
    for level in 1..=finest {
        let above = cells;
        cells += begun[level as usize];
        if cells >= GROWTH * above && cells > 0 {
            deepest = level;
        }
    }
    deepest.min(finest)
}

/// The levels of frame `frame` of a group.
pub(in crate::reel) fn prepare(plan: &GroupPlan, frame: usize, cloud: &RawCloud) -> Pose {
    let schema = &plan.schemas[frame];
    let cells = &plan.cells[frame];
    let depth = plan.grid.depth;
    let (leaves, ranges) = plan.nodes(frame);
    let masks = masks_of_cells(&leaves, depth);
    let mut levels: Vec<Level> = masks
        .into_iter()
        .map(|masks| Level {
            masks,
            ..Level::default()
        })
        .collect();
    levels.push(Level {
        cells: leaves,
        ..Level::default()
    });
    for level in (0..depth as usize).rev() {
        let mut above: Vec<u64> = levels[level + 1].cells.iter().map(|cell| cell >> 3).collect();
        above.dedup();
        levels[level].cells = above;
    }
    let of_points = PointValues::new(schema, &plan.grid, cloud);
    let mut summaries = of_points.leaves(&ranges, &cells.order);
    if schema.offset_bits > 0 {
        levels[depth as usize].values.offsets = offsets(
            schema,
            &plan.grid,
            cloud,
            &cells.order,
            &ranges,
            &levels[depth as usize].cells,
            &summaries,
        );
    }
    for level in (0..=depth as usize).rev() {
        levels[level].values.take(&summaries);
        if level > 0 {
            summaries = summaries.above(schema, &levels[level - 1].masks);
        }
    }
    let points = (schema.kept != Kept::Merged).then(|| {
        let all: Vec<u32> = cells.order.iter().chain(&cells.outside).copied().collect();
        let mut values = LevelValues::default();
        let each: Vec<Range<usize>> = (0..all.len()).map(|place| place..place + 1).collect();
        values.take(&of_points.leaves(&each, &all));
        PosePoints {
            counts: ranges.iter().map(|range| range.len() as u32).collect(),
            below: points::below(schema, &plan.grid, &cloud.positions, &cells.order),
            outside: points::bits_of(&cloud.positions, &cells.outside),
            values,
            columns: points::columns(schema, &cloud.attributes, &all),
            order: if schema.has_order { all } else { Vec::new() },
        }
    });
    Pose {
        levels,
        points,
        flat: None,
    }
}
