//! Levels of detail: structures that choose, for a view, which points or cells stand for a cloud.

pub mod octree;
