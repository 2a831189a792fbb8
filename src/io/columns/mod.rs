//! Named columns of numbers, in any layout, and the meanings of their names; from columns to arrays of a cloud.
//! Independent of formats.

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
