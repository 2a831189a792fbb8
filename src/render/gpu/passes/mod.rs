//! The passes: one row each, with its targets, depth and blend state (`geometry.rs`, `screen.rs`, `shade.rs`, and
//! `render/effects`); `pipelines.rs` makes the pipelines from that, once each.

pub(super) mod geometry;
mod pipelines;
pub(super) mod screen;
pub(super) mod shade;
mod state;

pub(super) use pipelines::{GeometryKey, Pipelines};
pub(in crate::render) use state::{ColorUse, DepthUse, MULTIPLIED, OVER};
pub use state::{GeometryPass, ScreenPass};
