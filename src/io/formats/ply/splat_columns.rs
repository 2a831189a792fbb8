//! Columns of splats, taken by their names.

use crate::io::columns::column::Column;

/// Removes the column of this name from `columns`.
pub(super) fn take<'a>(columns: &mut Vec<Column<'a>>, name: &str) -> Option<Column<'a>> {
    let place = columns.iter().position(|column| column.name == name)?;
    Some(columns.remove(place))
}

/// Removes the columns of these names, if all exist.
pub(super) fn take_all<'a, const N: usize>(columns: &mut Vec<Column<'a>>, names: [&str; N]) -> Option<[Column<'a>; N]> {
    let is_there = |name: &&str| columns.iter().any(|column| column.name == *name);
    if !names.iter().all(is_there) {
        return None;
    }
    let taken: Vec<Column<'a>> = names.iter().filter_map(|name| take(columns, name)).collect();
    taken.try_into().ok()
}
