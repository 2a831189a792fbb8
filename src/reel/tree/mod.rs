//! Octree of a frame as occupancy masks, level by level, and the neighbour relations in it.

mod build;
mod faces;
mod links;
mod occupancy;
mod plan;
mod window;

pub(super) use build::{OCTANTS, cells_below, first_children, masks_of_cells};
pub(super) use faces::{Faces, NO_FACES, faces_below};
pub(super) use links::{ALONE, Links, NONE, Neighbours, neighbours_below};
pub(super) use occupancy::{OccupancyModels, code_masks, coders_of};
pub(super) use plan::{Known, MAX_KNOWN, plan};
