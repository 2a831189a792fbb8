//! Entropy coding: adaptive binary range coding: each bit has its own running probability.
//!
//! Encoder and decoder are two types of one trait, [`BitCoder`], so the modelling is written once: a function that
//! codes a level takes the bits that are there and returns the bits that a decoder will see.
//!
//! In addition, static coding of symbols, [`SymbolCoder`], with two types for encoder and decoder as well.

mod bit_model;
mod clusters;
mod frequencies;
mod mixer;
mod number;
mod range;
mod raw_bits;
mod reciprocal;
mod symbols;

pub(super) use bit_model::BitModel;
pub(super) use frequencies::{Counts, LOG_BITS};
pub(super) use mixer::Mixer;
pub(super) use number::{MagnitudeModel, RestModels};
pub(super) use range::{BitCoder, RangeDecoder, RangeEncoder};
pub(super) use reciprocal::divided;
pub(super) use symbols::{LANES, SymbolCoder, SymbolDecoder, SymbolEncoder};
