//! Draco files written by the crate's encoder: clouds, meshes, and the remains of damaged ones.

use draco_core::mesh_encoder::MeshEncoder;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, PointAttribute, PointCloudEncoder,
};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io;
use std::path::Path;
use std::time::{Duration, Instant};

const POINTS: usize = 9;

fn attribute(kind: GeometryAttributeType, data_type: DataType, bytes: &[u8]) -> PointAttribute {
    let components = bytes.len() / POINTS / data_type.byte_length();
    let mut attribute = PointAttribute::new();
    attribute.init(kind, components as u8, data_type, false, POINTS);
    attribute.buffer_mut().data_mut().copy_from_slice(bytes);
    attribute
}

fn position(index: usize) -> [f32; 3] {
    let index = index as f32;
    [index, 2.0 - index, index * index]
}

fn color(index: usize) -> [u8; 4] {
    [index as u8, 200, 255 - index as u8, 255]
}

/// A strip of triangles.
fn mesh() -> Mesh {
    let floats = |values: Vec<[f32; 3]>| -> Vec<u8> {
        let values = values.into_iter().flatten();
        values.flat_map(f32::to_le_bytes).collect()
    };
    let mut mesh = Mesh::new();
    mesh.set_num_points(POINTS);
    mesh.add_attribute(attribute(
        GeometryAttributeType::Position,
        DataType::Float32,
        &floats((0..POINTS).map(position).collect()),
    ));
    mesh.add_attribute(attribute(
        GeometryAttributeType::Normal,
        DataType::Float32,
        &floats(vec![[0.0, 0.0, 1.0]; POINTS]),
    ));
    let colors: Vec<u8> = (0..POINTS).flat_map(color).collect();
    mesh.add_attribute(attribute(GeometryAttributeType::Color, DataType::Uint8, &colors));
    for start in 0..POINTS - 2 {
        // Every other one is reversed, so that all face the same side.
        let (second, third) = (start + 1 + start % 2, start + 2 - start % 2);
        let corners = [start, second, third].map(|point| point as u32);
        mesh.add_face(corners.map(draco_core::PointIndex));
    }
    mesh
}

/// The mesh, and its points alone.
fn files() -> [Vec<u8>; 2] {
    let options = EncoderOptions::new();
    let mut faces = EncoderBuffer::new();
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh());
    encoder.encode(&options, &mut faces).unwrap();
    let mut points = EncoderBuffer::new();
    let mut encoder = PointCloudEncoder::new();
    encoder.set_point_cloud(mesh().into_point_cloud());
    encoder.encode(&options, &mut points).unwrap();
    [faces, points].map(|buffer| buffer.data().to_vec())
}

fn read(bytes: &[u8]) -> Result<RawCloud, io::IoError> {
    io::read_bytes(Path::new("a.drc"), bytes)
}

#[test]
fn clouds_and_meshes_are_read_with_their_attributes() {
    for (file, faces) in files().into_iter().zip([POINTS - 2, 0]) {
        let cloud = read(&file).unwrap();
        assert_eq!(cloud.faces.len(), faces);
        let Positions::F32(positions) = &cloud.positions else {
            panic!("not of single precision");
        };
        let mut found: Vec<([i32; 3], [u8; 4])> = positions
            .iter()
            .zip(cloud.attributes.colors.as_ref().unwrap())
            .map(|(position, color)| (position.map(|value| value.round() as i32), *color))
            .collect();
        found.sort_unstable();
        let expected: Vec<_> = (0..POINTS)
            .map(|index| (position(index).map(|value| value as i32), color(index)))
            .collect();
        assert_eq!(found, expected);
        for normal in cloud.attributes.normals.as_ref().unwrap() {
            assert!(normal[2] > 0.99, "{normal:?}");
        }
        assert!(cloud.faces.iter().flatten().all(|&point| (point as usize) < POINTS));
    }
}

#[test]
fn damaged_files_are_refused_and_never_panic() {
    for file in files() {
        for length in 0..file.len() {
            assert!(read(&file[..length]).is_err(), "{length}");
        }
        for at in 0..file.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut file = file.clone();
                file[at] ^= change;
                let start = Instant::now();
                if let Ok(cloud) = read(&file) {
                    let count = cloud.positions.len();
                    let is_inside = |&point: &u32| (point as usize) < count;
                    assert!(cloud.faces.iter().flatten().all(is_inside), "byte {at}");
                }
                assert!(start.elapsed() < Duration::from_secs(5), "byte {at}");
            }
        }
    }
}
