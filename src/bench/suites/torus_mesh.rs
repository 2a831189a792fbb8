//! The triangles that points are compared with: those of a file, and a mesh of the torus of [`Shape::Torus`].

use crate::bench::subject::Subject;
use crate::cloud::{CloudError, Mesh, Positions, RawCloud};
use crate::progress::Progress;
use crate::sequence::{Paint, PreparedFrame, PreparedMesh};
use crate::source::Shape;
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// The frame with the triangles of its file; a torus with a mesh of the same number of vertices.
pub(super) fn with_mesh(subject: &Subject<'_>, index: usize, mut frame: PreparedFrame) -> PreparedFrame {
    let mesh = match subject.shape {
        Some(Shape::Torus) => torus_mesh(frame.points.len()).ok(),
        _ => subject.sequence.load_mesh(index, &Progress::default()).ok(),
    };
    let mesh = mesh.filter(|mesh| !mesh.triangles().is_empty());
    frame.mesh = mesh.map(|mesh| PreparedMesh::new(Arc::new(mesh), &Paint::File));
    frame
}

/// A closed grid of about this many vertices, with twice that number of triangles, about as long as wide, in the
/// colours of the shape.
fn torus_mesh(vertices: usize) -> Result<Mesh, CloudError> {
    let tube = Shape::TUBE;
    let around_tube = ((vertices as f32 * tube).sqrt().round() as u32).max(3);
    let around = (vertices as u32 / around_tube).max(3);
    let place = |[along, across]: [u32; 2]| {
        let (sine, cosine) = (TAU * along as f32 / around as f32).sin_cos();
        let (height, aside) = (TAU * across as f32 / around_tube as f32).sin_cos();
        let distance = 1.0 + tube * aside;
        Vec3::new(distance * cosine, distance * sine, tube * height)
    };
    let grid = || (0..around).flat_map(|along| (0..around_tube).map(move |across| [along, across]));
    let positions: Vec<Vec3> = grid().map(place).collect();
    let index = |along: u32, across: u32| along % around * around_tube + across % around_tube;
    let quad = |[along, across]: [u32; 2]| {
        let [a, b] = [index(along, across), index(along, across + 1)];
        let [c, d] = [index(along + 1, across), index(along + 1, across + 1)];
        [[a, c, b], [b, c, d]]
    };
    let color = |position: &Vec3| {
        let [red, green, blue] = Shape::color_at(position.as_dvec3());
        [red, green, blue, 255]
    };
    let mut raw = RawCloud::from_positions(Positions::F32(positions.iter().map(Vec3::to_array).collect()));
    raw.attributes.colors = Some(positions.iter().map(color).collect());
    raw.faces = grid().flat_map(quad).collect();
    Mesh::from_raw(raw, DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use std::collections::HashMap;

    #[test]
    fn the_mesh_is_closed_and_on_the_torus_and_faces_outwards() {
        let mesh = torus_mesh(5000).unwrap();
        let positions = mesh.vertices().positions();
        assert!((4500..=5500).contains(&positions.len()), "{} vertices", positions.len());
        assert_eq!(mesh.triangles().len(), 2 * positions.len());
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for &[a, b, c] in mesh.triangles() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
            let [a, b, c] = [a, b, c].map(|corner| positions[corner as usize]);
            let center = (a + b + c) / 3.0;
            let ring = Vec3::new(center.x, center.y, 0.0).normalize();
            assert!((b - a).cross(c - a).dot(center - ring) > 0.0, "outwards");
        }
        assert!(
            edges.values().all(|&balance| balance == 0),
            "two triangles an edge, turned alike"
        );
        for position in positions {
            let from_ring = Vec2::new(position.truncate().length() - 1.0, position.z);
            assert!((from_ring.length() - Shape::TUBE).abs() < 1e-5);
        }
    }
}
