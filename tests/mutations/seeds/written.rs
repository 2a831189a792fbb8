//! The smallest files of formats that take a few lines to write.

use draco_core::mesh_encoder::MeshEncoder;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, PointAttribute, PointCloudEncoder, PointIndex,
};
use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue};
use std::io::{Cursor, Write as _};

/// A strip of triangles with colours, or its points alone.
pub(super) fn draco(has_faces: bool) -> Vec<u8> {
    const POINTS: usize = 9;
    let positions = (0..POINTS).flat_map(|point| [point as f32, (point % 2) as f32, 0.5].map(f32::to_le_bytes));
    let positions = positions.flatten().collect::<Vec<u8>>();
    let colors = (0..POINTS)
        .flat_map(|point| [20 * point as u8, 200, 90])
        .collect::<Vec<u8>>();
    let mut mesh = draco_core::Mesh::new();
    mesh.set_num_points(POINTS);
    for (kind, data_type, bytes) in [
        (GeometryAttributeType::Position, DataType::Float32, positions),
        (GeometryAttributeType::Color, DataType::Uint8, colors),
    ] {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, 3, data_type, false, POINTS);
        attribute.buffer_mut().data_mut().copy_from_slice(&bytes);
        mesh.add_attribute(attribute);
    }
    for first in 0..POINTS as u32 - 2 {
        mesh.add_face([first, first + 1, first + 2].map(PointIndex));
    }
    let (options, mut written) = (EncoderOptions::new(), EncoderBuffer::new());
    if has_faces {
        let mut encoder = MeshEncoder::new();
        encoder.set_mesh(mesh);
        encoder.encode(&options, &mut written).unwrap();
    } else {
        let mut encoder = PointCloudEncoder::new();
        encoder.set_point_cloud(mesh.into_point_cloud());
        encoder.encode(&options, &mut written).unwrap();
    }
    written.data().to_vec()
}

/// Positions, half axes, colours and rotations, 32 bytes each.
pub(super) fn splats() -> Vec<u8> {
    let splat = |index: u8| {
        let floats = [f32::from(index), 0.5, -1.0, 0.1, 0.2, 0.01]
            .map(f32::to_le_bytes)
            .concat();
        [floats, vec![index, 100, 200, 255, 255, 128, 128, 128]].concat()
    };
    (0..20).flat_map(splat).collect()
}

/// Two splats, not packed yet: positions in 4096ths, opacities, colours, sizes, rotations.
pub(super) fn spz(version: u32) -> Vec<u8> {
    let mut file = [
        &b"NGSP"[..],
        &version.to_le_bytes(),
        &2u32.to_le_bytes(),
        &[0, 12, 0, 0],
    ]
    .concat();
    let places = [4096i32, -10_240, 1024, -409_600, 0, 30_720];
    file.extend(places.iter().flat_map(|place| place.to_le_bytes()[..3].to_vec()));
    file.extend([255, 64, 128, 255, 0, 153, 128, 128, 176, 160, 128, 176, 160, 128]);
    let turn_bytes = if version < 3 { 3 } else { 4 };
    file.extend(vec![128; 2 * turn_bytes]);
    file
}

/// Two scans of a few points with intensities.
pub(super) fn e57() -> Vec<u8> {
    let double = RecordDataType::Double { min: None, max: None };
    let byte = RecordDataType::Integer { min: 0, max: 255 };
    let axes = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
    let records = axes.map(|name| (name, double.clone())).into_iter();
    let records = records.chain([(RecordName::Intensity, byte)]);
    let records: Vec<Record> = records.map(|(name, data_type)| Record { name, data_type }).collect();
    let mut bytes = Cursor::new(Vec::new());
    let mut file = E57Writer::new(&mut bytes, "file").unwrap();
    for scan in 0..2 {
        let mut writer = file.add_pointcloud("scan", records.clone()).unwrap();
        for point in 0..20 {
            let places = [point, 2 * point, scan].map(|place| RecordValue::Double(f64::from(place)));
            let values = places.into_iter().chain([RecordValue::Integer(i64::from(9 * point))]);
            writer.add_point(values.collect()).unwrap();
        }
        writer.finalize().unwrap();
    }
    file.finalize().unwrap();
    drop(file);
    bytes.into_inner()
}

pub(super) fn zip_of(cube: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for name in ["cube_0.ply", "cube_1.ply"] {
        archive
            .start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(cube).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

pub(super) fn tar_of(cube: &[u8]) -> Vec<u8> {
    let mut archive = tar::Builder::new(Vec::new());
    for name in ["cube_0.ply", "cube_1.ply"] {
        let mut header = tar::Header::new_ustar();
        header.set_size(cube.len() as u64);
        header.set_mode(0o644);
        archive.append_data(&mut header, name, cube).unwrap();
    }
    archive.into_inner().unwrap()
}

pub(super) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packing = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packing.write_all(bytes).unwrap();
    packing.finish().unwrap()
}
