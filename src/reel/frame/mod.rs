//! One frame: from a cloud to levels of whole numbers, those as streams of bits, and all of it back.

mod code;
mod columns;
mod describe;
mod drawn;
mod exact;
mod flat;
mod floats;
mod geometry;
mod grid;
mod levels;
mod moved;
mod output;
mod parts;
mod points;
mod prepare;
mod schema;
mod sections;
mod spacing;
mod streams;
mod summaries;
mod values;

pub(super) use code::{decode_pose, encode_pose};
pub(super) use grid::Grid;
pub(super) use levels::Pose;
pub(super) use moved::{Followed, Run, cloud_of_followed, decode as decode_moved, encode as encode_moved, follows};
pub(super) use output::cloud_of;
pub(super) use prepare::{GroupPlan, prepare};
pub(super) use schema::Schema;
pub use schema::StreamKind;
pub(super) use sections::{CodedSection, Wanted};
