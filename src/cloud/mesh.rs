//! The triangles of a frame, and the vertices between them.
//!
//! Vertices are a [`Frame`] of their own: where images show points sampled on the faces, these are not the vertices. So
//! vertices are validated, coloured and found in the file like points. As they are in Morton order, triangles that are
//! sorted by their first corner are near to their neighbours in the list.

use super::{CloudError, Frame, RawCloud, Texturing, TriangleRecord, oct_encode};
use glam::{DVec3, Vec3};
use std::mem;

/// Triangles between the points of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    vertices: Frame,
    /// Ascending. The first corner of each has the smallest slot.
    triangles: Vec<[u32; 3]>,
    texturing: Option<Texturing>,
}

impl Mesh {
    /// The mesh of a decoded file, with its vertices moved to `origin` as the points of a frame are. Faces with a
    /// repeated vertex, or one without finite coordinates, are dropped.
    pub fn from_raw(mut raw: RawCloud, origin: DVec3) -> Result<Self, CloudError> {
        let faces = mem::take(&mut raw.faces);
        let texturing = raw.texturing.take();
        let mut slots = vec![None; raw.positions.len()];
        let vertices = Frame::from_raw(raw, origin)?;
        for (&index, slot) in vertices.file_index().iter().zip(0u32..) {
            slots[index as usize] = Some(slot);
        }
        let slot_of = |corner: u32| slots.get(corner as usize).copied().flatten();
        let triangle = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [slot_of(a)?, slot_of(b)?, slot_of(c)?];
            (a != b && b != c && c != a).then(|| first_corner_first([a, b, c]))
        };
        let mut triangles: Vec<[u32; 3]> = faces.into_iter().filter_map(triangle).collect();
        // By their first corner, the smallest: as vertices are in Morton order, blocks of 64 triangles are compact
        // without any extra code.
        triangles.sort_unstable();
        Ok(Self {
            texturing: texturing.map(|texturing| texturing.gathered(vertices.file_index())),
            vertices,
            triangles,
        })
    }

    /// The vertices, those that belong to no triangle among them.
    pub fn vertices(&self) -> &Frame {
        &self.vertices
    }

    /// Slots of the corners of each triangle among the vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Textures of the triangles, one entry per vertex.
    pub fn texturing(&self) -> Option<&Texturing> {
        self.texturing.as_ref()
    }

    /// A record for each triangle, and one for each vertex that belongs to none, in the order of their first corners.
    pub fn records(&self) -> Vec<TriangleRecord> {
        let mut is_corner = vec![false; self.vertices.len()];
        for &corner in self.triangles.iter().flatten() {
            is_corner[corner as usize] = true;
        }
        let record = |&corners: &[u32; 3]| TriangleRecord {
            corners,
            normal: oct_encode(self.doubled_area(corners).normalize_or_zero()),
        };
        let point = |slot: u32| TriangleRecord {
            // Drawn as a point in the same pass, in its place in the order: renderers, clipping and picking have a
            // single list.
            corners: [slot; 3],
            normal: [0; 2],
        };
        let points = (0..self.vertices.len() as u32).filter(|&slot| !is_corner[slot as usize]);
        let mut records: Vec<TriangleRecord> = self.triangles.iter().map(record).chain(points.map(point)).collect();
        records.sort_unstable_by_key(|record| record.corners);
        records
    }

    /// The unit normals of the file, or where it has none, the area-weighted means of the face normals around each
    /// vertex; zero where there is no face.
    pub fn smooth_normals(&self) -> Vec<Vec3> {
        if let Some(normals) = self.vertices.normals() {
            return normals.to_vec();
        }
        let mut sums = vec![Vec3::ZERO; self.vertices.len()];
        for &corners in &self.triangles {
            let area = self.doubled_area(corners);
            for corner in corners {
                sums[corner as usize] += area;
            }
        }
        sums.into_iter().map(Vec3::normalize_or_zero).collect()
    }

    /// The normal of a triangle, twice as long as its area is large.
    fn doubled_area(&self, corners: [u32; 3]) -> Vec3 {
        let [a, b, c] = corners.map(|corner| self.vertices.positions()[corner as usize]);
        (b - a).cross(c - a)
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        let pictures = self.texturing.as_ref().map_or(0, Texturing::byte_size);
        self.vertices.byte_size() + size_of_val(self.triangles.as_slice()) + pictures
    }
}

/// Rotates the corners of a triangle so that the smallest index comes first; its orientation is unchanged.
fn first_corner_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    let first = a.min(b).min(c);
    if first == a {
        [a, b, c]
    } else if first == b {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, oct_decode};
    use proptest::prelude::*;

    fn raw(positions: Vec<[f32; 3]>, faces: Vec<[u32; 3]>) -> RawCloud {
        let mut raw = RawCloud::from_positions(Positions::F32(positions));
        raw.faces = faces;
        raw
    }

    /// The corners of a triangle, from the one that comes first on.
    fn turned(corners: [[u32; 3]; 3]) -> [[u32; 3]; 3] {
        let turns = [0, 1, 2].map(|turn| [0, 1, 2].map(|corner| corners[(corner + turn) % 3]));
        turns.into_iter().min().unwrap()
    }

    proptest! {
        #[test]
        fn triangles_of_the_file_keep_their_winding(
            positions in prop::collection::vec(prop::array::uniform3(-9f32..9.0), 3..40),
            holes in prop::collection::vec(0usize..40, 0..3),
            faces in prop::collection::vec(prop::array::uniform3(0u32..40), 0..60),
        ) {
            let count = positions.len();
            let faces: Vec<[u32; 3]> = faces.into_iter().map(|face| face.map(|corner| corner % count as u32)).collect();
            let mut positions = positions;
            for hole in holes {
                positions[hole % count][1] = f32::NAN;
            }
            let bits = |index: u32| positions[index as usize].map(f32::to_bits);
            let is_triangle = |[a, b, c]: &[u32; 3]| {
                a != b && b != c && c != a && [a, b, c].iter().all(|&&corner| positions[corner as usize][1].is_finite())
            };
            let triangles = faces.iter().filter(|face| is_triangle(face));
            let mut expected: Vec<_> = triangles.map(|face| turned(face.map(bits))).collect();
            let mesh = Mesh::from_raw(raw(positions.clone(), faces.clone()), DVec3::ZERO).unwrap();
            let there = |&corners: &[u32; 3]| {
                turned(corners.map(|slot| mesh.vertices().positions()[slot as usize].to_array().map(f32::to_bits)))
            };
            let mut found: Vec<_> = mesh.triangles().iter().map(there).collect();
            expected.sort_unstable();
            found.sort_unstable();
            prop_assert_eq!(found, expected);
            prop_assert!(mesh.triangles().iter().all(|&[a, b, c]| a < b && a < c));
            let records = mesh.records();
            prop_assert!(records.is_sorted_by_key(|record| record.corners));
            let in_records = |slot: u32| records.iter().any(|record| record.corners.contains(&slot));
            prop_assert!((0..mesh.vertices().len() as u32).all(in_records));
            let triangles = records.iter().filter(|record| !record.is_point());
            prop_assert!(triangles.map(|record| record.corners).eq(mesh.triangles().iter().copied()));
        }
    }

    #[test]
    fn unreferenced_vertices_are_points_and_normals_come_from_faces() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [9.0, 9.0, 9.0],
            [0.0, 0.0, 3.0],
        ];
        let mesh = Mesh::from_raw(raw(positions, vec![[0, 1, 2], [0, 1, 4], [3, 3, 1]]), DVec3::ZERO).unwrap();
        let records = mesh.records();
        let points: Vec<_> = records.iter().filter(|record| record.is_point()).collect();
        assert_eq!(points.len(), 1);
        let lone = points[0].corners[0] as usize;
        assert_eq!(mesh.vertices().file_index()[lone], 3);
        let slot = |index: u32| mesh.vertices().file_index().iter().position(|&at| at == index).unwrap();
        let normals = mesh.smooth_normals();
        assert_eq!(normals[lone], Vec3::ZERO);
        assert_eq!(normals[slot(2)], Vec3::Z);
        // The second face is three times as large.
        assert!(normals[slot(0)].distance(Vec3::new(0.0, -3.0, 1.0).normalize()) < 1e-6);
        let of_faces: Vec<Vec3> = records
            .iter()
            .filter(|record| !record.is_point())
            .map(|record| oct_decode(record.normal))
            .collect();
        assert!(
            of_faces.contains(&Vec3::Z) && of_faces.contains(&Vec3::NEG_Y),
            "{of_faces:?}"
        );
    }
}
