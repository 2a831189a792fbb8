//! From clouds to whole numbers: the grid of a group, its schemas, and the levels of each frame.

use super::describe::schema;
use super::floats::{Floats, Lattice, lattice_of};
use super::grid::Grid;
use super::levels::{Level, LevelValues, Pose, PosePoints};
use super::points;
use super::schema::{Retained, Schema};
use super::spacing::largest_cells;
use super::summaries::{PointValues, offsets};
use crate::cloud::{Positions, RawCloud};
use crate::math::{morton, order_of_codes};
use crate::reel::options::{Precision, ReelOptions};
use crate::reel::tree::masks_of_cells;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A level is as fine as the points are dense while it has this many times the cells of the level above; a surface with
/// every cell occupied has four times as many.
const GROWTH: f64 = 2.0;

/// Variant of [`GROWTH`] where the bits below a cell are those that its points need: as they are coded independently of
/// each other, the tree goes on as long as it separates many of them.
const GROWTH_OF_POINTS: f64 = 1.5;

/// Maximum bits of the depth of the tree and below it: numbers of that size have halves in doubles.
const MAX_BITS: u32 = 50;

/// Larger coordinates, whose products may overflow, are stored outside cells.
const LARGEST: f64 = 1e150;

/// Plan of a group: the common data of its frames, and the cells of each.
#[derive(Debug)]
pub(in crate::reel) struct GroupPlan {
    pub(in crate::reel) grid: Grid,
    /// For each frame.
    pub(in crate::reel) schemas: Vec<Schema>,
    cells: Vec<FrameCells>,
    finest: u32,
    /// For each frame and each of its points the largest edge of a cell that may stand for it; no frames where one
    /// edge is for all.
    largest_cells: Vec<Vec<f64>>,
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

/// Quantisation of points to cells.
struct Finest {
    grid: Grid,
    retained: Retained,
    /// Lattice of the coordinates, if they are stored to the last bit.
    lattice: Option<Lattice>,
}

impl GroupPlan {
    /// Plans a group of frames with at least one entry of every attribute they have for each point.
    pub(in crate::reel) fn new(clouds: &[&RawCloud], options: &ReelOptions) -> Self {
        let mut finest = finest_grid(clouds, options);
        let largest_cells = match options.precision {
            Precision::PointSpacing => clouds.par_iter().map(|cloud| largest_cells_of(cloud)).collect(),
            _ => Vec::new(),
        };
        finest.grid.cell *= scale_for(&largest_cells);
        if finest.retained == Retained::Exact {
            finest.lattice = lattice_of(clouds);
        }
        let cells: Vec<FrameCells> = clouds.par_iter().map(|cloud| cells_of(cloud, &finest)).collect();
        let depth = match options.precision {
            Precision::Bits(_) => finest.grid.depth,
            Precision::PointSpacing => sampling_depth(&cells, finest.grid.depth, GROWTH_OF_POINTS),
            _ => sampling_depth(&cells, finest.grid.depth, GROWTH),
        };
        let below = finest.grid.depth - depth;
        let grid = Grid {
            cell: finest.grid.cell * f64::from(1u32 << below),
            depth,
            ..finest.grid
        };
        let mut plan = Self {
            grid,
            schemas: Vec::new(),
            cells,
            finest: finest.grid.depth,
            largest_cells,
        };
        let retained = match (options.precision, finest.retained) {
            (Precision::PointSpacing, _) => Retained::Bits(plan.max_bits()),
            (_, Retained::Bits(bits)) => Retained::Bits(bits + below as u8),
            (_, retained) => retained,
        };
        plan.schemas = clouds
            .iter()
            .map(|cloud| schema(cloud, clouds, retained, finest.lattice, options))
            .collect();
        plan
    }

    /// The largest edge of a cell that may stand for each point of a frame, if points differ in that.
    pub(in crate::reel) fn largest_cells(&self, frame: usize) -> Option<&[f64]> {
        self.largest_cells.get(frame).map(Vec::as_slice)
    }

    /// Bits below the deepest nodes of a frame that their points need, each node the bits of its most precise point.
    fn bits_below(&self, frame: usize) -> Vec<u8> {
        let (_, ranges) = self.nodes(frame);
        let order = self.order(frame);
        let of_node = |range: Range<usize>| {
            let points = order[range].iter();
            let edges = points.map(|&point| self.largest_cells[frame][point as usize]);
            bits_for(self.grid, edges.fold(f64::INFINITY, f64::min))
        };
        ranges.into_iter().map(of_node).collect()
    }

    /// The bits that the points of each node lack of those that the schema has; none where all have the same.
    fn missing_bits(&self, frame: usize) -> Vec<u8> {
        match self.schemas[frame].retained {
            Retained::Bits(bits) if self.schemas[frame].has_cell_bits => {
                let of_nodes = self.bits_below(frame).into_iter();
                of_nodes.map(|of_node| bits - of_node.min(bits)).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The maximum over all frames.
    fn max_bits(&self) -> u8 {
        let frames = (0..self.largest_cells.len()).into_par_iter();
        let most = frames.map(|frame| self.bits_below(frame).into_iter().max().unwrap_or(0));
        most.max().unwrap_or(0)
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

/// Returns the largest cell edges of the points of a cloud that can be in cells.
fn largest_cells_of(cloud: &RawCloud) -> Vec<f64> {
    let points = 0..cloud.positions.len() as u32;
    let placed = points.filter(|&point| is_placed(cloud.positions.get(point as usize)));
    largest_cells(cloud, &placed.collect::<Vec<u32>>())
}

/// Bits below the cells of a grid until they are no larger than an edge.
fn bits_for(grid: Grid, edge: f64) -> u8 {
    let (mut bits, mut cell) = (0, grid.cell);
    while cell > edge && grid.depth + bits < MAX_BITS {
        cell *= 0.5;
        bits += 1;
    }
    bits as u8
}

/// Steps in which the cube may be larger than a power of two, in parts of an octave.
const SCALES: usize = 4;

/// Factor by which cells are larger than powers of two so that most are about as large as allowed: halved repeatedly,
/// they miss that by the least.
fn scale_for(largest_cells: &[Vec<f64>]) -> f64 {
    const CLASSES: usize = 4 * SCALES;
    // Square roots are rounded identically on every machine; logarithms are not.
    let step = 2f64.sqrt().sqrt().sqrt().sqrt();
    let mut borders = [1.0; CLASSES];
    for class in 1..CLASSES {
        borders[class] = borders[class - 1] * step;
    }
    let mut classes = [0u64; CLASSES];
    for edge in largest_cells.iter().flatten().filter(|edge| edge.is_normal()) {
        let mantissa = f64::from_bits(edge.to_bits() & ((1 << 52) - 1) | 1023 << 52);
        classes[borders.partition_point(|border| *border <= mantissa) - 1] += 1;
    }
    let waste = |scale: &usize| {
        let above = |class: usize| (class + CLASSES - scale * CLASSES / SCALES) % CLASSES;
        let of_classes = classes.iter().enumerate();
        of_classes
            .map(|(class, count)| above(class) as u64 * count)
            .sum::<u64>()
    };
    let best = (0..SCALES).min_by_key(waste).unwrap_or(0);
    borders[best * CLASSES / SCALES]
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
    let merged = Retained::Merged;
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
                retained: merged,
                lattice: None,
            }
        }
        Precision::Length(length) => {
            // The centre of a cell is rounded once more to the floats of the file.
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
                let retained = Retained::Bits(below as u8);
                return Finest {
                    grid,
                    retained,
                    lattice: None,
                };
            }
            Finest {
                grid: power_of_two_grid(min, max, extent, largest),
                retained: Retained::Exact,
                lattice: None,
            }
        }
        Precision::PointSpacing => Finest {
            grid: power_of_two_grid(min, max, extent, largest),
            retained: Retained::Bits(0),
            lattice: None,
        },
        Precision::SamplingDensity => Finest {
            grid: power_of_two_grid(min, max, extent, largest),
            retained: merged,
            lattice: None,
        },
        Precision::Lossless => Finest {
            grid: power_of_two_grid(min, max, extent, largest),
            retained: Retained::Exact,
            lattice: None,
        },
    }
}

/// A cube whose edge and position are round numbers, so that groups of a sequence mostly have the same.
fn power_of_two_grid(min: DVec3, max: DVec3, extent: f64, largest: f64) -> Grid {
    let least = if extent > 0.0 { extent } else { 1.0 };
    // Cells that doubles can resolve, and that are not subnormal.
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
            && (finest.retained != Retained::Exact || points::has_rank(floats, &finest.grid, &cloud.positions, index))
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
fn sampling_depth(frames: &[FrameCells], finest: u32, growth: f64) -> u32 {
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
        if cells as f64 >= growth * above as f64 && cells > 0 {
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
    let points = (schema.retained != Retained::Merged).then(|| {
        let all: Vec<u32> = cells.order.iter().chain(&cells.outside).copied().collect();
        let mut values = LevelValues::default();
        let each: Vec<Range<usize>> = (0..all.len()).map(|place| place..place + 1).collect();
        values.take(&of_points.leaves(&each, &all));
        PosePoints {
            counts: ranges.iter().map(|range| range.len() as u32).collect(),
            missing_bits: plan.missing_bits(frame),
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
