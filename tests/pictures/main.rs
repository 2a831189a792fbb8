//! Images of both renderers, and their inputs: with known answers, compared with each other and with ground truths.
//!
//! One program for all of them: linking one per file took longer than running them, and they share a device.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod ambient_occlusion;
mod antialiasing;
mod closed_surfaces;
mod closed_voxels;
mod coded_on_gpu;
mod coded_surfels;
#[path = "../common/mod.rs"]
mod common;
mod cpu_renderer;
mod cpu_renderer_alone;
#[path = "../common/data.rs"]
mod data;
mod deferred;
mod ellipses;
mod ewa;
mod export;
mod eye_dome;
mod gallery;
mod images;
mod kernels;
mod levels_of_detail;
mod mesh;
mod orthographic;
mod painters;
#[path = "../common/photo_scene.rs"]
mod photo_scene;
mod photos;
mod physical;
mod picking;
mod points;
mod resident_nodes;
mod rims;
mod screen_normals;
mod sensor_view;
mod shaders;
mod shadows;
mod sheets;
mod skipping;
mod splat_geometry;
mod split_view;
mod sprites;
mod stability;
mod strategies;
mod tone;
mod visible_surfels;
#[path = "../common/walk.rs"]
mod walk;
mod white;
