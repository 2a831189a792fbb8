//! Ray casting of the triangles of a file, one ray at a time.
//!
//! How it works: the nearest triangle that a ray meets is seen ([`TriangleTree`]). Its colour is the vertices', times
//! its texture in linear light, and its normal the vertices', if the file has some, else the face's: as in the mesh
//! primitive (`shaders/primitives/mesh.wgsl`), in f64. Texels are read as there, between four of them; the samples of a
//! pixel are their filter.
//!
//! Triangles have two sides, unlike disks and shapes. Their order of corners is not reliable in scans: to cull by it
//! would punch holes into the truth. And a surface occludes from either side. Closed meshes are the same with and
//! without. Vertices that belong to no triangle have no area and are not seen.

use super::light::{to_display, to_linear};
use super::rays::{Hit, SampleGrid, TruthView, Visible, unit_color};
use super::triangle_tree::{Ray, TriangleHit, TriangleTree};
use crate::cloud::{MeshRecords, VertexRecord, oct_decode};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Triangles to be met by rays.
#[derive(Debug)]
pub struct TracedMesh {
    records: Arc<MeshRecords>,
    /// Places among the records of the triangles of the tree.
    triangles: Vec<u32>,
    tree: TriangleTree,
}

impl TracedMesh {
    /// Sorts the triangles of `records` for rays.
    pub fn new(records: Arc<MeshRecords>) -> Self {
        let places = (0..).zip(records.triangles.iter());
        let triangles: Vec<u32> = places
            .filter(|(_, record)| !record.is_point())
            .map(|(place, _)| place)
            .collect();
        let corners: Vec<[DVec3; 3]> = triangles.iter().map(|&place| corners(&records, place)).collect();
        Self {
            tree: TriangleTree::new(&corners),
            triangles,
            records,
        }
    }

    /// Surface that a ray of a view hits.
    fn hit(&self, view: &TruthView, ray: DVec3, tolerance: f64, met: &TriangleHit) -> Hit {
        let place = self.triangles[met.triangle];
        let vertices = self.records.triangles[place as usize]
            .corners
            .map(|corner| &self.records.vertices[corner as usize]);
        let mean = |values: [DVec3; 3]| -> DVec3 {
            let shares = values.into_iter().zip(met.shares);
            shares.map(|(value, share)| share * value).sum()
        };
        let mut color = mean(vertices.map(|vertex| {
            let [red, green, blue, _] = vertex.color;
            unit_color([red, green, blue])
        }));
        // The texture of the first corner: the others have the same.
        if vertices[0].texture != VertexRecord::NO_TEXTURE {
            let at = mean(
                vertices.map(|vertex| DVec3::new(vertex.texture_place[0].into(), vertex.texture_place[1].into(), 0.0)),
            );
            let texel = self
                .records
                .textures
                .color(vertices[0].texture as usize, [at.x as f32, at.y as f32]);
            let texel = DVec3::from_array(texel.map(f64::from));
            color = to_display(to_linear(color) * to_linear(texel));
        }
        let [a, b, c] = corners(&self.records, place);
        let face = (b - a).cross(c - a).normalize_or_zero();
        let normal = mean(vertices.map(|vertex| match vertex.normal {
            VertexRecord::NO_NORMAL => face,
            packed => oct_decode(packed).as_dvec3(),
        }));
        let normal = normal.try_normalize().unwrap_or(face);
        Hit {
            depth: met.depth,
            color: view.lit(color, view.view_from_frame * normal, ray),
            tolerance,
        }
    }
}

/// The corners of a record, relative to the sequence origin.
fn corners(records: &MeshRecords, place: u32) -> [DVec3; 3] {
    records.corners(place as usize).map(Vec3::as_dvec3)
}

/// A mesh with the tolerance of its depths.
pub(super) struct ToleratedMesh<'a> {
    pub(super) mesh: &'a TracedMesh,
    pub(super) tolerance: f64,
}

impl Visible for ToleratedMesh<'_> {
    fn meet(&self, view: &TruthView, samples: &SampleGrid) -> Vec<Option<Hit>> {
        let [columns, rows] = samples.size();
        let frame_from_view = view.view_from_frame.transpose();
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        places
            .map(|(column, row)| {
                let ray = view.ray(samples.place_px(column, row));
                let met = self.mesh.tree.nearest(&Ray::new(view.eye, frame_from_view * ray))?;
                Some(self.mesh.hit(view, ray, self.tolerance, &met))
            })
            .collect()
    }
}
