//! glTF and GLB: scenes of meshes, which may move.
//!
//! A scene that is animated is one frame for each 24th of a second of its longest animation. A frame is the vertices of all shapes
//! as the nodes, bones and morph targets put them at its moment, or points sampled on their faces: at the same places of the surface
//! in every frame, spread evenly over the scene as it is before anything moves, so that point `i` can be followed through time.
//! Coordinates are those of the file, with y up.
//!
//! The JSON is read with `serde` into the few objects that count ([`document`]). The crate `gltf` was not used: its accessors
//! overflow and panic on counts of zero, and it refuses files for extensions that do not concern the shapes.

mod accessor;
mod animation;
mod buffers;
mod document;
mod geometry;
mod material;
mod nodes;
mod scene;

use super::contents::{Entry, Part};
use super::error::Fault;
use super::mesh::{self, Places};
use super::options::ReadOptions;
use crate::cloud::{Positions, RawCloud};
use accessor::Source;
use animation::Change;
use buffers::Buffers;
use document::{Animation, Document};
use geometry::Geometry;
use material::Surfaces;
pub(super) use scene::Scene;
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Duration;

/// Frames a second of animations.
const FRAME_RATE: f64 = 24.0;

/// Longer animations end there: more than an hour.
const MAX_FRAMES: usize = 100_000;

/// Coordinates are kept in double precision where a node moves things further than this: single precision would be coarser than 1 in
/// 128.
const FAR: f64 = 65_536.0;

/// The frames of the file `path`, which holds `bytes`.
pub(super) fn list(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Entry>, Fault> {
    let (document, binary) = document::parse(bytes, options)?;
    if document.animations.is_empty() {
        return Ok(vec![Entry::whole()]);
    }
    let buffers = Buffers::load(&document, binary, path, options)?;
    let source = source(&document, &buffers, options);
    let (animations, seconds) = animation::played(&source)?;
    // What is damaged fails here, and not in each of many frames.
    animation::changes(&source, &animations, 0.0)?;
    if seconds <= 0.0 {
        return Ok(vec![Entry::whole()]);
    }
    // A moment that is late by rounding is still within the animation.
    let frames = ((seconds * FRAME_RATE + 1e-3) as usize)
        .saturating_add(1)
        .min(MAX_FRAMES);
    let entry = |index: usize| {
        let time = Duration::from_secs_f64(index as f64 / FRAME_RATE);
        Entry {
            name: format!("t={:.3} s", time.as_secs_f64()),
            time: Some(time),
            part: Part::Moment(time),
        }
    };
    Ok((0..frames).map(entry).collect())
}

/// The scene at the moment that `part` says, by default the first; sampled already where `options` ask for it.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    part: &Part,
    options: &ReadOptions,
) -> Result<RawCloud, Fault> {
    Scene::open(path, bytes, options)?.into_frame(part)
}

fn source<'a>(
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    options: &'a ReadOptions,
) -> Source<'a> {
    Source {
        document,
        buffers,
        options,
        spent_bytes: Cell::new(0),
    }
}

/// The shapes at `time`; as the nodes are without any animation for `None`.
fn pose(
    source: &Source<'_>,
    animations: &[&Animation],
    time: Option<f64>,
) -> Result<Geometry, Fault> {
    let changes = match time {
        Some(time) => animation::changes(source, animations, time)?,
        None => vec![Change::default(); source.document.nodes.len()],
    };
    let placed = nodes::place(source.document, &changes)?;
    geometry::gather(source, &placed, &changes)
}

fn sampled(
    geometry: Geometry,
    surfaces: &Surfaces<'_>,
    places: &Places,
    count: NonZeroUsize,
    options: &ReadOptions,
) -> Result<RawCloud, Fault> {
    // Colours are those of the surface there, not between those of the corners: textures are finer than meshes.
    let colors = surfaces.has_colors(&geometry).then(|| {
        let color = |place: &mesh::Place| {
            let corners = geometry.faces[place.face as usize].map(|corner| corner as usize);
            let blend = |values: [f32; 3]| {
                values
                    .iter()
                    .zip(place.weights)
                    .map(|(value, weight)| value * weight)
                    .sum::<f32>()
            };
            let light = std::array::from_fn(|channel| {
                blend(corners.map(|corner| geometry.colors[corner][channel]))
            });
            let texture = std::array::from_fn(|axis| {
                blend(corners.map(|corner| geometry.texture_places[corner][axis]))
            });
            surfaces.color(geometry.materials[corners[0]], light, texture)
        };
        places.0.iter().map(color).collect()
    });
    let mesh = bare(geometry);
    mesh::check_memory(&mesh, count, options)?;
    let mut cloud = places.apply(&mesh);
    cloud.colors = colors;
    Ok(cloud)
}

fn vertices(geometry: Geometry, surfaces: &Surfaces<'_>) -> RawCloud {
    let colors = surfaces.has_colors(&geometry).then(|| {
        let color = |vertex: usize| {
            surfaces.color(
                geometry.materials[vertex],
                geometry.colors[vertex],
                geometry.texture_places[vertex],
            )
        };
        (0..geometry.positions.len()).map(color).collect()
    });
    let mut cloud = bare(geometry);
    cloud.colors = colors;
    cloud
}

/// Positions, normals and faces.
fn bare(geometry: Geometry) -> RawCloud {
    let is_far = geometry
        .positions
        .iter()
        .any(|position| position.abs().max_element() > FAR);
    let positions = geometry.positions;
    let mut cloud = RawCloud::from_positions(if is_far {
        Positions::F64(
            positions
                .into_iter()
                .map(|position| position.to_array())
                .collect(),
        )
    } else {
        Positions::F32(
            positions
                .into_iter()
                .map(|position| position.as_vec3().to_array())
                .collect(),
        )
    });
    cloud.normals = geometry.has_normals.then_some(geometry.normals);
    cloud.faces = geometry.faces;
    cloud
}
