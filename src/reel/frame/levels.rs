//! A frame as whole numbers on every level.

/// Nodes of an octree level and their attributes. Arrays of attributes that a frame does not have are empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct Level {
    /// Occupied octants, of all levels but the deepest.
    pub(in crate::reel) masks: Vec<u8>,
    /// Morton codes with the bits of the level.
    pub(in crate::reel) cells: Vec<u64>,
    pub(in crate::reel) values: LevelValues,
}

/// Attributes of the nodes of a level, or of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct LevelValues {
    /// Green, red, blue.
    pub(in crate::reel) colors: Vec<[u16; 3]>,
    /// Places of the normal grid.
    pub(in crate::reel) normals: Vec<[i16; 2]>,
    /// Codes of offsets, of the deepest level alone.
    pub(in crate::reel) offsets: Vec<u8>,
    /// Alpha, radius, scalars: those that there are.
    pub(in crate::reel) singles: Vec<Vec<[u16; 1]>>,
}

/// Attributes of the last nodes of a frame, or of its points.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct FlatValues {
    /// Red, green, blue and 255.
    pub(super) colors: Vec<[u8; 4]>,
    /// Triangles, each of half cells and, from bit 16 on, of cells; or [`NO_NORMAL`](crate::reel::fast::NO_NORMAL).
    pub(super) normals: Vec<u32>,
    /// Alpha, radius, scalars: those that there are.
    pub(super) singles: Vec<Vec<[u16; 1]>>,
}

/// Individually stored points, in the order of their cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct PosePoints {
    /// Points of each cell, one or more.
    pub(in crate::reel) counts: Vec<u32>,
    /// Number of the bits below it that the points of each cell lack, if cells state that.
    pub(in crate::reel) missing_bits: Vec<u8>,
    /// Bits of the position below the cell, or the rank among the floats in it.
    pub(in crate::reel) below: Vec<[u64; 3]>,
    /// Coordinates, as bits, of points that are in no cell; they follow all others.
    pub(in crate::reel) outside: Vec<[u64; 3]>,
    pub(in crate::reel) values: LevelValues,
    /// Normals, radii, ellipses and scalars as they are: a column each of bits of f32.
    pub(in crate::reel) columns: Vec<Vec<u32>>,
    /// The index in the file of each point.
    pub(in crate::reel) order: Vec<u32>,
}

impl PosePoints {
    /// The cell of each point that is in one, and the bits below it that the point lacks. `cells` are all cells.
    pub(super) fn cell_of_each<'a>(&'a self, cells: &'a [u64]) -> impl Iterator<Item = (u64, u8)> + 'a {
        let missing = self.missing_bits.iter().copied().chain(std::iter::repeat(0));
        let cells = cells.iter().zip(missing).zip(&self.counts);
        cells.flat_map(|((&cell, missing), &count)| std::iter::repeat_n((cell, missing), count as usize))
    }

    pub(in crate::reel) fn len(&self) -> usize {
        self.below.len() + self.outside.len()
    }
}

/// A frame as it is coded.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct Pose {
    /// From the root down.
    pub(in crate::reel) levels: Vec<Level>,
    pub(in crate::reel) points: Option<PosePoints>,
    /// Attributes of the last level, or of the points, if they were read by the fast coding.
    pub(in crate::reel) flat: Option<FlatValues>,
}

impl Pose {
    /// Nodes of each level.
    pub(in crate::reel) fn counts(&self) -> Vec<usize> {
        self.levels.iter().map(|level| level.cells.len()).collect()
    }

    /// Leaves the first levels alone.
    pub(in crate::reel) fn truncate(&mut self, levels: usize) {
        if levels < self.levels.len() {
            self.levels.truncate(levels);
            self.flat = None;
        }
    }
}
