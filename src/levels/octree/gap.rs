//! A cell that is drawn without having points.

/// A gap: a cell without points that is drawn like an adjacent leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// The first point of the leaf, and the one after its last.
    pub(super) leaf: [u32; 2],
    pub(super) level: u8,
    /// Direction from the leaf to the cell, one of 27.
    pub(super) direction: u8,
}
