//! The geometry of the fast coding: a mask is one symbol, in the context of the mask above it ([`masks`]), by tables
//! ahead of them ([`super::coder::SymbolCoder`]).
//!
//! When it wins: playing on weak machines. There is no chain from bit to bit, and no neighbour is searched. What it
//! costs: an eighth more bits than the compact coding for what is sampled evenly, up to a half for others.

mod masks;
mod views;

pub(super) use masks::{ABOVE_ROOT, MASK_CONTEXTS, code_masks};
