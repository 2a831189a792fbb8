//! The cube of a group, in f64, and its cells.

use glam::DVec3;

/// The cube that all frames of a group are divided in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::reel) struct Grid {
    /// Smallest corner, in the coordinates of the file.
    pub(in crate::reel) min: DVec3,
    /// Edge of the cells of the deepest level.
    pub(in crate::reel) cell: f64,
    /// Levels of the tree below the root: at most 21.
    pub(in crate::reel) depth: u32,
}

impl Grid {
    /// The cell of a point along an axis.
    pub(in crate::reel) fn index(&self, axis: usize, coordinate: f64) -> u64 {
        let max = (1u64 << self.depth) - 1;
        let index = ((coordinate - self.min[axis]) / self.cell).floor();
        if index >= 0.0 { (index as u64).min(max) } else { 0 }
    }

    /// Returns the coordinate at which a cell begins along an axis.
    pub(in crate::reel) fn border(&self, axis: usize, index: u64) -> f64 {
        self.min[axis] + index as f64 * self.cell
    }

    /// Returns the centre of a cell of a level by its coordinates.
    pub(in crate::reel) fn center(&self, level: u32, cell: [u32; 3]) -> DVec3 {
        let edge = self.edge(level);
        let cell = DVec3::from_array(cell.map(f64::from));
        self.min + (cell + 0.5) * edge
    }

    /// Edge of the cells of a level.
    pub(in crate::reel) fn edge(&self, level: u32) -> f64 {
        self.cell * f64::from(1u32 << (self.depth - level.min(self.depth)))
    }

    /// Returns true if coordinates can be computed with the grid.
    pub(in crate::reel) fn is_usable(&self) -> bool {
        self.depth <= 21 && self.min.is_finite() && self.cell > 0.0 && (self.cell * (1u64 << 54) as f64).is_finite()
    }
}
