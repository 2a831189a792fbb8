//! How far from the truth the stages are, beside what they take: normals, octrees and levels of detail.
//!
//! | table | truth | error |
//! |---|---|---|
//! | [`NORMALS`] | shapes whose normals are known, with and without noise and outliers | angle, by number of neighbours and way to fit |
//! | [`LEAVES`] | the points of each sequence | distance to the middle of the leaf that stands for a point, by δ |
//! | [`LOD`] | the picture of all leaves, τ = 0, and that of surfels | PSNR and FLIP of the picture, by LOD threshold τ |
//! | [`CLOSED`] | the picture of surfels | what of it voxels cover, what they show beside it, and FLIP, by stop criterion and light |
//!
//! Four tables in one report: a column that a table has no use for is missing in its rows.

mod closed;
mod leaves;
mod lod;
mod normals;
mod pictures;

use super::{Run, Subject, paper_voxel_settings};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Column, Row};
use crate::levels::Lod;
use crate::scene::{LevelStyle, Scene, Style};
use crate::sequence::Needs;

/// Names of the tables.
const NORMALS: &str = "normals";
const LEAVES: &str = "leaves";
const LOD: &str = "lod";
const CLOSED: &str = "closed";

/// Columns of all tables; the first says which one a row belongs to.
pub(in crate::bench) const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    // Normals.
    Column::text("shape", "shape"),
    Column::percent("noise", "noise", 1),
    Column::percent("outliers", "outliers", 0),
    Column::number("neighbours", "k", 0),
    // Leaves and levels of detail.
    Column::text("sequence", "sequence"),
    Column::percent("delta", "δ", 0),
    Column::number("lod_px", "τ px", 0),
    Column::number("distance", "distance", 0),
    Column::number("points", "points", 0),
    // Normals.
    Column::number("normals_ms_median", "normals ms", 2),
    Column::number("normals_ms_q1", "25 %", 2).hidden(),
    Column::number("normals_ms_q3", "75 %", 2).hidden(),
    Column::number("angle_deg_mean", "mean °", 2),
    Column::number("angle_deg_p95", "95 % °", 2),
    Column::number("angle_deg_max", "most °", 2),
    Column::number("robust_ms_median", "robust ms", 2),
    Column::number("robust_ms_q1", "25 %", 2).hidden(),
    Column::number("robust_ms_q3", "75 %", 2).hidden(),
    Column::number("robust_angle_deg_mean", "robust mean °", 2),
    Column::number("robust_angle_deg_p95", "robust 95 % °", 2),
    Column::number("robust_angle_deg_max", "robust most °", 2),
    // Leaves.
    Column::percent("loss", "loss", 2),
    Column::number("depth", "depth", 1),
    Column::number("leaves", "leaves", 0),
    Column::number("cell_edge", "edge", 5),
    Column::number("leaf_distance_mean", "mean distance", 5),
    Column::number("leaf_distance_mean_edges", "mean / edge", 3),
    Column::number("leaf_distance_max_edges", "most / edge", 3),
    Column::number("leaf_distance_bound_edges", "bound / edge", 3),
    Column::number("points_without_leaf", "without leaf", 0),
    // Levels of detail, and voxels beside surfels.
    Column::text("way", "voxels are"),
    Column::number("drawn_voxels", "voxels", 0),
    Column::number("visited_nodes", "visited", 0),
    Column::number("traverse_ms_median", "traverse ms", 3),
    Column::number("traverse_ms_q1", "25 %", 3),
    Column::number("traverse_ms_q3", "75 %", 3),
    Column::percent("object_share", "object", 1),
    Column::number("psnr_db", "PSNR dB", 2),
    Column::number("flip_mean", "FLIP", 4),
    Column::number("flip_object_mean", "FLIP of object", 4),
    Column::number("flip_max", "most", 4),
    Column::number("flip_surfels_mean", "to surfels", 4),
    Column::percent("covered", "covered", 2),
    Column::percent("outside", "outside", 2),
    Column::number("pictures", "pictures", 0).hidden(),
];

/// The column that a bar chart shows.
pub(in crate::bench) const HEADLINE: &str = "flip_object_mean";

/// One step to prepare a frame, one for its leaves, one for its levels of detail at each distance, one for voxels
/// beside surfels.
const STEPS_PER_FRAME: usize = 3 + lod::DISTANCES.len();

pub(in crate::bench) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let subjects = run.subjects(STEPS_PER_FRAME)?;
    run.steps_total += normals::STEPS;
    normals::measure(run)?;
    for subject in &subjects {
        measure_sequence(run, subject)?;
    }
    Ok(())
}

fn measure_sequence(run: &mut Run<'_>, subject: &Subject<'_>) -> Result<(), BenchError> {
    let needs = Needs {
        shapes: true,
        ..Scene::needs(&voxel_settings(0.0))
    };
    let mut leaves = leaves::Samples::default();
    let mut lod: [lod::Samples; lod::DISTANCES.len()] = Default::default();
    let mut closed = closed::Samples::default();
    let mut point_counts = Vec::new();
    let mut first_failure = None;
    for &index in &subject.chosen {
        let frame = match run.load(subject, index, STEPS_PER_FRAME, &needs)? {
            Ok(frame) => frame,
            Err(reason) => {
                first_failure.get_or_insert(reason);
                continue;
            }
        };
        point_counts.push(frame.points.len() as f64);
        run.begin_step(format!("{} frame {index}: leaves", subject.name))?;
        leaves.measure(run, &frame)?;
        for (distance, samples) in lod::DISTANCES.into_iter().zip(&mut lod) {
            run.begin_step(format!(
                "{} frame {index}: levels of detail from {distance} times the distance",
                subject.name
            ))?;
            samples.measure(run, subject, &frame, distance)?;
        }
        run.begin_step(format!(
            "{} frame {index}: voxels beside surfels",
            subject.name
        ))?;
        closed.measure(run, subject, &frame)?;
    }
    Run::check_measured(subject, &point_counts, first_failure)?;
    let lod_rows = lod::DISTANCES
        .into_iter()
        .zip(&lod)
        .flat_map(|(distance, samples)| samples.rows(subject.name, distance));
    let rows = leaves.rows(subject.name).chain(lod_rows);
    let rows = rows.chain(closed.rows(subject.name));
    run.finish(subject, &point_counts, &[], rows.collect::<Vec<_>>());
    Ok(())
}

/// Cells of the paper's δ, drawn down to `lod_px`.
fn voxel_settings(lod_px: f32) -> Style {
    Style {
        levels: LevelStyle {
            lod: Lod::ThresholdPx(lod_px),
            ..paper_voxel_settings().levels
        },
        ..paper_voxel_settings()
    }
}

/// A row of `table` with `cells` under their keys; the other columns are missing.
fn row(table: &str, cells: &[(&str, Cell)]) -> Row {
    debug_assert!(
        cells
            .iter()
            .all(|(key, _)| COLUMNS.iter().any(|column| column.key == *key)),
        "every cell has a column"
    );
    let cell_of = |column: &Column| match cells.iter().find(|(key, _)| *key == column.key) {
        Some((_, cell)) => cell.clone(),
        None if column.key == Column::TABLE => Cell::Text(table.to_owned()),
        None => Cell::Missing,
    };
    Row::new(COLUMNS.iter().map(cell_of).collect())
}
