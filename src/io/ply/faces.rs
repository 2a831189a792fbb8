//! Triangles from the lists of a PLY file: polygons of the `face` element, strips of the `tristrips` element.
//!
//! Items of a list arrive one by one and are made into triangles at its end, so that no list is stored twice. The
//! triangles take at most twelve bytes for each byte of the file: three indices for a further item.
//!
//! Where one face is broken all are left out, and the file is the cloud of its vertices. A mesh of some faces would be
//! worse than none: pictures show points sampled from the faces, so what the lost ones covered would be gone without a
//! trace.

use super::super::error::Fault;
use super::super::mesh;
use super::header::{Element, PropertyKind};
use crate::cloud::RawCloud;

/// Names of the list with the vertices of a face.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

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
    triangles: Vec<[u32; 3]>,
    /// The list that is being read.
    list: Vec<u32>,
    /// Why there are none.
    fault: Option<Fault>,
}

/// Where in an element the vertices of its faces are.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceList {
    /// Which of the properties.
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
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            vertex_count,
            triangles: Vec::new(),
            list: Vec::new(),
            fault: None,
        }
    }

    /// The next vertex of the list in row `row` of `element`.
    pub(super) fn push(&mut self, kind: FaceList, element: &Element, row: usize, index: f64) {
        if self.fault.is_some() {
            return;
        }
        if kind.shape == FaceKind::Strip && index == RESTART {
            self.end_list(kind);
            return;
        }
        let is_vertex = index >= 0.0 && index < self.vertex_count as f64 && index.fract() == 0.0;
        if !is_vertex || index > f64::from(u32::MAX) {
            self.give_up(Fault::entry(
                &element.name,
                row,
                format!(
                    "it names vertex {index}, expected a whole number from 0 to below {}, the count of vertices: the \
                     file is damaged, or its faces belong to another one",
                    self.vertex_count
                ),
            ));
            return;
        }
        self.list.push(index as u32);
    }

    /// No faces after all, for this reason or one before it.
    pub(super) fn give_up(&mut self, fault: Fault) {
        self.fault.get_or_insert(fault);
        self.triangles = Vec::new();
        self.list = Vec::new();
    }

    /// The list is complete.
    pub(super) fn end_list(&mut self, kind: FaceList) {
        match kind.shape {
            FaceKind::Polygon => mesh::fan(&self.list, &mut self.triangles),
            FaceKind::Strip => mesh::strip(&self.list, &mut self.triangles),
        }
        self.list.clear();
    }

    /// Gives `cloud` all of them, or says in its warnings why it has none.
    pub(super) fn put_into(self, cloud: &mut RawCloud) {
        cloud.faces = self.triangles;
        cloud.warnings.extend(self.fault.map(|fault| {
            let Fault { place, problem, .. } = fault;
            format!("{place}: {problem}; all points are there, the faces are left out")
        }));
    }
}
