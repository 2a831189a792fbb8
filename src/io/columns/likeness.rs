//! Numbers in rows that are not points: poses, and images or grids of values.

/// Number of rows whose values are examined.
const MAX_ROWS: usize = 1024;

/// The layout of poses, by their values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Poses {
    /// A time, a position and a quaternion.
    Stamped,
    /// The first three rows of a matrix.
    ThreeByFour,
    /// All four.
    FourByFour,
}

impl Poses {
    /// Returns the description of a row of poses, with its article.
    pub(in crate::io) fn row(self) -> &'static str {
        match self {
            Self::Stamped => "a growing number, a position and a unit quaternion",
            Self::ThreeByFour => "a rotation and a translation (3 × 4)",
            Self::FourByFour => "a rotation and a translation (4 × 4)",
        }
    }
}

/// The layout of the poses that the rows of `columns` are; `None` where they are something else.
pub(in crate::io) fn poses(columns: &[Vec<f64>]) -> Option<Poses> {
    const TOLERANCE: f64 = 2e-3;
    let rows = columns.first()?.len().min(MAX_ROWS);
    if rows < 2 {
        return None;
    }
    let is_near = |value: f64, expected: f64| (value - expected).abs() < TOLERANCE;
    let all = |is: &dyn Fn(usize) -> bool| (0..rows).all(is);
    let is_unit = |row: usize, of: &[usize]| {
        let squares = of.iter().map(|&column| columns[column][row].powi(2));
        is_near(squares.sum(), 1.0)
    };
    let is_rotation = |row: usize| {
        let dot = |one: usize, other: usize| {
            let products = (0..3).map(|axis| columns[4 * one + axis][row] * columns[4 * other + axis][row]);
            products.sum::<f64>()
        };
        (0..3).all(|axis| is_unit(row, &[4 * axis, 4 * axis + 1, 4 * axis + 2]))
            && [(0, 1), (0, 2), (1, 2)]
                .into_iter()
                .all(|(one, other)| is_near(dot(one, other), 0.0))
    };
    let is_last_row = |row: usize| (0..4).all(|column| columns[12 + column][row] == f64::from(column == 3));
    let grows = || columns[0][..rows].is_sorted_by(|one, next| one < next);
    match columns.len() {
        8 if grows() && all(&|row| is_unit(row, &[4, 5, 6, 7])) => Some(Poses::Stamped),
        12 if all(&is_rotation) => Some(Poses::ThreeByFour),
        16 if all(&is_rotation) && all(&is_last_row) => Some(Poses::FourByFour),
        _ => None,
    }
}

/// Returns true if three rows of three numbers are a camera matrix.
pub(in crate::io) fn is_camera_matrix(columns: &[Vec<f64>]) -> bool {
    /// Pixels. The corners of a triangle are nearer to each other.
    const MIN_FOCAL_LENGTH: f64 = 10.0;
    let [x, y, z] = columns else { return false };
    let is_column = |column: &[f64], below: [Option<f64>; 3]| {
        let fits = |(value, below): (&f64, Option<f64>)| below.is_none_or(|below| *value == below);
        column.len() == 3 && column.iter().zip(below).all(fits)
    };
    is_column(x, [None, Some(0.0), Some(0.0)])
        && is_column(y, [None, None, Some(0.0)])
        && is_column(z, [None, None, Some(1.0)])
        && x[0] >= MIN_FOCAL_LENGTH
        && y[1] >= MIN_FOCAL_LENGTH
}

/// Fewer columns are a table.
const MIN_GRID_COLUMNS: usize = 16;
const MIN_GRID_ROWS: usize = 4;

/// Returns true if `columns` are an image or a grid: all hold similar values, or values change little from one column
/// to the next, also among the first ones, where a table of points has its coordinates.
pub(in crate::io) fn is_grid(columns: &[Vec<f64>]) -> bool {
    let width = columns.len();
    let rows = columns.first().map_or(0, Vec::len);
    width >= MIN_GRID_COLUMNS && rows >= MIN_GRID_ROWS && (are_alike(columns) || are_smooth(columns))
}

/// Returns true if nearly all columns have values of about the same size and spread, the first three of them too.
fn are_alike(columns: &[Vec<f64>]) -> bool {
    /// Maximum offset as a fraction of the spread of all columns.
    const MAX_OFFSET: f64 = 0.5;
    const MAX_RATIO: f64 = 2.0;
    let ranges: Option<Vec<[f64; 3]>> = columns.iter().map(|column| quantiles(column)).collect();
    let Some(ranges) = ranges else { return false };
    let spread = |[low, _, high]: &[f64; 3]| high - low;
    let median = |values: Vec<f64>| quantiles(&values).map_or(f64::NAN, |[_, median, _]| median);
    let usual = median(ranges.iter().map(spread).collect());
    let center = median(ranges.iter().map(|[_, median, _]| *median).collect());
    let is_alike = |range: &[f64; 3]| {
        let ratio = spread(range) / usual;
        (1.0 / MAX_RATIO..=MAX_RATIO).contains(&ratio) && (range[1] - center).abs() <= MAX_OFFSET * usual
    };
    let alike = ranges.iter().filter(|range| is_alike(range)).count();
    usual > 0.0 && alike * 10 >= columns.len() * 9 && ranges[..3].iter().all(is_alike)
}

/// Returns true if values change much less from one column to the next than between columns that are far apart.
fn are_smooth(columns: &[Vec<f64>]) -> bool {
    const MAX_STEP: f64 = 0.6;
    let width = columns.len();
    let rows = columns[0].len().min(MAX_ROWS);
    let step = |one: usize, other: usize| {
        let steps = (0..rows)
            .map(|row| (columns[one][row] - columns[other][row]).abs())
            .collect::<Vec<f64>>();
        quantiles(&steps).map_or(f64::NAN, |[_, median, _]| median)
    };
    let median = |steps: Vec<f64>| quantiles(&steps).map_or(f64::NAN, |[_, median, _]| median);
    let far = median(
        (0..width)
            .map(|column| step(column, (column + width / 2) % width))
            .collect(),
    );
    let next = median((1..width).map(|column| step(column - 1, column)).collect());
    let of_first = (1..4).all(|column| step(column - 1, column) <= MAX_STEP * far);
    far > 0.0 && next <= MAX_STEP * far && of_first
}

/// A tenth of the known values are below the first, half below the second, nine tenths below the third.
fn quantiles(values: &[f64]) -> Option<[f64; 3]> {
    let mut known: Vec<f64> = values
        .iter()
        .copied()
        .take(MAX_ROWS)
        .filter(|value| value.is_finite())
        .collect();
    known.sort_by(f64::total_cmp);
    let last = known.len().checked_sub(1)?;
    Some([0.1, 0.5, 0.9].map(|part| known[(part * last as f64).round() as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(rows: usize, width: usize, value: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
        (0..width)
            .map(|column| (0..rows).map(|row| value(row, column)).collect())
            .collect()
    }

    /// Some number from 0 to 1.
    fn noise(row: usize, column: usize) -> f64 {
        ((row * 7919 + column * 104_729) % 1009) as f64 / 1009.0
    }

    #[test]
    fn poses_are_recognised_by_their_values() {
        let stamped = columns(9, 8, |row, column| match column {
            0 => 1e9 + row as f64 * 0.1,
            4 => 0.6,
            7 => -0.8,
            5 | 6 => 0.0,
            _ => noise(row, column),
        });
        assert_eq!(poses(&stamped), Some(Poses::Stamped));
        // Rotations around z.
        let matrix = |row: usize, column: usize| {
            let (sine, cosine) = (0.1 * row as f64).sin_cos();
            match column {
                0 | 5 => cosine,
                1 => -sine,
                4 => sine,
                10 | 15 => 1.0,
                3 | 7 | 11 => noise(row, column),
                _ => 0.0,
            }
        };
        assert_eq!(poses(&columns(9, 12, matrix)), Some(Poses::ThreeByFour));
        assert_eq!(poses(&columns(9, 16, matrix)), Some(Poses::FourByFour));
        for width in [3, 8, 12, 16] {
            assert_eq!(poses(&columns(9, width, noise)), None);
        }
    }

    #[test]
    fn camera_matrices_are_recognised() {
        let camera = [vec![525.0, 0.0, 0.0], vec![0.0, 525.0, 0.0], vec![319.5, 239.5, 1.0]];
        assert!(is_camera_matrix(&camera));
        assert!(!is_camera_matrix(&[
            vec![1.0, 4.0, 7.0],
            vec![2.0, 5.0, 8.0],
            vec![3.0, 6.0, 9.0]
        ]));
    }

    #[test]
    fn grids_have_similar_or_smooth_columns() {
        let hills = |row: usize, column: usize| 10.0 * (0.3 * column as f64).sin() + 0.5 * noise(row, column);
        assert!(is_grid(&columns(30, 30, hills)));
        assert!(is_grid(&columns(48, 64, noise)));
        assert!(!is_grid(&columns(48, 12, noise)));
        // Coordinates followed by a spectrum, by descriptors, and by counts.
        let spectrum = |row: usize, column: usize| match column {
            0..3 => 20.0 * noise(row, column),
            _ => (0.1 * column as f64).sin() + 0.02 * noise(row, column),
        };
        assert!(!is_grid(&columns(48, 64, spectrum)));
        let features = |row: usize, column: usize| match column {
            0..3 => 20.0 * noise(row, column),
            _ => noise(row, column),
        };
        assert!(!is_grid(&columns(48, 36, features)));
    }
}
