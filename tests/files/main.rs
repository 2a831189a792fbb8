//! Files of all formats, packets and recordings: written here with known values, by other programs, and broken ones.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod corpus;
#[path = "../common/data.rs"]
mod data;
mod draco;
mod e57;
mod fields;
mod io_archives;
mod io_formats;
mod io_gltf;
mod io_gltf_animations;
mod io_gltf_meshes;
mod io_meshes;
mod io_npy;
mod io_progress;
mod io_recordings;
mod io_splats;
mod io_text_and_bin;
mod io_write;
mod lidar;
mod losses;
mod meaning_text;
mod photos;
mod real_frames;
mod reel;
mod refusals;
mod rgbd;
mod table_layouts;
