//! The passes: a row each says what it draws into and under which depth and blend state (`geometry.rs`, `screen.rs`);
//! `pipelines.rs` makes the pipelines from that, once each.

pub(super) mod geometry;
mod pipelines;
pub(super) mod screen;
mod state;

pub(super) use pipelines::{GeometryKey, Pipelines};
pub use screen::SCREEN_PASSES;
pub(super) use state::DepthUse;
pub use state::{GeometryPass, ScreenPass};
