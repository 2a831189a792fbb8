//! Draco compared with sequence files: the same cells, by its kd-tree and its sequential coder.
//!
//! How it works: Draco is given the decoded output of the ten-bit sequence file, so that both store the same points,
//! each once. Cells are integers, which it keeps as they are. Normals are three numbers of eight bits each there, as
//! its own tool has them; colours are lossless, which ours are only on request. Its compression level is 7, the default
//! of its tool.

use super::samples::{Measured, RetainedSamples};
use crate::bench::BenchError;
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;
use crate::reel::DecodedFrame;
use crate::stopwatch::milliseconds_since;
use draco_core::{
    DataType, DecoderBuffer, EncoderBuffer, EncoderOptions, GeometryAttributeType, PointAttribute, PointCloud,
    PointCloudDecoder, PointCloudEncoder,
};
use glam::DVec3;
use std::path::Path;
use std::time::Instant;

/// Draco compression level, 0 to 10.
const COMPRESSION_LEVEL: i32 = 7;

/// Bits of each of the three numbers of a normal.
const NORMAL_BITS: i32 = 8;

/// Draco encoding method for points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coder {
    /// The kd-tree coder, positions alone.
    KdTreePositions,
    /// The kd-tree coder, with colours and normals.
    KdTree,
    /// The sequential coder, with colours and normals.
    Sequential,
}

impl Coder {
    pub(super) const ALL: [Self; 3] = [Self::KdTreePositions, Self::KdTree, Self::Sequential];

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::KdTreePositions => "Draco, 10 bits, positions alone",
            Self::KdTree => "Draco, 10 bits",
            Self::Sequential => "Draco, 10 bits, sequential",
        }
    }

    /// Its number in the format.
    fn method(self) -> i32 {
        match self {
            Self::Sequential => 0,
            Self::KdTree | Self::KdTreePositions => 1,
        }
    }
}

/// Frames as Draco is given them.
pub(super) struct DracoCells {
    frames: Vec<CellFrame>,
}

/// One frame.
struct CellFrame {
    cloud: RawCloud,
    corner: DVec3,
    cell_edge: f64,
    /// In cells from the corner.
    cells: Vec<[u32; 3]>,
}

impl DracoCells {
    pub(super) fn of(decoded: &[DecodedFrame]) -> Self {
        Self {
            frames: decoded.iter().map(CellFrame::of).collect(),
        }
    }

    /// Encodes all frames and decodes them `repeats` times.
    pub(super) fn measure(&self, coder: Coder, repeats: usize, progress: &Progress) -> Result<Measured, BenchError> {
        let count = self.frames.len() as f64;
        let (mut encode_ms, mut decode_ms) = (Vec::new(), Vec::new());
        let mut files = Vec::new();
        for _ in 0..repeats {
            BenchError::check_cancelled(progress)?;
            files.clear();
            let clouds: Vec<PointCloud> = self.frames.iter().map(|frame| frame.point_cloud(coder)).collect();
            let start = Instant::now();
            for cloud in clouds {
                files.push(encoded(cloud, coder)?);
            }
            encode_ms.push(milliseconds_since(start) / count);
            let start = Instant::now();
            for file in &files {
                let mut cloud = PointCloud::new();
                PointCloudDecoder::new()
                    .decode(&mut DecoderBuffer::new(file), &mut cloud)
                    .map_err(|error| BenchError::Draco(error.to_string()))?;
            }
            decode_ms.push(milliseconds_since(start) / count);
        }
        let decoded: Result<Vec<DecodedFrame>, BenchError> = self
            .frames
            .iter()
            .zip(&files)
            .map(|(frame, file)| frame.read_back(file))
            .collect();
        let samples = RetainedSamples {
            frames: files.len(),
            points: self.frames.iter().map(|frame| frame.cells.len()).sum(),
            bytes: files.iter().map(Vec::len).sum(),
            has_attributes: coder != Coder::KdTreePositions,
            bytes_by_stream: None,
            encode_ms,
            decode_ms,
        };
        Ok(Measured {
            samples,
            decoded: decoded?,
        })
    }
}

impl CellFrame {
    fn of(decoded: &DecodedFrame) -> Self {
        let cloud = decoded.cloud.clone();
        let (_, bounds) = cloud.positions.finite_bounds();
        let corner = bounds.unwrap_or_default().0;
        let cell_edge = decoded.cell_edge;
        let cell = |index: usize| {
            ((cloud.positions.get(index) - corner) / cell_edge)
                .round()
                .as_uvec3()
                .to_array()
        };
        Self {
            cells: (0..cloud.positions.len()).map(cell).collect(),
            cloud,
            corner,
            cell_edge,
        }
    }

    fn point_cloud(&self, coder: Coder) -> PointCloud {
        let mut cloud = PointCloud::new();
        cloud.set_num_points(self.cells.len());
        let mut add = |kind, data_type, components: u8, bytes: &[u8]| {
            let mut attribute = PointAttribute::new();
            attribute.init(kind, components, data_type, false, self.cells.len());
            attribute.buffer_mut().data_mut().copy_from_slice(bytes);
            cloud.add_attribute(attribute);
        };
        let cells = bytemuck::cast_slice(&self.cells);
        add(GeometryAttributeType::Position, DataType::Uint32, 3, cells);
        if coder == Coder::KdTreePositions {
            return cloud;
        }
        if let Some(normals) = &self.cloud.attributes.normals {
            let normals = bytemuck::cast_slice(normals);
            add(GeometryAttributeType::Normal, DataType::Float32, 3, normals);
        }
        if let Some(colors) = &self.cloud.attributes.colors {
            let colors: Vec<u8> = colors
                .iter()
                .flat_map(|[red, green, blue, _]| [*red, *green, *blue])
                .collect();
            add(GeometryAttributeType::Color, DataType::Uint8, 3, &colors);
        }
        cloud
    }

    /// Decodes the file as a reader would, in the coordinates of the sequence.
    fn read_back(&self, file: &[u8]) -> Result<DecodedFrame, BenchError> {
        let read = crate::io::read_bytes(Path::new("frame.drc"), file);
        let mut cloud = read.map_err(|error| BenchError::Draco(error.to_string()))?;
        let count = cloud.positions.len();
        let place = |index: usize| (self.corner + cloud.positions.get(index) * self.cell_edge).to_array();
        cloud.positions = Positions::F64((0..count).map(place).collect());
        Ok(DecodedFrame {
            cloud,
            points_in_frame: count,
            levels: 0,
            is_whole: true,
            cell_edge: self.cell_edge,
        })
    }
}

fn encoded(cloud: PointCloud, coder: Coder) -> Result<Vec<u8>, BenchError> {
    let mut options = EncoderOptions::new();
    options.set_compression_level(COMPRESSION_LEVEL);
    options.set_encoding_method(coder.method());
    for attribute in 0..cloud.num_attributes() {
        if cloud.attribute(attribute).attribute_type() == GeometryAttributeType::Normal {
            options.set_attribute_quantization(attribute, NORMAL_BITS);
        }
    }
    let mut encoder = PointCloudEncoder::new();
    encoder.set_point_cloud(cloud);
    let mut buffer = EncoderBuffer::new();
    let written = encoder.encode(&options, &mut buffer);
    written.map_err(|error| BenchError::Draco(error.to_string()))?;
    Ok(buffer.data().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Attributes;

    #[test]
    fn draco_returns_the_cells_it_was_given() {
        let places: Vec<[f64; 3]> = (0..500)
            .map(|index| [index % 10, index / 10 % 10, index / 100].map(|cell| 1e6 + 0.25 * f64::from(cell)))
            .collect();
        let attributes = Attributes {
            colors: Some((0..500).map(|index| [(index % 250) as u8, 7, 9, 255]).collect()),
            normals: Some(vec![[0.0, 0.6, 0.8]; 500]),
            ..Attributes::default()
        };
        let cloud = RawCloud {
            attributes,
            ..RawCloud::from_positions(Positions::F64(places.clone()))
        };
        let decoded = DecodedFrame {
            cloud,
            points_in_frame: 500,
            levels: 4,
            is_whole: true,
            cell_edge: 0.25,
        };
        let cells = DracoCells::of(&[decoded]);
        for coder in Coder::ALL {
            let Measured { samples, decoded } = cells.measure(coder, 1, &Progress::default()).unwrap();
            assert_eq!((samples.points, samples.frames), (500, 1));
            assert!((50..8000).contains(&samples.bytes), "{coder:?}: {}", samples.bytes);
            let cloud = &decoded[0].cloud;
            let mut found: Vec<[f64; 3]> = (0..500).map(|index| cloud.positions.get(index).to_array()).collect();
            let mut expected = places.clone();
            for places in [&mut found, &mut expected] {
                places.sort_by(|a, b| a.partial_cmp(b).unwrap());
            }
            assert_eq!(found, expected, "{coder:?}");
            assert_eq!(cloud.attributes.colors.is_some(), coder != Coder::KdTreePositions);
            if let Some(normals) = &cloud.attributes.normals {
                assert!(
                    normals.iter().all(|normal| (normal[1] - 0.6).abs() < 0.02),
                    "{:?}",
                    normals[0]
                );
            }
        }
    }
}
