//! A file per command.

#[cfg_attr(not(feature = "bench"), path = "no_bench.rs")]
pub(super) mod bench;
#[cfg(feature = "bench")]
#[cfg_attr(not(feature = "window"), path = "no_bench_window.rs")]
pub(super) mod bench_window;
pub(super) mod check;
pub(super) mod compare;
pub(super) mod compare_frames;
pub(super) mod convert;
pub(super) mod info;
pub(super) mod render;
pub(super) mod serve;
pub(super) mod video;
#[cfg_attr(not(feature = "window"), path = "no_view.rs")]
pub(super) mod view;
