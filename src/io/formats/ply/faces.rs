//! Triangles from the lists of a PLY file: polygons of the `face` element, strips of the `tristrips` element.
//!
//! Items of a list arrive one by one and are turned into triangles at its end, so that no list is stored twice. The
//! triangles take at most twelve bytes for each byte of the file: three indices for a further item.
//!
//! A face that names vertices that do not exist is skipped, as are faces after the end of the file
//! (`io/meshes/broken_faces.rs`).

use super::header::{Element, PropertyKind};
use crate::cloud::RawCloud;
use crate::io::error::Fault;
use crate::io::meshes::broken_faces::{BrokenFaces, no_vertex};
use crate::io::meshes::mesh;
use crate::io::options::ReadOptions;

/// Names of the list with the vertices of a face.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Name of the memory consumer in messages.
const FACES: &str = "the faces";

/// Between two strips in one list.
const RESTART: f64 = -1.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FaceKind {
    Polygon,
    Strip,
}

/// The triangles so far.
#[derive(Debug)]
pub(super) struct Faces {
    vertex_count: usize,
    options: ReadOptions,
    triangles: Vec<[u32; 3]>,
    /// The list that is being read.
    list: Vec<u32>,
    /// Why that list cannot be used.
    fault: Option<Fault>,
    /// Memory does not suffice for that list.
    lacks_memory: Option<Fault>,
    broken: BrokenFaces,
}

/// Location of the vertex indices of faces in an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceList {
    /// Index of the property.
    pub(super) property: usize,
    shape: FaceKind,
}

impl FaceList {
    /// The faces in `element`, if there are such.
    pub(super) fn of(element: &Element) -> Option<Self> {
        let shape = match element.name.as_str() {
            "face" => FaceKind::Polygon,
            "tristrips" => FaceKind::Strip,
            _ => return None,
        };
        let property = element.properties.iter().position(|property| {
            INDICES.contains(&property.name.as_str()) && matches!(property.kind, PropertyKind::List { .. })
        })?;
        Some(Self { property, shape })
    }
}

impl Faces {
    /// No triangles of `vertex_count` vertices.
    pub(super) fn new(vertex_count: usize, options: ReadOptions) -> Self {
        Self {
            vertex_count,
            options,
            triangles: Vec::new(),
            list: Vec::new(),
            fault: None,
            lacks_memory: None,
            broken: BrokenFaces::default(),
        }
    }

    /// The next vertex of the list in row `row` of `element`.
    pub(super) fn push(&mut self, kind: FaceList, element: &Element, row: usize, index: f64) {
        if kind.shape == FaceKind::Strip && index == RESTART {
            // A lack of memory is reported at the end of the list.
            self.lacks_memory = self.lacks_memory.take().or(self.end_list(kind).err());
            return;
        }
        if self.fault.is_some() || self.lacks_memory.is_some() {
            return;
        }
        let is_vertex = index >= 0.0 && index < self.vertex_count as f64 && index.fract() == 0.0;
        if !is_vertex || index > f64::from(u32::MAX) {
            self.fault = Some(no_vertex(&element.name, row, index, self.vertex_count));
            return;
        }
        let space = self.options.reserve(&mut self.list, 1, FACES);
        self.lacks_memory = space.err();
        if self.lacks_memory.is_none() {
            self.list.push(index as u32);
        }
    }

    /// No further faces, for this reason.
    pub(super) fn stop(&mut self, fault: Fault) {
        self.broken.end(fault);
        self.fault = None;
        self.list.clear();
    }

    /// The list is complete.
    ///
    /// # Errors
    /// Memory does not suffice for its triangles.
    pub(super) fn end_list(&mut self, kind: FaceList) -> Result<(), Fault> {
        if let Some(fault) = self.lacks_memory.take() {
            return Err(fault);
        }
        let fault = self.fault.take();
        if fault.is_none() {
            self.options.reserve(&mut self.triangles, self.list.len(), FACES)?;
            match kind.shape {
                FaceKind::Polygon => mesh::fan(&self.list, &mut self.triangles),
                FaceKind::Strip => mesh::strip(&self.list, &mut self.triangles),
            }
        }
        self.broken.count(fault);
        self.list.clear();
        Ok(())
    }

    /// Memory of the triangles.
    pub(super) fn byte_size(&self) -> usize {
        size_of_val(self.triangles.as_slice())
    }

    /// Adds usable faces to `cloud`, and warnings about the others.
    pub(super) fn put_into(self, cloud: &mut RawCloud) {
        self.broken.put_into(self.triangles, cloud);
    }
}
