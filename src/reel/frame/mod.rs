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
mod inter;
mod levels;
mod output;
mod parent_colors;
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
pub(super) use inter::{Followed, Run, cloud_of_followed, decode as decode_inter, encode as encode_inter, follows};
pub(super) use levels::Pose;
pub(super) use output::cloud_of;
pub(super) use parent_colors::choose_parent_colors;
pub(super) use prepare::{GroupPlan, prepare};
pub(super) use schema::Schema;
pub use schema::StreamKind;
pub(super) use sections::{CodedSection, Wanted};
