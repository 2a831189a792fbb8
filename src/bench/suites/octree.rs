//! Table III: size of an octree of an acceptable loss δ, and times to build and traverse it.
//!
//! **How it works.** Frames hold their points in Morton order, in which there is nothing to sort. So builds are
//! measured from both orders: file order, restored from the file indices of points, as in a cloud that was just read;
//! and Morton order. Each is measured on one thread, as in the paper, and on all. The four variants take turns, so that
//! a slowdown of the machine affects all of them. Times are measured on the calling thread: including the dispatch to
//! the pool and back, excluding the release of the octree.
//!
//! Traversals run on all threads, and on one as the paper's do. Each reuses the memory of the one before it, as in
//! playback; the viewpoints are those from which surfels cover 25 to 85 % of the image.

use super::paper_style::surfel_style;
use super::traversals::Traversals;
use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::levels::octree::{Octree, StopCriterion};
use crate::math::Cube;
use crate::scene::{Camera, Scene};
use crate::sequence::PreparedFrame;
use crate::stopwatch::milliseconds_since;
use glam::Vec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use std::time::Instant;

/// The losses of the paper's table.
const DELTAS: [f32; 3] = [0.02, 0.10, 0.50];

/// LOD threshold of the traversals, pixels: the usual one.
const LOD_PX: f32 = 1.0;

/// One step to prepare a frame, one to place its viewpoints, one for each δ.
const STEPS_PER_FRAME: usize = 2 + DELTAS.len();

/// In the order in which [`OctreeSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::percent("delta", "δ", 0),
    Column::number("points", "points", 0),
    Column::percent("loss", "loss", 2),
    Column::number("depth", "depth", 1),
    Column::number("nodes", "nodes", 0),
    Column::number("leaves", "leaves", 0),
    Column::number(
        "build_file_order_one_thread_ms_median",
        "build ms, file order, 1 thread",
        3,
    ),
    Column::number("build_file_order_one_thread_ms_q1", "25 %", 3).hidden(),
    Column::number("build_file_order_one_thread_ms_q3", "75 %", 3).hidden(),
    Column::number("build_file_order_one_thread_ms_mean", "mean ms", 3).hidden(),
    Column::number(
        "build_file_order_all_threads_ms_median",
        "build ms, file order, all threads",
        3,
    ),
    Column::number("build_file_order_all_threads_ms_q1", "25 %", 3).hidden(),
    Column::number("build_file_order_all_threads_ms_q3", "75 %", 3).hidden(),
    Column::number("build_file_order_all_threads_ms_mean", "mean ms", 3).hidden(),
    Column::number(
        "build_morton_order_one_thread_ms_median",
        "build ms, Morton order, 1 thread",
        3,
    ),
    Column::number("build_morton_order_one_thread_ms_q1", "25 %", 3).hidden(),
    Column::number("build_morton_order_one_thread_ms_q3", "75 %", 3).hidden(),
    Column::number("build_morton_order_one_thread_ms_mean", "mean ms", 3).hidden(),
    Column::number(
        "build_morton_order_all_threads_ms_median",
        "build ms, Morton order, all threads",
        3,
    ),
    Column::number("build_morton_order_all_threads_ms_q1", "25 %", 3).hidden(),
    Column::number("build_morton_order_all_threads_ms_q3", "75 %", 3).hidden(),
    Column::number("build_morton_order_all_threads_ms_mean", "mean ms", 3).hidden(),
    Column::number("traverse_ms_median", "traverse ms, all threads", 3),
    Column::number("traverse_ms_q1", "25 %", 3),
    Column::number("traverse_ms_q3", "75 %", 3),
    Column::number("traverse_ms_mean", "mean ms", 3).hidden(),
    Column::number("traverse_one_thread_ms_median", "one thread", 3),
    Column::number("traverse_one_thread_ms_q1", "25 %", 3).hidden(),
    Column::number("traverse_one_thread_ms_q3", "75 %", 3).hidden(),
    Column::number("traverse_one_thread_ms_mean", "mean ms", 3).hidden(),
    Column::number("visited_nodes", "visited", 0),
    Column::number("emitted_voxels", "emitted", 0),
    Column::number("samples", "samples", 0).hidden(),
    Column::number("threads", "threads", 0).hidden(),
];

/// Building and traversing octrees of three depths.
pub const OCTREE: &Suite = &Suite {
    name: "octree",
    brief: "octree construction: Table III of the paper",
    title: "Octree by δ",
    hint: "Loss, depth, nodes, build and traversal time at δ of 2, 10 and 50 % (paper, Table III)",
    description: "building and traversing octrees by acceptable loss",
    measured: "building from positions and colours in memory, in the order of the file and in Morton order, each on \
        one thread and on all; traversal into reused memory, on all threads and on one; nodes are internal nodes",
    not_measured: "decoding, normals, drawing; the adapter only draws the pictures whose coverage is counted",
    covered_by: "surfels",
    defaults: Defaults::PROTOCOL,
    takes: &[],
    is_of_paper: true,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "build_file_order_one_thread_ms_median",
    bars_title: "Build time, median ms",
    bar_labels: 2,
};

/// Build method of an octree.
#[derive(Debug, Clone, Copy)]
struct Way {
    is_of_file_order: bool,
    is_on_one_thread: bool,
}

/// In the order of their columns.
const WAYS: [Way; 4] = [
    Way {
        is_of_file_order: true,
        is_on_one_thread: true,
    },
    Way {
        is_of_file_order: true,
        is_on_one_thread: false,
    },
    Way {
        is_of_file_order: false,
        is_on_one_thread: true,
    },
    Way {
        is_of_file_order: false,
        is_on_one_thread: false,
    },
];

/// Points to build from.
struct BuildInput {
    positions: Vec<Vec3>,
    colors: Vec<[u8; 4]>,
}

/// Inputs of the octree builds of a frame.
struct Beginnings<'a> {
    /// The cube of the frame, in whose Morton order its points are.
    cube: Cube,
    file_order: BuildInput,
    morton_order: BuildInput,
    one_thread: &'a ThreadPool,
}

/// Measurements of one sequence at one δ.
#[derive(Default)]
struct OctreeSamples {
    loss: Vec<f64>,
    depth: Vec<f64>,
    nodes: Vec<f64>,
    leaves: Vec<f64>,
    /// Indexed by [`WAYS`].
    build_ms: [Vec<f64>; WAYS.len()],
    traversals: Traversals,
    one_thread_traversals: Traversals,
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let one_thread = one_thread()?;
    for subject in run.subjects(STEPS_PER_FRAME)? {
        measure_sequence(run, &subject, &one_thread)?;
    }
    Ok(())
}

fn one_thread() -> Result<ThreadPool, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(1);
    Ok(pool.thread_name(|_| "bench one thread".to_owned()).build()?)
}

fn measure_sequence(run: &mut Run<'_>, subject: &Subject<'_>, one_thread: &ThreadPool) -> Result<(), BenchError> {
    // Only the needs of placing viewpoints; octrees are built while the clock runs.
    let needs = Scene::needs(&surfel_style());
    let mut samples: Vec<OctreeSamples> = DELTAS.iter().map(|_| OctreeSamples::default()).collect();
    let (mut point_counts, mut coverages) = (Vec::new(), Vec::new());
    let mut first_failure = None;
    for &index in &subject.chosen {
        let loaded = run.load(subject, index, STEPS_PER_FRAME, &needs)?;
        let frame = match loaded {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        run.begin_step(format!("{}: placing viewpoints", subject.named(index)))?;
        let viewpoints = run.viewpoints(subject, &frame, &surfel_style())?;
        coverages.extend(viewpoints.iter().map(|viewpoint| viewpoint.coverage));
        let cameras: Vec<Camera> = viewpoints.iter().map(|viewpoint| viewpoint.camera).collect();
        let beginnings = Beginnings::of(&frame, one_thread);
        for (delta, samples) in DELTAS.into_iter().zip(&mut samples) {
            run.begin_step(format!("{}: δ {} %", subject.named(index), percent(delta)))?;
            let octree = measure_builds(run, &beginnings, delta, samples)?;
            for (traversals, pool) in [
                (&mut samples.traversals, None),
                (&mut samples.one_thread_traversals, Some(one_thread)),
            ] {
                traversals.measure(run, subject, &octree, &cameras, LOD_PX, pool)?;
            }
        }
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let rows = DELTAS
        .iter()
        .zip(&samples)
        .map(|(&delta, samples)| samples.row(subject.name, delta, mean(&point_counts)));
    run.finish(subject, &point_counts, &coverages, rows);
    Ok(())
}

/// Measures the builds, each variant as often as there are traversals.
fn measure_builds(
    run: &Run<'_>,
    beginnings: &Beginnings<'_>,
    delta: f32,
    samples: &mut OctreeSamples,
) -> Result<Octree, BenchError> {
    let mut octree = WAYS[0].build(beginnings, delta);
    for round in 0..(run.options.warmup + run.options.repeat) * run.options.viewpoints {
        for (way, times_ms) in WAYS.iter().zip(&mut samples.build_ms) {
            run.check_cancelled()?;
            let start = Instant::now();
            let built = way.build(beginnings, delta);
            let build_ms = milliseconds_since(start);
            if round >= run.options.warmup * run.options.viewpoints {
                times_ms.push(build_ms);
            }
            // Freeing the previous one is not part of the build.
            octree = built;
        }
    }
    samples.loss.push(f64::from(octree.loss()));
    samples.depth.push(f64::from(octree.depth()));
    samples.nodes.push(octree.internal_count() as f64);
    samples.leaves.push(octree.leaf_count() as f64);
    Ok(octree)
}

impl Way {
    fn build(self, beginnings: &Beginnings<'_>, delta: f32) -> Octree {
        let BuildInput { positions, colors } = if self.is_of_file_order {
            &beginnings.file_order
        } else {
            &beginnings.morton_order
        };
        let build = || {
            let (positions, colors) = (black_box(positions), black_box(colors));
            Octree::build_in(beginnings.cube, positions, colors, StopCriterion::Loss(delta))
        };
        if self.is_on_one_thread {
            beginnings.one_thread.install(build)
        } else {
            build()
        }
    }
}

impl<'a> Beginnings<'a> {
    fn of(frame: &PreparedFrame, one_thread: &'a ThreadPool) -> Self {
        let morton_order = BuildInput {
            positions: frame.frame.positions().to_vec(),
            colors: frame.points.iter().map(|point| point.color).collect(),
        };
        Self {
            cube: frame.frame.cube(),
            file_order: morton_order.in_file_order(frame.frame.file_index()),
            morton_order,
            one_thread,
        }
    }
}

impl BuildInput {
    /// Returns the points reordered by `file_index`.
    fn in_file_order(&self, file_index: &[u32]) -> Self {
        let mut places: Vec<usize> = (0..file_index.len()).collect();
        places.sort_unstable_by_key(|&place| file_index[place]);
        Self {
            positions: places.iter().map(|&place| self.positions[place]).collect(),
            colors: places.iter().map(|&place| self.colors[place]).collect(),
        }
    }
}

/// δ in whole percent, free of the rounding to f32.
fn percent(delta: f32) -> f64 {
    f64::from(delta * 100.0).round()
}

impl OctreeSamples {
    fn row(&self, sequence: &str, delta: f32, points: f64) -> Row {
        let times = |times_ms: &[f64]| {
            let quantiles = Quantiles::of(times_ms);
            [
                Cell::maybe(quantiles.map(|q| q.median)),
                Cell::maybe(quantiles.map(|q| q.q1)),
                Cell::maybe(quantiles.map(|q| q.q3)),
                Cell::maybe(quantiles.map(|q| q.mean)),
            ]
        };
        let mut cells = vec![
            Cell::Text(sequence.to_owned()),
            Cell::Number(percent(delta) / 100.0),
            Cell::Number(points),
            Cell::Number(mean(&self.loss)),
            Cell::Number(mean(&self.depth)),
            Cell::Number(mean(&self.nodes)),
            Cell::Number(mean(&self.leaves)),
        ];
        cells.extend(self.build_ms.iter().flat_map(|times_ms| times(times_ms)));
        cells.extend(times(&self.traversals.times_ms));
        cells.extend(times(&self.one_thread_traversals.times_ms));
        cells.extend([
            Cell::Number(mean(&self.traversals.visited_nodes)),
            Cell::Number(mean(&self.traversals.emitted_voxels)),
            Cell::Number(self.traversals.times_ms.len() as f64),
            Cell::Number(rayon::current_num_threads() as f64),
        ]);
        Row::new(cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::sequence::{Needs, PrepareCounters, prepare};
    use glam::DVec3;
    use std::sync::Arc;

    /// Places that no order of cells has, with a hole and one that is dropped.
    fn of_file() -> RawCloud {
        let place = |index: u32| {
            let mixed = index.wrapping_mul(2_654_435_761);
            [8, 16, 24].map(|shift| (mixed >> shift & 255) as f32 / 256.0)
        };
        let mut positions: Vec<[f32; 3]> = (0..5000).map(place).collect();
        positions[7] = [f32::NAN; 3];
        let mut raw = RawCloud::from_positions(Positions::F32(positions));
        let color = |index: u32| [index as u8, (index >> 8) as u8, 0, 255];
        raw.attributes.colors = Some((0..5000).map(color).collect());
        raw
    }

    fn prepared() -> PreparedFrame {
        let frame = Arc::new(Frame::from_raw(of_file(), DVec3::ZERO).unwrap());
        prepare(0, frame, 0.0, &Needs::default(), &PrepareCounters::default())
    }

    #[test]
    fn builds_start_from_file_order_and_from_morton_order() {
        let pool = one_thread().unwrap();
        let beginnings = Beginnings::of(&prepared(), &pool);
        let raw = of_file();
        let Positions::F32(positions) = &raw.positions else {
            panic!("single precision");
        };
        let mut expected: Vec<Vec3> = positions.iter().map(|&at| at.into()).collect();
        let mut colors = raw.attributes.colors.unwrap();
        expected.remove(7);
        colors.remove(7);
        assert_eq!(beginnings.file_order.positions, expected);
        assert_eq!(beginnings.file_order.colors, colors);
        let cube = crate::math::Cube::around(&expected).unwrap();
        let is_sorted = |points: &BuildInput| cube.codes(&points.positions).is_sorted();
        assert!(is_sorted(&beginnings.morton_order) && !is_sorted(&beginnings.file_order));
    }

    #[test]
    fn every_variant_builds_the_same_octree() {
        let pool = one_thread().unwrap();
        assert_eq!(pool.current_num_threads(), 1);
        let beginnings = Beginnings::of(&prepared(), &pool);
        let built = WAYS.map(|way| way.build(&beginnings, 0.1).masks());
        assert!(built.iter().all(|masks| *masks == built[0]));
        let kinds = WAYS.map(|way| [way.is_of_file_order, way.is_on_one_thread]);
        assert_eq!(kinds, [[true, true], [true, false], [false, true], [false, false]]);
    }
}
