//! The fast coding: static symbols, and nothing of a level is looked for that is not known from the level above.
//!
//! How it works: a mask is one symbol, in the context of the mask above it ([`masks`]). Values are predicted from the
//! parent and from the node before in Morton order, and what is not predicted is one symbol a number ([`channels`],
//! [`normals`], [`offsets`]). Symbols are coded by tables ahead of them ([`super::coder::SymbolCoder`]).
//!
//! When it wins: playing on weak machines. There is no chain from bit to bit, and no neighbour is searched. What it
//! costs: more bits than the compact coding, most for colours that vary little by little.

mod channels;
mod families;
mod masks;
mod normals;
mod offsets;
mod views;

pub(super) use channels::{channel_contexts, channel_lanes, code_channels};
pub(super) use families::Families;
pub(super) use masks::{ABOVE_ROOT, MASK_CONTEXTS, code_masks};
pub(super) use normals::{NORMAL_CONTEXTS, NORMAL_LANES, code_normals, to_halves, to_places};
pub(super) use offsets::{OFFSET_CONTEXTS, code_offsets};
