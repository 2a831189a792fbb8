//! Triangles made ready for an image: vertices in the colours of the points.

use crate::analysis::fake_color;
use crate::cloud::{Mesh, MeshRecords, PointRecord, Texturing, TriangleRecord, VertexRecord, oct_encode};
use crate::sequence::{Paint, records};
use glam::Vec3;
use std::sync::Arc;

/// The triangles of a frame, as records. Immutable; parts are shared.
#[derive(Debug, Clone)]
pub struct PreparedMesh {
    mesh: Arc<Mesh>,
    records: Arc<MeshRecords>,
}

impl PreparedMesh {
    /// The records of `mesh` in `paint`.
    pub fn new(mesh: Arc<Mesh>, paint: &Paint) -> Self {
        let triangles = Arc::new(mesh.records());
        Self::painted(mesh, triangles, paint)
    }

    /// Returns the mesh in another paint.
    pub(super) fn repainted(&self, paint: &Paint) -> Self {
        let triangles = Arc::clone(&self.records.triangles);
        Self::painted(Arc::clone(&self.mesh), triangles, paint)
    }

    fn painted(mesh: Arc<Mesh>, triangles: Arc<Vec<TriangleRecord>>, paint: &Paint) -> Self {
        // Textures are colours of the file.
        let texturing = mesh.texturing().filter(|_| *paint == Paint::File);
        let records = MeshRecords::new(Arc::new(vertices(&mesh, paint, texturing)), triangles);
        let records = match texturing {
            Some(texturing) => records.with_textures(Arc::clone(&texturing.textures)),
            None => records,
        };
        Self {
            mesh,
            records: Arc::new(records),
        }
    }

    /// Returns the mesh that the records were created from.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the mesh records to draw, in the colours of the frame.
    pub fn records(&self) -> &Arc<MeshRecords> {
        &self.records
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        self.mesh.byte_size() + self.records.byte_size()
    }
}

/// One record per vertex. If the file has no normals, the faces are lit.
fn vertices(mesh: &Mesh, paint: &Paint, texturing: Option<&Texturing>) -> Vec<VertexRecord> {
    let normals = mesh.vertices().normals();
    let normal = |slot: usize| match normals.map(|normals| normals[slot]) {
        Some(normal) if normal != Vec3::ZERO => oct_encode(normal),
        // Normals averaged over the faces around a vertex would round off the edges of a cube.
        _ => VertexRecord::NO_NORMAL,
    };
    let record = |(slot, point): (usize, &PointRecord)| VertexRecord {
        position: point.position,
        color: point.color,
        normal: normal(slot),
        texture_place: texturing.map_or([0.0; 2], |texturing| texturing.places[slot]),
        texture: texturing
            .and_then(|texturing| texturing.texture_of_vertex[slot])
            .unwrap_or(VertexRecord::NO_TEXTURE),
    };
    painted(mesh, paint).iter().enumerate().map(record).collect()
}

fn painted(mesh: &Mesh, paint: &Paint) -> Vec<PointRecord> {
    if *paint != Paint::Normal {
        return records::painted_points(mesh.vertices(), paint, None);
    }
    let positions = mesh.vertices().positions().iter();
    positions
        // Averaged here, unlike for lighting: a colour per face would need three vertices per triangle.
        .zip(mesh.smooth_normals())
        .map(|(position, normal)| PointRecord {
            position: position.to_array(),
            color: fake_color(normal),
        })
        .collect()
}
