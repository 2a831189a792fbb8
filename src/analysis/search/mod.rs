//! The points around a point: a k-d tree of buckets, k nearest neighbours, the nearest point of a place. Knows
//! positions alone.

pub(super) mod bucket_search;
pub(super) mod lanes;
pub(super) mod nearest_point;
pub(super) mod neighbours;
pub(super) mod places;
#[cfg(test)]
pub(super) mod places_tests;
pub(super) mod point_tree;
pub(super) mod smallest_rows;
