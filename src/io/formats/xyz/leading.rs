//! Columns before the coordinates, where nothing names the columns: numbers of points, rows and columns of a
//! scanner's grid, elements of atoms.

use super::head::Head;
use super::rows::Kind;
use crate::assumption::{Assumption, Evidence, Subject};

/// Fewer rows may be like that by chance.
const MIN_ROWS: usize = 8;

/// The columns before the coordinates.
pub(super) struct Leading {
    pub(super) names: &'static [&'static str],
    /// True if the columns are a mere index, without information about the points.
    pub(super) is_index: bool,
    pub(super) assumption: Assumption,
}

/// Returns the leading columns of the rows of `head`, which are atoms or tracks after counts if they are `counted`.
pub(super) fn leading(head: &Head, is_counted: bool) -> Option<Leading> {
    let sample = &head.sample;
    let is_gromacs = head.claimed.is_some()
        && head.kinds.starts_with(&[Kind::Text, Kind::Text])
        && matches!(sample.len(), 6 | 9)
        && head.kinds[2..].iter().all(|kind| *kind == Kind::Number)
        && are_whole(&sample[2]);
    if is_gromacs {
        let value = "residue atom index x y z";
        let why = "a title, a count and rows that start with a residue and an atom: a structure of GROMACS";
        let assumption = Assumption::new(Subject::Columns, value, why, Evidence::Convention);
        return Some(Leading {
            names: &["residue", "atom", "index"],
            is_index: false,
            assumption,
        });
    }
    let are_numbers = head.kinds.iter().take(4).all(|kind| *kind == Kind::Number);
    if sample.len() < 4 || !are_numbers {
        return None;
    }
    let of = |names, is_index, value: &str, why: &str| Leading {
        names,
        is_index,
        assumption: Assumption::new(Subject::Columns, value, why, Evidence::Statistics),
    };
    if is_counted && are_elements(sample) {
        let why = "a count, a comment and rows that start with a small whole number: a molecule in XYZ format";
        return Some(of(
            &["element"],
            false,
            "column 0 is the element or type of an atom",
            why,
        ));
    }
    if counts_rows(sample) {
        let value = "column 0 is the index of the rows and is ignored";
        return Some(of(&["index"], true, value, "it counts the rows one by one"));
    }
    if sample.len() >= 5 && head.kinds[4] == Kind::Number && are_places_in_grid(sample) {
        let value = "columns 0 and 1 are the row and column of a scanner's grid, x y z are columns 2, 3 and 4";
        let why = "they are whole numbers of which one counts on from point to point";
        return Some(of(&["row", "column"], false, value, why));
    }
    None
}

fn known(column: &[f64]) -> impl Iterator<Item = f64> + Clone {
    column.iter().copied().filter(|value| !value.is_nan())
}

fn are_whole(column: &[f64]) -> bool {
    known(column).all(|value| value.fract() == 0.0)
}

fn is_constant(column: &[f64]) -> bool {
    let mut values = known(column);
    let first = values.next();
    first.is_none_or(|first| values.all(|value| value == first))
}

/// Atomic numbers or types before coordinates with fractions.
fn are_elements(sample: &[Vec<f64>]) -> bool {
    const MAX_ELEMENT: f64 = 118.0;
    let is_element = |value: f64| value.fract() == 0.0 && (1.0..=MAX_ELEMENT).contains(&value);
    known(&sample[0]).all(is_element) && sample[1..4].iter().any(|column| !are_whole(column))
}

/// 0, 1, 2 and so on, or from 1 on, before coordinates: a line of points along x has the same y everywhere.
fn counts_rows(sample: &[Vec<f64>]) -> bool {
    let first = &sample[0];
    let start = first.first().copied().unwrap_or(f64::NAN);
    let counts = first
        .iter()
        .enumerate()
        .all(|(row, value)| *value == start + row as f64);
    let is_start = start == 0.0 || start == 1.0;
    let are_coordinates =
        sample[1..3].iter().all(|column| !is_constant(column)) && sample[1..4].iter().any(|column| !are_whole(column));
    first.len() >= MIN_ROWS && is_start && counts && are_coordinates
}

/// Two columns of integers, one counting up by one while the other stays, before three of fractions that are not z
/// followed by a normal.
fn are_places_in_grid(sample: &[Vec<f64>]) -> bool {
    let places = &sample[..2];
    let is_place = |column: &Vec<f64>| known(column).all(|value| value.fract() == 0.0 && value >= 0.0);
    let rows = places[0].len();
    if rows < MIN_ROWS || !places.iter().all(is_place) || sample[2..5].iter().any(|column| are_whole(column)) {
        return false;
    }
    let steps = |one: &[f64], other: &[f64]| {
        let is_step = |row: &usize| one[*row] - one[row - 1] == 1.0 && other[*row] == other[row - 1];
        (1..rows).filter(is_step).count() * 2 >= rows
    };
    let is_unit = |row: usize| {
        let length = sample[3..6].iter().map(|column| column[row].powi(2)).sum::<f64>();
        (length - 1.0).abs() < 0.02
    };
    let has_normals = sample.len() == 6 && (0..rows).all(is_unit);
    (steps(&places[0], &places[1]) || steps(&places[1], &places[0])) && !has_normals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str, is_counted: bool) -> Option<String> {
        let head = Head::read(text.as_bytes()).unwrap();
        leading(&head, is_counted).map(|leading| leading.names.join(" "))
    }

    fn rows(row: impl Fn(usize) -> String) -> String {
        (0..20).map(|index| row(index) + "\n").collect()
    }

    #[test]
    fn columns_before_the_coordinates_are_recognised_by_their_values() {
        let index = rows(|i| format!("{} {}.5 {} {} 9", i + 1, i * 7 % 11, i * 5 % 13, i * 3 % 7));
        assert_eq!(names(&index, false).as_deref(), Some("index"));
        let grid = rows(|i| format!("0 {i} {}.5 {}.25 {}.75 9 8 7", i * 7 % 11, i * 5 % 13, i * 3 % 7));
        assert_eq!(names(&grid, false).as_deref(), Some("row column"));
        let gromacs = "Title\n2\n1WATER OW1 1 0.1 1.6 1.7\n1WATER HW2 2 0.2 1.7 1.8\n";
        assert_eq!(names(gromacs, false).as_deref(), Some("residue atom index"));
        let atoms = "8 0.5 0 0.25\n1 0.5 1 0.25\n";
        assert_eq!(names(atoms, true).as_deref(), Some("element"));
        assert_eq!(names(atoms, false), None);
        // A profile along x, a raster with normals, and whole numbers.
        for other in [
            rows(|i| format!("{i} 4 {}.5 9", i * 3 % 7)),
            rows(|i| format!("{i} 4 {}.5 0.6 0.0 0.8", i * 3 % 7)),
            rows(|i| format!("{i} {} {} 9", i * 7 % 11, i * 5 % 13)),
            rows(|i| format!("{}.5 {} {} 9", i, i * 7 % 11, i * 5 % 13)),
        ] {
            assert_eq!(names(&other, false), None, "{other}");
        }
    }
}
