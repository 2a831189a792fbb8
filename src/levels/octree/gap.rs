//! A cell that is drawn without points of its own.

/// A cell without points that is drawn as a leaf beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// The first point of the leaf, and the one after its last.
    pub(super) leaf: [u32; 2],
    pub(super) level: u8,
    /// Where the cell is from the leaf, of 27 directions.
    pub(super) direction: u8,
}
