//! Shared state of all frames of a file: the parsed document, its buffers, textures, and the positions at which points
//! are sampled.

use super::accessor::AccessorSource;
use super::animation::{self, NodePose};
use super::buffers::Buffers;
use super::document::{self, Document};
use super::geometry::{self, Geometry};
use super::material::{Surfaces, Textures};
use super::nodes;
use crate::cloud::{self, Positions, RawCloud, ScalarField};
use crate::io::error::Fault;
use crate::io::meshes::mesh::{self, Places};
use crate::io::options::ReadOptions;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// Coordinates are stored in double precision where a node moves objects further than this: single precision would be
/// coarser than 1 in 128.
const FAR: f64 = 65_536.0;

/// A file that was read and can provide any frame.
pub(in crate::io) struct Scene<'a> {
    document: Document,
    buffers: Buffers<'a>,
    options: ReadOptions,
    /// Indices of the animations that are played.
    played: Vec<usize>,
    textures: Textures,
    /// Textures in the form in which they are handed over with the cloud, if they are.
    retained_textures: Option<Arc<cloud::Textures>>,
    /// Sample positions, if points are sampled: determined on the scene at rest, so that they are the same in every
    /// frame.
    places: Option<(Places, NonZeroUsize)>,
    /// Taken by textures of the memory that one frame may take.
    spent_bytes: u64,
    /// The shapes where nothing moves.
    at_rest: Option<Geometry>,
}

impl<'a> Scene<'a> {
    /// The file `path`, which holds `bytes`.
    pub(in crate::io) fn open(path: &Path, bytes: &'a [u8], options: &ReadOptions) -> Result<Self, Fault> {
        let (document, binary) = document::parse(bytes, options)?;
        let buffers = Buffers::load(&document, binary, path, options)?;
        let options = &options.holding(buffers.owned_bytes());
        let source = AccessorSource::new(&document, &buffers, options);
        let (played, _) = animation::played(&source)?;
        // Damaged files fail here, and not in each frame.
        animation::changes(&source, &played, 0.0)?;
        let at_rest = pose(&source, &[], None)?;
        check_shown(&at_rest)?;
        // Each frame has the full memory limit for its shapes, in addition to the textures.
        source.spent_bytes.set(0);
        let textures = Textures::load(&source, &at_rest, path)?;
        let spent_bytes = source.spent_bytes.get();
        let count = options.sample_count.filter(|_| !at_rest.faces.is_empty());
        let places = count.map(|count| spread(&at_rest, count, options));
        let places = places.transpose()?.flatten().zip(count);
        Ok(Self {
            played,
            retained_textures: options.keeps_textures.then(|| Arc::new(textures.pictures())),
            textures,
            places,
            spent_bytes,
            at_rest: document.animations.is_empty().then_some(at_rest),
            options: *options,
            document,
            buffers,
        })
    }

    /// Converts the scene to an owned one, without the bytes of the file.
    pub(in crate::io) fn into_owned(self) -> Scene<'static> {
        Scene {
            document: self.document,
            buffers: self.buffers.into_owned(),
            options: self.options,
            played: self.played,
            textures: self.textures,
            retained_textures: self.retained_textures,
            places: self.places,
            spent_bytes: self.spent_bytes,
            at_rest: self.at_rest,
        }
    }

    /// The scene at `time_s`; sampled already where that was requested.
    pub(in crate::io) fn frame(&self, time_s: f64) -> Result<RawCloud, Fault> {
        self.cloud(self.posed(time_s)?)
    }

    /// [`Scene::frame`] of a scene that is read for one.
    pub(in crate::io) fn into_frame(mut self, time_s: f64) -> Result<RawCloud, Fault> {
        match self.at_rest.take() {
            Some(geometry) => self.cloud(geometry),
            None => self.frame(time_s),
        }
    }

    fn posed(&self, time_s: f64) -> Result<Geometry, Fault> {
        let source = AccessorSource::new(&self.document, &self.buffers, &self.options);
        source.spent_bytes.set(self.spent_bytes);
        let geometry = pose(&source, &self.played, Some(time_s))?;
        check_shown(&geometry)?;
        Ok(geometry)
    }

    fn cloud(&self, geometry: Geometry) -> Result<RawCloud, Fault> {
        let surfaces = Surfaces {
            materials: &self.document.materials,
            textures: &self.textures,
        };
        match (&self.places, &self.retained_textures) {
            (Some((places, count)), _) => sampled(geometry, &surfaces, places, *count, &self.options),
            (None, Some(pictures)) => Ok(textured(geometry, &surfaces, pictures)),
            (None, None) => Ok(vertices(geometry, &surfaces)),
        }
    }
}

fn check_shown(geometry: &Geometry) -> Result<(), Fault> {
    if geometry.positions.is_empty() {
        return Err(Fault::header("the scene shows no mesh: a point cloud needs vertices"));
    }
    Ok(())
}

fn spread(geometry: &Geometry, count: NonZeroUsize, options: &ReadOptions) -> Result<Option<Places>, Fault> {
    let positions = geometry.positions.iter().map(glam::DVec3::to_array);
    let positions = Positions::F64(positions.collect());
    Places::spread(&positions, &geometry.faces, count, options)
}

/// The shapes at `time`; as the nodes are without any animation for `None`.
fn pose(source: &AccessorSource<'_>, animations: &[usize], time: Option<f64>) -> Result<Geometry, Fault> {
    let changes = match time {
        Some(time) => animation::changes(source, animations, time)?,
        None => vec![NodePose::default(); source.document.nodes.len()],
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
    // Colours are sampled at the surface, not interpolated between the corners: textures are finer than meshes.
    let colors = surfaces.has_colors(&geometry).then(|| {
        let color = |place: &mesh::MeshSample| {
            let corners = geometry.faces[place.face as usize].map(|corner| corner as usize);
            let blend = |values: [f32; 3]| {
                values
                    .iter()
                    .zip(place.weights)
                    .map(|(value, weight)| value * weight)
                    .sum::<f32>()
            };
            let light = std::array::from_fn(|channel| blend(corners.map(|corner| geometry.colors[corner][channel])));
            let texture =
                std::array::from_fn(|axis| blend(corners.map(|corner| geometry.texture_places[corner][axis])));
            surfaces.color(geometry.materials[corners[0]], light, texture)
        };
        places.0.iter().map(color).collect()
    });
    let mesh = bare(geometry);
    mesh::check_memory(&mesh, count, options)?;
    let mut cloud = places.apply(&mesh);
    cloud.attributes.colors = colors;
    Ok(cloud)
}

/// Vertices with the textures of the faces between them.
fn textured(geometry: Geometry, surfaces: &Surfaces<'_>, pictures: &Arc<cloud::Textures>) -> RawCloud {
    let colors = surfaces.has_colors(&geometry).then(|| {
        let colored = geometry.materials.iter().zip(&geometry.colors);
        colored
            .map(|(&material, &light)| surfaces.color_without_texture(material, light))
            .collect()
    });
    let texturing = surfaces.texturing(&geometry, pictures);
    let mut cloud = bare(geometry);
    cloud.attributes.colors = colors;
    cloud.texturing = Some(texturing).filter(|_| !pictures.places().is_empty());
    cloud
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
    cloud.attributes.colors = colors;
    cloud
}

/// Positions, normals, fields and faces.
fn bare(geometry: Geometry) -> RawCloud {
    let is_far = geometry
        .positions
        .iter()
        .any(|position| position.abs().max_element() > FAR);
    let positions = geometry.positions;
    let mut cloud = RawCloud::from_positions(if is_far {
        Positions::F64(positions.into_iter().map(|position| position.to_array()).collect())
    } else {
        Positions::F32(
            positions
                .into_iter()
                .map(|position| position.as_vec3().to_array())
                .collect(),
        )
    });
    cloud.attributes.normals = geometry.has_normals.then_some(geometry.normals);
    let field = |(name, values): (String, Vec<f64>)| ScalarField::from_f64(name, &values);
    cloud.attributes.scalars = geometry.fields.into_iter().map(field).collect();
    cloud.faces = geometry.faces;
    cloud
}
