//! Columns without names: their number and their values determine their meaning.
//!
//! | columns | meaning |
//! |---|---|
//! | 3 | x y z |
//! | 4 | x y z scalar |
//! | 6 and more | x y z, and behind that a normal where three columns are of unit length, and a colour where three are integers from 0 to 255 or fractions from 0 to 1, with alpha or without; the others are scalars |
//!
//! Seven columns of integers are `x y z scalar red green blue`, as in `.pts`, unless the last is alpha.

/// Number of columns whose values are examined.
pub(in crate::io) const MAX_GUESSED_COLUMN: usize = 16;

const COLOR: [&str; 3] = ["red", "green", "blue"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// Tables with more columns have no usual order.
const MAX_USUAL_COLUMNS: usize = 12;

/// Names by values alone. Of columns from `MAX_GUESSED_COLUMN` on no values are needed.
pub(in crate::io) fn guessed_names(columns: &[Vec<f64>]) -> Vec<String> {
    let width = columns.len();
    let mut names: Vec<Option<&str>> = vec![None; width];
    for (name, axis) in names.iter_mut().zip(["x", "y", "z"]) {
        *name = Some(axis);
    }
    if width == 4 {
        names[3] = Some("scalar");
    }
    let take = |names: &mut Vec<Option<&'static str>>, first: usize, roles: &[&'static str]| {
        for (name, role) in names[first..].iter_mut().zip(roles) {
            *name = Some(role);
        }
    };
    let is_free = |names: &[Option<&str>], first: usize| names[first..first + 3].iter().all(Option::is_none);
    let last = width.min(MAX_GUESSED_COLUMN);
    let triples = || (3..last.saturating_sub(2)).map(|first| (first, &columns[first..first + 3]));
    let normal = triples().find(|(_, values)| is_unit_length(values) && !is_bytes(values));
    if let Some((first, _)) = normal {
        take(&mut names, first, &NORMAL);
    }
    let color = |names: &[Option<&str>], is_color: fn(&[Vec<f64>]) -> bool| {
        let fits = |(first, values): &(usize, &[Vec<f64>])| is_free(names, *first) && is_color(values);
        let found: Vec<usize> = triples().filter(fits).map(|(first, _)| first).collect();
        // Intensity and colour as in `.pts`, unless the last column is alpha: then all four are in range, too.
        let has_alpha = width == 7 && is_alpha(&columns[6]);
        match found.as_slice() {
            [3, 4, ..] if width == 7 && !has_alpha => Some(4),
            [first, ..] => Some(*first),
            [] => None,
        }
    };
    let found = if width <= MAX_USUAL_COLUMNS {
        match color(&names, is_bytes) {
            // Normals along axes are whole numbers as well: fractions elsewhere are more likely a colour.
            Some(first) if is_unit_length(&columns[first..first + 3]) => color(&names, is_fractions).or(Some(first)),
            Some(first) => Some(first),
            None => color(&names, is_fractions).or_else(|| color(&names, are_wide_bytes)),
        }
    } else {
        color(&names, is_bright_bytes)
    };
    if let Some(first) = found {
        take(&mut names, first, &COLOR);
        if first + 3 < last && names[first + 3].is_none() && is_alpha(&columns[first + 3]) {
            names[first + 3] = Some("alpha");
        }
    }
    // Whole numbers may be normals along axes where the colour is elsewhere.
    if normal.is_none()
        && let Some((first, _)) = triples().find(|(first, values)| is_free(&names, *first) && is_unit_length(values))
    {
        take(&mut names, first, &NORMAL);
    }
    // The remaining number before or after the colour, as in the files of scanners.
    if width == 7 && names.iter().filter(|name| name.is_none()).count() == 1 {
        for name in names.iter_mut().filter(|name| name.is_none()) {
            *name = Some("scalar");
        }
    }
    let named = names.iter().enumerate().map(|(index, name)| match name {
        Some(name) => (*name).to_owned(),
        None => format!("value_{}", index + 1),
    });
    named.collect()
}

/// Known values of a column.
fn known(column: &[f64]) -> impl Iterator<Item = f64> {
    column.iter().copied().filter(|value| !value.is_nan())
}

fn has_values(columns: &[Vec<f64>]) -> bool {
    columns.iter().all(|column| known(column).next().is_some())
}

fn is_bytes(columns: &[Vec<f64>]) -> bool {
    let is_byte = |value: f64| value.fract() == 0.0 && (0.0..=255.0).contains(&value);
    has_values(columns) && columns.iter().all(|column| known(column).all(is_byte))
}

/// Bytes that were made 16 bits wide: multiples of 256 or 257, and not all of them zero.
fn are_wide_bytes(columns: &[Vec<f64>]) -> bool {
    const MAX: f64 = 65_535.0;
    let are_multiples = |of: f64| {
        let is_multiple = |value: f64| (0.0..=MAX).contains(&value) && value % of == 0.0;
        columns.iter().all(|column| known(column).all(is_multiple))
    };
    has_values(columns)
        && columns.iter().any(|column| known(column).any(|value| value > 0.0))
        && (are_multiples(256.0) || are_multiples(257.0))
}

/// Labels and counters are small, colours are not.
fn is_bright_bytes(columns: &[Vec<f64>]) -> bool {
    const BRIGHT: f64 = 100.0;
    is_bytes(columns) && columns.iter().all(|column| known(column).any(|value| value > BRIGHT))
}

/// Fractions from 0 to 1, and not all of them zero.
fn is_fractions(columns: &[Vec<f64>]) -> bool {
    let is_fraction = |value: f64| (0.0..=1.0).contains(&value);
    has_values(columns)
        && columns.iter().all(|column| known(column).all(is_fraction))
        && columns.iter().any(|column| known(column).any(|value| value > 0.0))
}

/// Full opacity in most points.
fn is_alpha(column: &[f64]) -> bool {
    let opaque = known(column).filter(|value| *value == 255.0 || *value == 1.0).count();
    let in_range = known(column).all(|value| (0.0..=255.0).contains(&value));
    in_range && opaque * 2 > column.len()
}

fn is_unit_length(columns: &[Vec<f64>]) -> bool {
    /// Normals are often written with three digits.
    const TOLERANCE: f64 = 0.02;
    let is_unit = |row: usize| {
        let length = columns
            .iter()
            .map(|column| column[row] * column[row])
            .sum::<f64>()
            .sqrt();
        length.is_nan() || (length - 1.0).abs() < TOLERANCE
    };
    has_values(columns) && (0..columns[0].len()).all(is_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the columns of `text`, with one point per line.
    fn names(text: &str) -> Vec<String> {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .map(|line| line.split(' ').map(|token| token.parse().unwrap()).collect())
            .collect();
        let columns: Vec<Vec<f64>> = (0..rows[0].len())
            .map(|column| rows.iter().map(|row| row[column]).collect())
            .collect();
        guessed_names(&columns)
    }

    #[test]
    fn unnamed_columns_are_recognised_by_their_values() {
        for (text, expected) in [
            ("1 2 3", "x y z"),
            ("1 2 3 4", "x y z scalar"),
            ("1 2 3 4 5", "x y z value_4 value_5"),
            ("1 2 3 255 0 1", "x y z red green blue"),
            ("1 2 3 0.5 0.25 0.5", "x y z red green blue"),
            ("1 2 3 0.6 0 -0.8", "x y z nx ny nz"),
            // One red point, or one normal along x: eight-bit colour is the better guess.
            ("1 2 3 1 0 0", "x y z red green blue"),
            ("1 2 3 -900 255 0 1", "x y z scalar red green blue"),
            ("1 2 3 9 255 0 1\n1 2 3 9 255 0 7", "x y z scalar red green blue"),
            ("1 2 3 255 0 1 0.5", "x y z red green blue scalar"),
            ("1 2 3 23130 0 257", "x y z red green blue"),
            ("1 2 3 9 23040 256 0\n1 2 3 8 256 0 0", "x y z scalar red green blue"),
            ("1 2 3 25 0 1 255", "x y z red green blue alpha"),
            ("1 2 3 0.5 0.25 0 1.0", "x y z red green blue alpha"),
            ("1 2 3 255 0 1 0 0 1", "x y z red green blue nx ny nz"),
            ("1 2 3 0 0.6 0.8 255 0 1", "x y z nx ny nz red green blue"),
            ("1 2 3 0.25 1 0.5 0 0 1", "x y z red green blue nx ny nz"),
            ("1 2 3 7.5 0 0.6 0.8", "x y z scalar nx ny nz"),
            ("1 2 3 0 0.6 0.8 7.5", "x y z nx ny nz scalar"),
            ("1 2 3 25 0 1 255 0 0.6 0.8", "x y z red green blue alpha nx ny nz"),
            // Velocities and similar values are neither colours nor normals.
            ("1 2 3 -4 5.5 300", "x y z value_4 value_5 value_6"),
            ("1 2 3 0 0 0.0\n1 2 3 0.5 700 1", "x y z value_4 value_5 value_6"),
        ] {
            assert_eq!(names(text).join(" "), expected, "{text}");
        }
    }
}
