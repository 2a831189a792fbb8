//! Surface attributes of the faces of an OBJ file: the material of each, and the texture coordinates of its corners in
//! the material's image.

use super::counts::Counts;
use super::materials::{Materials, Paint};
use super::numbering::resolve;
use crate::cloud::{RawCloud, Texturing};
use crate::io::codec::Encoded;
use crate::io::error::Fault;
use crate::io::meshes::mesh;
use std::collections::HashMap;
use std::mem;
use std::sync::Arc;

/// A corner without texture coordinates.
const NO_PLACE: u32 = u32::MAX;

/// Corners of the faces read so far, and their materials.
#[derive(Default)]
pub(super) struct Corners {
    /// Texture coordinates as stored in the file: to the right, and upwards.
    places: Vec<[f32; 2]>,
    /// Indices of the texture coordinates of each corner of each face; shorter than the list of faces if no more of
    /// them have any.
    places_of_faces: Vec<[u32; 3]>,
    polygon: Vec<u32>,
    /// Faces before the polygon.
    faces: usize,
    materials: Vec<String>,
    /// The number of each material by its name.
    numbers: HashMap<String, u32>,
    /// From which face on which material is used.
    uses: Vec<(usize, u32)>,
    libraries: Vec<String>,
}

/// A vertex of a textured cloud: a vertex of the file, on faces of one material, with one texture coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    vertex: u32,
    place: u32,
    /// Index of the material and one; 0 for none.
    material: u32,
}

impl Corners {
    /// No corners yet, with capacity for texture coordinates.
    pub(super) fn with_capacity(counts: &Counts) -> Self {
        Self {
            places: Vec::with_capacity(counts.places),
            ..Self::default()
        }
    }

    pub(super) fn push_place(&mut self, place: [f64; 2]) {
        self.places.push(place.map(|coordinate| coordinate as f32));
    }

    pub(super) fn add_library(&mut self, name: &str) {
        self.libraries.push(name.to_owned());
    }

    /// Faces from number `face` on have this material.
    pub(super) fn use_material(&mut self, name: &str, face: usize) {
        let next = self.materials.len() as u32;
        let material = *self.numbers.entry(name.to_owned()).or_insert(next);
        if material == next {
            self.materials.push(name.to_owned());
        }
        self.uses.push((face, material));
    }

    pub(super) fn start_polygon(&mut self) {
        self.polygon.clear();
    }

    /// Appends a corner with the texture coordinate `word`, numbered like vertices. Numbers out of range count as none.
    pub(super) fn push_corner(&mut self, word: &[u8]) {
        let place = resolve(word, self.places.len());
        self.polygon.push(place.map_or(NO_PLACE, |place| place as u32));
    }

    pub(super) fn end_polygon(&mut self) {
        if self.polygon.iter().any(|&place| place != NO_PLACE) {
            self.places_of_faces.resize(self.faces, [NO_PLACE; 3]);
            mesh::fan(&self.polygon, &mut self.places_of_faces);
        }
        self.faces += self.polygon.len().saturating_sub(2);
    }

    /// Applies the materials of the faces to the vertices of `cloud`, which has all the faces.
    pub(super) fn put_on(self, cloud: &mut RawCloud, file: &Encoded<'_>) -> Result<(), Fault> {
        /// A corner, its number, and the place of both in an index.
        const SPLIT_BYTES: usize = 80;
        if self.libraries.is_empty() || self.uses.is_empty() || cloud.faces.is_empty() {
            return Ok(());
        }
        let corners = 3 * cloud.faces.len() + cloud.positions.len();
        file.options
            .claim_entries("the corners of its faces", corners, SPLIT_BYTES)?;
        let materials = Materials::load(&self.libraries, &self.materials, file)?;
        cloud.warnings.extend(materials.warnings.iter().cloned());
        if materials.paints.iter().all(|&paint| paint == Paint::WHITE) {
            return Ok(());
        }
        // A vertex has one material and one pair of texture coordinates, which in OBJ belong to corners: vertices are
        // duplicated only for triangles and samples, so a file read as plain vertices keeps its number of them.
        if file.options.keeps_textures || file.options.sample_count.is_some() {
            self.split(cloud, materials);
        } else {
            self.color_vertices(cloud, &materials);
        }
        Ok(())
    }

    /// The corners of all faces, in turn.
    fn corners(&self, faces: &[[u32; 3]]) -> impl Iterator<Item = [Corner; 3]> {
        let mut uses = self.uses.iter().peekable();
        let mut material = 0;
        faces.iter().enumerate().map(move |(face, vertices)| {
            while let Some((_, next)) = uses.next_if(|(first, _)| *first <= face) {
                material = next + 1;
            }
            let places = self.places_of_faces.get(face).copied().unwrap_or([NO_PLACE; 3]);
            [0, 1, 2].map(|corner| Corner {
                vertex: vertices[corner],
                place: places[corner],
                material,
            })
        })
    }

    /// Returns the texture coordinates of a corner, 0 to 1 from left to right and from top to bottom.
    fn place(&self, corner: Corner) -> [f32; 2] {
        match self.places.get(corner.place as usize) {
            Some([right, up]) => [*right, 1.0 - up],
            None => [0.0; 2],
        }
    }

    /// Splits vertices on faces of several materials, or with several texture coordinates. Vertices of no face stay.
    fn split(&self, cloud: &mut RawCloud, materials: Materials) {
        let faces = mem::take(&mut cloud.faces);
        let mut numbers = HashMap::new();
        let mut kinds = Vec::new();
        let split: Vec<[u32; 3]> = self
            .corners(&faces)
            .map(|corners| {
                corners.map(|corner| {
                    *numbers.entry(corner).or_insert_with(|| {
                        kinds.push(corner);
                        kinds.len() as u32 - 1
                    })
                })
            })
            .collect();
        let mut is_corner = vec![false; cloud.positions.len()];
        for &vertex in faces.iter().flatten() {
            is_corner[vertex as usize] = true;
        }
        let loose = (0..cloud.positions.len() as u32).filter(|&vertex| !is_corner[vertex as usize]);
        kinds.extend(loose.map(|vertex| Corner {
            vertex,
            place: NO_PLACE,
            material: 0,
        }));
        let indices: Vec<u32> = kinds.iter().map(|kind| kind.vertex).collect();
        cloud.keep(&indices);
        cloud.faces = split;
        let paints: Vec<Paint> = kinds.iter().map(|kind| materials.paint(*kind)).collect();
        // Textured vertices are white.
        let color = |vertex: usize, paint: &Paint| match (paint, &cloud.attributes.colors) {
            // The texture replaces the colour of its material, which many programs write as well.
            (Paint::Picture(_), _) => [255; 4],
            (_, Some(colors)) => colors[vertex],
            (Paint::Color(color), None) => *color,
        };
        cloud.attributes.colors = Some((0..).zip(&paints).map(|(vertex, paint)| color(vertex, paint)).collect());
        let picture = |paint: &Paint| match paint {
            Paint::Picture(number) => Some(*number),
            Paint::Color(_) => None,
        };
        cloud.texturing = (!materials.textures.places().is_empty()).then(|| Texturing {
            texture_of_vertex: paints.iter().map(picture).collect(),
            places: kinds.iter().map(|kind| self.place(*kind)).collect(),
            textures: Arc::new(materials.textures),
        });
    }

    /// Each vertex has the colour that the first face around it has there.
    fn color_vertices(&self, cloud: &mut RawCloud, materials: &Materials) {
        let had_colors = cloud.attributes.colors.is_some();
        let colors = cloud
            .attributes
            .colors
            .get_or_insert_with(|| vec![[255; 4]; cloud.positions.len()]);
        let mut is_colored = vec![false; colors.len()];
        for corner in self.corners(&cloud.faces).flatten() {
            let vertex = corner.vertex as usize;
            if mem::replace(&mut is_colored[vertex], true) {
                continue;
            }
            match materials.paint(corner) {
                Paint::Picture(number) => {
                    let color = materials.textures.color(number as usize, self.place(corner));
                    let [red, green, blue] = color.map(|channel| (channel * 255.0).round() as u8);
                    colors[vertex] = [red, green, blue, 255];
                }
                Paint::Color(color) if !had_colors => colors[vertex] = color,
                Paint::Color(_) => {}
            }
        }
    }
}

impl Materials {
    fn paint(&self, corner: Corner) -> Paint {
        let material = (corner.material as usize).checked_sub(1);
        let paint = material.and_then(|material| self.paints.get(material));
        paint.copied().unwrap_or(Paint::WHITE)
    }
}
