//! Commands of the program, as a person types them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod assumptions;
mod cli;
mod cli_convert;
mod cli_render;
mod cli_video;
mod compare;
mod compare_frames;
#[path = "../common/data.rs"]
mod data;
mod extremes;
mod fields;
#[cfg(all(feature = "window", feature = "bench", feature = "gpu", feature = "sqlite"))]
mod help;
mod hostile;
mod memory_limits;
mod outputs;
mod pages;
mod send_depth;
mod serve;
mod session_files;
mod stdout;
#[cfg(unix)]
mod stopped;
mod trust;
mod without_proc;
