//! Four tables in one report: columns that a table does not use are missing in its rows.

use crate::bench::report::{Cell, Column, Row};

/// Names of the tables.
pub(super) const NORMALS: &str = "normals";
pub(super) const LEAVES: &str = "leaves";
pub(super) const LOD: &str = "lod";
pub(super) const CLOSED: &str = "closed";

/// Columns of all tables; the first names the table of a row.
pub(super) const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    // Normals.
    Column::text("shape", "shape"),
    Column::percent("noise", "noise", 1),
    Column::percent("outliers", "outliers", 0),
    Column::number("neighbours", "k", 0),
    Column::text("chosen", "chosen"),
    Column::number("noise_found", "noise in spacings", 2),
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
    // Levels of detail, and voxels compared with surfels.
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
    Column::number("flip_over_time", "FLIP over time", 4),
    Column::number("flip_surfels_mean", "to surfels", 4),
    Column::percent("covered", "covered", 2),
    Column::percent("outside", "outside", 2),
    Column::number("pictures", "pictures", 0).hidden(),
];

/// A row of `table` with `cells` under their keys; the other columns are missing.
pub(super) fn row(table: &str, cells: &[(&str, Cell)]) -> Row {
    Row::of_table(COLUMNS, table, cells)
}
