//! Table 1 of Botsch et al. 2002: the size of byte codes and their attributes, the orders of the code, and the speed of
//! drawing from it.
//!
//! | table | measured |
//! |---|---|
//! | [`sizes`] | bits of each stream per leaf, as they are and packed by gzip |
//! | [`orders`] | depth-first against breadth-first: writing, decoding, decoding with half of the nodes culled |
//! | [`drawings`] | points and splats per second of the CPU, by footprint, precision and size of blocks |
//! | [`by_adapter`] | the same of the adapter, which traverses and decodes the code in compute passes |
//! | [`equal_time`] | error of points and splats that take as long as the mesh (Fig. 11) |

mod by_adapter;
mod columns;
mod drawings;
mod equal_time;
mod orders;
mod sizes;
mod subjected;

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::runner::Runner;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::suites::torus_mesh::with_mesh;
use crate::levels::octree::StopCriterion;
use crate::levels::{LevelsKey, LevelsKind};
use crate::render::AnyRenderer;
use crate::scene::Scene;
use crate::sequence::Needs;
use std::sync::Arc;
use subjected::{Subjected, style};

/// Sizes and speeds of byte codes.
pub const CODED: &Suite = &Suite {
    name: "coded",
    brief: "byte codes: Table 1 of Botsch et al. 2002",
    title: "Byte codes",
    hint: "Bits per point by stream, orders of the code, points and splats per second (Botsch et al. 2002, Table 1)",
    description: "byte codes of octrees and their attributes: size, order, drawing by the CPU and by the adapter",
    measured: "sizes: bits per leaf of each stream, of a tree by the paper's δ of 5 % and of one whose cells are about \
        as large as the spacing, as it is and by gzip, of all nodes and of leaves alone. orders: writing the code from \
        sorted points, and decoding it to the centres of all leaves, and of those on one side of the cloud, on one \
        thread. drawing: time from packet to image on all threads, and PSNR against exact disks; by the adapter too, \
        where the code is resident, and where the CPU decodes its nodes and uploads them. equal time: the \
        finest level that takes no longer than the mesh, PSNR against the image of the mesh",
    not_measured: "decoding files, normals, radii, sorting, showing; the paper's machine had an 800 MHz Pentium III",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [640, 480],
        viewpoints: 2,
        frames: 1,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: columns::COLUMNS,
    headline: "mrecords_per_s",
    bars_title: "Millions of points or splats per second",
    bar_labels: 3,
};

/// One step to prepare a frame, one each for the tables.
const STEPS_PER_FRAME: usize = 6;

/// The frame with its byte code.
fn needs() -> Needs {
    Needs {
        levels: Some(LevelsKey {
            kind: LevelsKind::Codes,
            stop: StopCriterion::PAPER,
        }),
        ..Scene::needs(&style())
    }
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let mut processor = Runner::new(AnyRenderer::cpu());
    for subject in run.subjects(STEPS_PER_FRAME)? {
        measure_sequence(run, &mut processor, &subject)?;
    }
    Ok(())
}

/// Rows for each frame: means over several would be the size of none.
fn measure_sequence(run: &mut Run<'_>, processor: &mut Runner, subject: &Subject<'_>) -> Result<(), BenchError> {
    let (mut rows, mut point_counts) = (Vec::new(), Vec::new());
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS_PER_FRAME, &needs())? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        let (Some(octree), Some(cloud)) = (frame.levels.octree(), frame.levels.codes()) else {
            continue;
        };
        point_counts.push(frame.points.len() as f64);
        let named = subject.named(index);
        let subjected = Subjected {
            subject,
            name: match subject.chosen.len() {
                1 => subject.name.to_owned(),
                _ => named.clone(),
            },
            octree: Arc::clone(octree),
            cloud: Arc::clone(cloud),
            frame: with_mesh(subject, index, frame),
        };
        run.begin_step(format!("{named}: sizes"))?;
        rows.extend(sizes::rows(&subjected));
        run.begin_step(format!("{named}: orders"))?;
        rows.extend(orders::rows(run, &subjected)?);
        run.begin_step(format!("{named}: drawing"))?;
        rows.extend(drawings::rows(run, processor, &subjected)?);
        run.begin_step(format!("{named}: drawing by the adapter"))?;
        rows.extend(by_adapter::rows(run, &subjected)?);
        run.begin_step(format!("{named}: equal time"))?;
        rows.extend(equal_time::rows(run, processor, &subjected)?);
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    run.finish(subject, &point_counts, &[], rows);
    Ok(())
}
