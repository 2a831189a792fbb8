//! The nodes of a level by their parents.

use crate::reel::tree::{Faces, NO_FACES};

/// Child counts of the nodes of the level above, one after the other; then nodes without siblings whose parent does not
/// determine them, such as the root, and points outside all cells.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) enum Families<'a> {
    /// Families by the masks of the parents.
    Masks(&'a [u8]),
    /// Families by their numbers of children, and the number of nodes outside.
    Counts(&'a [u32], usize),
}

/// Families, and the known data of their parents.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct Above<'a> {
    pub(in crate::reel) families: Families<'a>,
    /// Neighbours across the faces of each parent.
    pub(in crate::reel) faces: &'a [Faces],
}

/// Relation of a parent's value to those of its children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) enum ParentValue {
    /// Their mean: coarse levels look like blurred fine ones.
    Mean,
    /// The value of the first of them, which is then not coded: edges are not blurred into values that nothing below
    /// has. Colours of the walking man take 4.0 instead of 5.1 bits.
    FirstChild,
}

/// The children of a parent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Family {
    pub(super) parent: usize,
    pub(super) count: usize,
    /// Their octants; none of points.
    pub(super) mask: u8,
    /// The parent does not determine them.
    pub(super) is_outside: bool,
}

impl Family {
    /// Returns true if the children are fully determined given the parent.
    pub(super) fn is_clear(self) -> bool {
        self.count <= 1 && !self.is_outside
    }

    /// Returns the number of children that are the parent's value, and not coded.
    #[inline(always)]
    pub(super) fn known(self, parent_value: ParentValue) -> usize {
        usize::from(parent_value == ParentValue::FirstChild && !self.is_outside)
    }

    /// The faces of the parent.
    #[inline(always)]
    pub(super) fn faces(self, faces: &[Faces]) -> Faces {
        faces.get(self.parent).copied().unwrap_or(NO_FACES)
    }
}

/// Families by masks.
#[inline(always)]
pub(super) fn of_masks(masks: &[u8]) -> impl Iterator<Item = Family> + Clone {
    masks.iter().enumerate().map(|(parent, &mask)| Family {
        parent,
        count: mask.count_ones() as usize,
        mask,
        is_outside: false,
    })
}

/// Families by numbers, and those outside.
#[inline(always)]
pub(super) fn of_counts(counts: &[u32], outside: usize) -> impl Iterator<Item = Family> + Clone {
    let family = |parent, count, is_outside| Family {
        parent,
        count,
        mask: 0,
        is_outside,
    };
    let placed = counts.iter().enumerate();
    let placed = placed.map(move |(parent, &count)| family(parent, count as usize, false));
    placed.chain(std::iter::repeat_n(family(0, 1, true), outside))
}

/// The faces of its parent that a child in an octant lies towards.
#[inline(always)]
pub(super) fn across(octant: usize) -> [usize; 3] {
    [octant & 1, 2 + (octant >> 1 & 1), 4 + (octant >> 2 & 1)]
}

/// Returns the neighbours across the faces as a bit mask.
#[inline(always)]
pub(super) fn across_bits(octant: usize) -> u32 {
    across(octant).map(|face| 1 << face).into_iter().sum()
}
