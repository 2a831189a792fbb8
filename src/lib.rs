//! pointreel: a viewer for time-varying point clouds (4D scans).
//!
//! A picture is made along one road, and each module only knows those before it:
//!
//! | module | what it does |
//! |---|---|
//! | [`memory`] | the allocator of the program, how long it keeps what is freed, sizes of memory for people |
//! | `temporary` | what is on the disk only until a command ends |
//! | `signals` | signals that ask the program to end |
//! | `kept` | files that are kept between runs |
//! | [`deadlines`] | how long other machines are waited for |
//! | [`waiting`] | what other machines are waited for |
//! | `locks` | locks that go on after a panic elsewhere |
//! | [`progress`] | how much of long work is done, and whether it is still wanted |
//! | `messages` | which messages are of one kind |
//! | `binary` | types of binary numbers, headers of the arrays of numpy |
//! | [`math`] | boxes, frusta, Morton codes, eigenvectors |
//! | [`cloud`] | [`cloud::RawCloud`] (as decoded) and [`cloud::Frame`] (validated, relative to the sequence origin) |
//! | `raster` | images as cameras record them: distances and colours out of bytes |
//! | [`rgbd`] | depth images: cameras, points, colours, filters |
//! | [`wire`] | what live streams are made of: messages, images, points |
//! | [`photos`] | calibrated photographs with sparse points, and their textures |
//! | [`stereo`] | depth from photographs: pairs, many views, dense points |
//! | [`io`] | files of other programs, decoded into [`cloud::RawCloud`] |
//! | [`analysis`] | neighbours, normals, splat radii, colours |
//! | [`measure`] | errors of pictures (PSNR, FLIP, SSIM, holes), clouds (D1, D2) and normals (angles) |
//! | [`levels`] | levels of detail: the sparse voxel octree: build, byte code, visible set |
//! | [`reel`] | sequence files: a 4D scan in a few bits a point, any prefix of a frame a coarser picture |
//! | [`source`] | where frames come from: files in order, recordings, shapes, streams |
//! | [`timeline`] | which frame is due when: the clock, its pace and the range that plays |
//! | [`sequence`] | frames prepared ahead of the playhead within a byte budget |
//! | [`scene`] | camera, settings, the [`scene::ScenePacket`] that holds all that one picture needs, and what is under its pixels |
//! | [`composition`] | the stages from a frame to the packet of its picture: other poses, photographs, levels |
//! | [`document`] | what is open and all that was made around it: session files, what is kept, undo |
//! | [`playback`] | the playhead: which frame is due, which is shown, with how many points |
//! | [`render`] | packets become pixels: five instancing strategies, surfels, voxels and points |
//! | [`headless`] | pictures without a window |
//! | [`export`] | pictures of any size, videos of camera paths |
//! | [`mod@bench`] | the paper's tables, measured here |
//! | [`mod@check`] | what may be wrong with a sequence |
//! | [`mod@convert`] | frames written anew |
//! | [`serve`] | a sequence file by HTTP, any sequence as a live stream |
//! | [`app`] | the window |
//! | [`cli`] | the command line |
//! | `fuzzing` | readers for the targets in `fuzz/` |
//!
//! Features of the package: `window` brings [`app`], `bench` [`mod@bench`], `gpu` [`render::gpu`], `sqlite` recordings
//! in `SQLite`. What is absent from a build has a stand-in (`no_*.rs`) that says so.

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
mod kept;
pub mod levels;
mod locks;
pub mod math;
pub mod measure;
pub mod memory;
mod messages;
mod natural;
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
