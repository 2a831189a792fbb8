//! Four tables in one report: columns that a table does not use are missing in its rows.

use crate::bench::report::{Cell, Column, Row};

/// Names of the tables.
pub(super) const SIZES: &str = "sizes";
pub(super) const ORDERS: &str = "orders";
pub(super) const DRAWING: &str = "drawing";
pub(super) const EQUAL_TIME: &str = "equal time";

/// Columns of all tables; the first names the table of a row.
pub(super) const COLUMNS: &[Column] = &[
    Column::text(Column::TABLE, "table"),
    Column::text("sequence", "sequence"),
    Column::text("tree", "leaves"),
    Column::text("stream", "stream"),
    Column::text("way", "mode"),
    Column::text("view", "view"),
    Column::number("leaves", "leaves", 0),
    // Sizes.
    Column::number("bits_per_leaf", "bits per leaf", 2),
    Column::number("gzip_bits_per_leaf", "gzip", 2),
    Column::number("gzip_leaf_bits_per_leaf", "gzip, leaves alone", 2),
    Column::text("paper_bits", "paper, bits per point"),
    // Orders.
    Column::number("write_ms_median", "write ms", 3),
    Column::number("decode_ms_median", "decode ms", 3),
    Column::number("decode_mleaves_per_s", "M leaves/s", 1),
    Column::number("culled_decode_ms_median", "half culled ms", 3),
    Column::number("culled_leaves", "leaves of that half", 0),
    // Drawing and equal time.
    Column::number("level", "level", 0),
    Column::number("records", "drawn", 0),
    Column::number("ms_median", "ms", 2),
    Column::number("ms_q1", "25 %", 2).hidden(),
    Column::number("ms_q3", "75 %", 2).hidden(),
    Column::number("mrecords_per_s", "M per s", 2),
    Column::number("psnr_db", "PSNR dB", 2),
    Column::number("samples", "pictures", 0).hidden(),
];

/// A row of `table` with `cells` under their keys; the other columns are missing.
pub(super) fn row(table: &str, cells: &[(&str, Cell)]) -> Row {
    Row::of_table(COLUMNS, table, cells)
}
