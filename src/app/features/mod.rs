//! Features: user operations besides viewing and playback, one folder each: the model in `mod.rs`, its work on threads,
//! its panel.
//!
//! The model of a feature knows neither [`super::State`] nor the other features, except the few whose data it is about
//! (trails of inspected points, an exported camera path). It meets the window's state in `in_window.rs` ([`feature`]);
//! [`table`] lists all of them, and nothing else does.

pub(super) mod assumptions;
pub(super) mod benchmark;
pub(super) mod camera_path;
pub(super) mod clipping;
pub(super) mod comparison;
pub(super) mod export;
pub(super) mod feature;
pub(super) mod inspection;
pub(super) mod labels;
pub(super) mod notes;
pub(super) mod palette;
pub(super) mod photos;
pub(super) mod quality;
pub(super) mod save;
pub(super) mod split_view;
mod table;
pub(super) mod temporal;
pub(super) mod thumbnails;
pub(super) mod timeline;
pub(super) mod trails;

pub use table::Features;
