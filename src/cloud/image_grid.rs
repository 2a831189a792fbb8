//! The grid of an organised cloud: points in the lines of an image, as a camera or a scanner saw them.

use serde::Serialize;
use std::fmt;

/// Image grid of an organised cloud: number of points per line of the file and number of lines, both more than one.
///
/// The cell of a point is given by its index in the file, holes without coordinates counted. The order in memory is
/// another one: `grid.cell(frame.file_index()[slot])` leads from a point of a [`super::Frame`] to its cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ImageGrid {
    width: u32,
    height: u32,
}

impl ImageGrid {
    /// The grid of `point_count` points; `None` where they are another number, and where all are in one line.
    pub fn of(width: u32, height: u32, point_count: usize) -> Option<Self> {
        let has_all = u64::from(width) * u64::from(height) == point_count as u64;
        (width > 1 && height > 1 && has_all).then_some(Self { width, height })
    }

    /// Points in a line of the file.
    pub fn width(self) -> u32 {
        self.width
    }

    /// Lines.
    pub fn height(self) -> u32 {
        self.height
    }

    /// Column and row of the point with this index in the file.
    pub fn cell(self, file_index: u32) -> [u32; 2] {
        [file_index % self.width, file_index / self.width]
    }
}

impl fmt::Display for ImageGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_numbered_row_by_row() {
        let grid = ImageGrid::of(3, 2, 6).unwrap();
        let cells: Vec<[u32; 2]> = (0..6).map(|index| grid.cell(index)).collect();
        assert_eq!(cells, [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]);
        assert_eq!(grid.to_string(), "3 × 2");
    }

    #[test]
    fn lists_and_wrong_headers_have_no_grid() {
        for (width, height, points) in [
            (6, 1, 6),
            (1, 6, 6),
            (0, 0, 0),
            (3, 2, 5),
            (1 << 31, 2, 0),
            (1 << 16, 1 << 16, 0),
        ] {
            assert_eq!(
                ImageGrid::of(width, height, points),
                None,
                "{width} × {height} for {points}"
            );
        }
    }
}
