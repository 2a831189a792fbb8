//! Fast coding, for weak machines, and for more points than there is time for.
//!
//! How it works: a mask is one symbol, in the context of the mask above it ([`masks`]). A value is predicted from its
//! parent alone, colours by how the parent and its siblings differ as well ([`slopes`]). The residual is one symbol of
//! the one table of its stream, which selects the range of each number, and raw bits ([`ranges`]). So there is no
//! context to be found, no neighbour, no unpredictable branch. All work but the symbols is done in lanes: the eight
//! children that a node may have are written at once, and the missing ones are overwritten by the next. The symbols
//! read go from step to step in [`blocks`] that stay in the cache of a core.
//!
//! When it wins: in time, by six times, geometry alone by twelve. What it costs: up to a half more bits than the
//! compact coding.

mod blocks;
mod colors;
mod masks;
mod normals;
mod offsets;
mod ranges;
mod singles;
mod slopes;
#[cfg(test)]
mod tests;
mod views;

pub(super) use blocks::{SLACK, Upwards};
pub(super) use colors::code_colors;
pub(super) use masks::{ABOVE_ROOT, MASK_CONTEXTS, code_masks};
pub(super) use normals::{NO_NORMAL, code_normals};
pub(super) use offsets::code_offsets;
pub(super) use singles::code_singles;
