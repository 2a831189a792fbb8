//! The tables of the suite and their columns.

use crate::bench::report::{Cell, Column, Row};

/// Table of held-out images, compared with renderings from their viewpoints.
pub(super) const SKIPPED: &str = "held out";
/// Table 2 of the paper.
pub(super) const SIZES: &str = "sizes";
/// Fig. 10.
pub(super) const CLIPPED: &str = "clipping";
/// Fig. 5.
pub(super) const FILTERED: &str = "filtering";

/// Columns of all tables; the first names the table of a row.
pub(super) const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    Column::text("sequence", "sequence"),
    Column::text("photo", "image"),
    Column::number("number", "number", 0).hidden(),
    Column::text("view", "view"),
    Column::text("mode", "mode"),
    Column::text("clipping", "clipping"),
    Column::text("filter", "filter"),
    Column::number("points", "points", 0),
    Column::number("photographs", "images", 0),
    Column::number("bytes", "bytes", 0),
    Column::number("width", "width", 0).hidden(),
    Column::number("height", "height", 0).hidden(),
    Column::number("covered", "covered", 3),
    Column::percent("extra_share", "too much", 2),
    Column::percent("hole_share", "holes", 2),
    Column::number("psnr_db", "PSNR, dB", 2),
    Column::number("flip", "FLIP", 4),
    Column::number("ms", "ms", 1),
    Column::number("ms_q3", "75 %", 1).hidden(),
];

/// A row of a table.
pub(super) fn row(table: &str, cells: &[(&str, Cell)]) -> Row {
    Row::of_table(COLUMNS, table, cells)
}
