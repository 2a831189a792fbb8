//! Values that are predicted from the level above alone.
//!
//! How it works: the value of a parent is known, and so are those of the nodes across its faces. Between them a
//! child is interpolated ([`channels`], [`normals`]); how much they differ bounds the expected error, which chooses the
//! table of a symbol. Reading the symbols of a level needs nothing else of that level, so these are read in one go, all
//! three channels of a colour or both axes of a normal as one symbol, with raw bits in addition. The sum that a parent
//! leaves to its children is coded once: an only child has the value of its parent.
//!
//! When it wins: always so far. On surfaces that vary smoothly, the nodes on both sides predict it better than three
//! neighbours that come before it; and there is no dependency chain from a node to the next one. Only offsets know a
//! previous node, within their family ([`offsets`]).

mod channels;
mod families;
mod lanes;
mod normals;
mod offsets;
mod steps;
mod steps_to;

pub(super) use channels::{CHANNEL_CONTEXTS, ChannelCoding, code_channels};
pub(super) use families::{Above, Families, ParentValue};
pub(super) use normals::{NORMAL_CONTEXTS, code_normals};
pub(super) use offsets::{OFFSET_CONTEXTS, code_offsets};
