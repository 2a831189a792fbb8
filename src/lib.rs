//! pointreel: a viewer for time-varying point clouds (4D scans).
//!
//! An image is rendered along one pipeline, and each module only knows those before it:
//!
//! | module | purpose |
//! |---|---|
//! | [`memory`] | the global allocator, its retention of freed memory, human-readable memory sizes |
//! | `temporary` | temporary files, kept on disk only until a command ends |
//! | `signals` | termination signals |
//! | `persist` | files that persist between runs |
//! | [`deadlines`] | timeouts for other machines |
//! | [`waiting`] | pending waits for other machines |
//! | `locks` | locks that continue after a panic elsewhere |
//! | [`progress`] | progress and cancellation of long-running work |
//! | `messages` | grouping of messages by kind |
//! | `binary` | binary number types, numpy array headers |
//! | [`math`] | boxes, frusta, Morton codes, eigenvectors |
//! | [`cloud`] | [`cloud::RawCloud`] (as decoded) and [`cloud::Frame`] (validated, relative to the sequence origin) |
//! | `raster` | camera images: distances and colours decoded from bytes |
//! | [`rgbd`] | depth images: cameras, points, colours, filters |
//! | [`wire`] | live stream wire format: messages, images, points |
//! | [`photos`] | calibrated images with sparse points, and their textures |
//! | [`stereo`] | multi-view stereo, i.e. depth from images: pairs, many views, dense points |
//! | [`io`] | files of other programs, decoded into [`cloud::RawCloud`] |
//! | [`analysis`] | neighbours, normals, splat radii, colours |
//! | [`measure`] | errors of images (PSNR, FLIP, SSIM, holes), clouds (D1, D2) and normals (angles) |
//! | [`levels`] | levels of detail: the sparse voxel octree: build, byte code, visible set |
//! | [`reel`] | sequence files: a 4D scan in a few bits per point, with any prefix of a frame giving a coarser image |
//! | [`source`] | frame sources: files in order, recordings, shapes, streams |
//! | [`timeline`] | schedule of the frames: the clock, its speed and the playback range |
//! | [`sequence`] | frames prepared ahead of the playhead within a byte budget |
//! | [`scene`] | camera, settings, picking, the [`scene::ScenePacket`] with everything for one rendered frame |
//! | [`composition`] | the stages from a frame to its scene packet: derived frames, images, levels |
//! | [`document`] | the open document and everything created around it: session files, persisted state, undo |
//! | [`playback`] | the playhead: the frame that is due, the frame that is shown, and its number of points |
//! | [`render`] | rendering of packets into pixels: five instancing strategies, surfels, voxels and points |
//! | [`headless`] | rendering without a window |
//! | [`export`] | images of any size, videos of camera paths |
//! | [`mod@bench`] | the paper's tables, measured here |
//! | [`mod@check`] | validation of a sequence |
//! | [`mod@convert`] | conversion of frames to other files |
//! | [`serve`] | a sequence file over HTTP, any sequence as a live stream |
//! | [`app`] | the window |
//! | [`cli`] | the command line |
//! | `fuzzing` | readers for the targets in `fuzz/` |
//!
//! Features of the package: `window` brings [`app`], `bench` [`mod@bench`], `gpu` [`render::gpu`], `sqlite` recordings
//! in `SQLite`. Features absent from a build have a stand-in (`no_*.rs`) that reports so.

#![cfg_attr(
    not(all(feature = "sqlite", feature = "window")),
    allow(dead_code, unused_imports, reason = "the core is made for the whole program")
)]

pub mod analysis;
#[cfg(feature = "window")]
pub mod app;
pub mod assumption;
#[cfg(feature = "bench")]
pub mod bench;
mod binary;
pub mod check;
pub mod cli;
pub mod cloud;
pub mod composition;
pub mod convert;
pub mod deadlines;
pub mod document;
pub mod export;
#[cfg(feature = "fuzzing")]
#[doc(hidden)]
pub mod fuzzing;
pub mod headless;
pub mod io;
pub mod levels;
mod locks;
pub mod math;
pub mod measure;
pub mod memory;
mod messages;
mod natural;
mod persist;
pub mod photos;
pub mod playback;
mod printable;
mod priority;
pub mod progress;
mod raster;
pub mod reel;
mod regular_file;
pub mod render;
pub mod rgbd;
pub mod scene;
pub mod sequence;
pub mod serve;
mod signals;
pub mod source;
mod spelling;
pub mod stereo;
mod stopwatch;
mod temporary;
pub mod timeline;
pub mod waiting;
pub mod wire;
