//! Named columns of numbers, wherever they lie, and what their names mean; from columns to arrays of a cloud. Knows no
//! format.

pub(super) mod arrays;
pub(super) mod attributes;
pub(super) mod column;
pub(super) mod column_map;
pub(super) mod column_names;
pub(super) mod fixed_rows;
pub(super) mod growing;
pub(super) mod likeness;
pub(super) mod numbers;
pub(super) mod unique_names;
