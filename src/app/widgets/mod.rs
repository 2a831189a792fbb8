//! Building blocks of panels.

pub(super) mod frames;
pub(super) mod names;
pub(super) mod numbers;
pub(super) mod overlay;
pub(super) mod picture;
pub(super) mod ramp;
pub(super) mod rows;
pub(super) mod settle;
pub(super) mod sought;
pub(super) mod tool_window;
