//! glTF and GLB: scenes of meshes, which may move.
//!
//! An animated scene is one frame for each 24th of a second of its longest animation. A frame is the vertices of all
//! shapes as the nodes, bones and morph targets place them at its time step, or points sampled on their faces: at the
//! same positions on the surface in every frame, spread evenly over the scene at rest, so that point `i` can be
//! followed through time. Coordinates are the file's, with y up.
//!
//! The JSON is read with `serde` into the few relevant objects ([`document`]). The crate `gltf` was not used: its
//! accessors overflow and panic on counts of zero, and it refuses files for extensions that do not concern the shapes.

mod accessor;
mod animation;
mod buffers;
mod document;
mod geometry;
mod material;
mod nodes;
mod scene;

use crate::cloud::{AxisConvention, LengthUnit, RawCloud};
use crate::io::contents::{Entry, Part};
use crate::io::error::{Fault, IoError};
use crate::io::files::watched;
use crate::io::format::{Format, Holding, Magic, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use accessor::AccessorSource;
use buffers::Buffers;
pub(in crate::io) use scene::Scene;
use std::path::Path;
use std::time::Duration;

/// glTF and GLB, in metres (glTF 2.0, §3.4).
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "glTF",
    extensions: &["gltf", "glb"],
    magic: &[Magic::start(b"glTF")],
    convention: Some(AxisConvention::YUp),
    unit: Some(LengthUnit::Metre),
    holds: Holding::TimeSteps,
    is_for_meshes: true,
    ..Traits::PLAIN
});

/// Frame rate of animations in frames per second.
const FRAME_RATE: f64 = 24.0;

/// Longer animations end there: more than an hour.
const MAX_FRAMES: usize = 100_000;

/// The frames of the file at `path`.
pub(in crate::io) fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    let bytes = watched::read_file(path, options.left_bytes(), &Progress::default())?;
    list_bytes(path, &bytes, &options.holding(bytes.len())).map_err(|fault| fault.of(path, FORMAT))
}

fn list_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Entry>, Fault> {
    let (document, binary) = document::parse(bytes, options)?;
    if document.animations.is_empty() {
        return Ok(vec![Entry::whole()]);
    }
    let buffers = Buffers::load(&document, binary, path, options)?;
    let options = &options.holding(buffers.owned_bytes());
    let source = AccessorSource::new(&document, &buffers, options);
    let (animations, seconds) = animation::played(&source)?;
    // Damaged files fail here, and not in each of many frames.
    animation::changes(&source, &animations, 0.0)?;
    if seconds <= 0.0 {
        return Ok(vec![Entry::whole()]);
    }
    // A time that is late by rounding is still within the animation.
    let frames = ((seconds * FRAME_RATE + 1e-3) as usize)
        .saturating_add(1)
        .min(MAX_FRAMES);
    let entry = |index: usize| {
        let time = Duration::from_secs_f64(index as f64 / FRAME_RATE);
        Entry {
            name: format!("t={:.3} s", time.as_secs_f64()),
            time: Some(time),
            part: Part::TimeStep(time),
        }
    };
    Ok((0..frames).map(entry).collect())
}

/// Decodes the scene at the time step given by `part`, by default the first; already sampled where `options` ask for
/// it.
pub(in crate::io) fn decode(path: &Path, bytes: &[u8], part: &Part, options: &ReadOptions) -> Result<RawCloud, Fault> {
    let time_s = match part {
        Part::TimeStep(time) => time.as_secs_f64(),
        _ => 0.0,
    };
    Scene::open(path, bytes, options)?.into_frame(time_s)
}
