//! The points of one scan: from its fields to positions, colours, normals and scalars, in the coordinates of the file.

use super::streams::{self, FieldStream, Pages, bits};
use crate::io::columns::attributes;
use crate::io::columns::unique_names::UniqueNames;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use ::e57::{PointCloud, RecordDataType, RecordName, RecordValue};
use glam::{DQuat, DVec3};

/// Name of the field that every scan gets if one has it.
pub(super) const INTENSITY: &str = "intensity";

/// Scalars: our name and the file's; all others retain theirs.
const SCALARS: [(&str, RecordName); 4] = [
    (INTENSITY, RecordName::Intensity),
    ("timestamp", RecordName::TimeStamp),
    ("return_number", RecordName::ReturnIndex),
    ("number_of_returns", RecordName::ReturnCount),
];

/// Names of the extension for surface normals.
const NORMALS: [&str; 3] = ["normalX", "normalY", "normalZ"];

/// The name of a scalar that is not among [`SCALARS`]: the file's. `None` for other records.
fn other_name(record: &RecordName) -> Option<String> {
    match record {
        RecordName::RowIndex => Some("rowIndex".to_owned()),
        RecordName::ColumnIndex => Some("columnIndex".to_owned()),
        RecordName::Unknown { name, .. } => Some(name.clone()),
        _ => None,
    }
}

/// Points of a scan whose fields are all constant, and that therefore no bytes vouch for.
const MAX_CONSTANT_POINTS: u64 = 1 << 16;

/// The points of a scan, all in the same order.
pub(super) struct Scan {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) colors: Option<Vec<[u8; 4]>>,
    pub(super) normals: Option<Vec<[f32; 3]>>,
    pub(super) scalars: Vec<(String, Vec<f64>)>,
}

/// Fails where `scans` have more points than fit into `file_bytes`, or more than `options` allow.
pub(super) fn check_claims(scans: &[PointCloud], file_bytes: usize, options: &ReadOptions) -> Result<(), Fault> {
    /// Memory of a point in bytes while it is read, in addition to its fields as stored in the file.
    const POINT_BYTES: u128 = 96;
    let (mut claimed_bits, mut memory_bytes) = (0u128, 0u128);
    for (index, scan) in scans.iter().enumerate() {
        let point_bits: u128 = scan
            .prototype
            .iter()
            .map(|record| u128::from(bits(&record.data_type)))
            .sum();
        claimed_bits += u128::from(scan.records) * point_bits;
        memory_bytes += u128::from(scan.records) * (POINT_BYTES + point_bits / 8);
        if claimed_bits > file_bytes as u128 * 8 || point_bits == 0 && scan.records > MAX_CONSTANT_POINTS {
            return Err(Fault::entry(
                "scan",
                index,
                format!(
                    "it claims {} points, more than can be in a file of {file_bytes} bytes: the file is truncated, or \
                     its description is wrong",
                    scan.records
                ),
            ));
        }
    }
    options.claim("the scans", u64::try_from(memory_bytes).unwrap_or(u64::MAX))
}

impl Scan {
    /// Scan `index` of the file. Precondition: [`check_claims`].
    pub(super) fn read(index: usize, scan: &PointCloud, pages: &Pages, progress: &Progress) -> Result<Self, Fault> {
        let count = scan.records as usize;
        let streams = if count == 0 {
            Vec::new()
        } else {
            streams::read(index, scan, pages, progress)?
        };
        let fields = ScanFields { scan, streams, count };
        let rotation = rotation(scan);
        Ok(Self {
            positions: fields.positions(index, rotation)?,
            colors: fields.colors(),
            normals: fields.normals(rotation),
            scalars: fields.scalars(),
        })
    }
}

struct ScanFields<'a> {
    scan: &'a PointCloud,
    streams: Vec<FieldStream<'a>>,
    count: usize,
}

impl ScanFields<'_> {
    /// Returns true if the scan has such a field, even without a point.
    fn has(&self, name: &RecordName) -> bool {
        self.scan.prototype.iter().any(|record| record.name == *name)
    }

    fn stream(&self, name: &RecordName) -> Option<&FieldStream<'_>> {
        self.streams.iter().find(|stream| stream.record.name == *name)
    }

    fn column(&self, name: &RecordName) -> Option<Vec<f64>> {
        if !self.has(name) {
            return None;
        }
        let mut values = vec![0.0; self.count];
        if let Some(stream) = self.stream(name) {
            stream.for_each(self.count, |index, value| values[index] = value);
        }
        Some(values)
    }

    /// All records that are not positions, colours or normals, known names first.
    fn scalars(&self) -> Vec<(String, Vec<f64>)> {
        let mut names = UniqueNames::default();
        let known = SCALARS.into_iter().map(|(name, record)| (name.to_owned(), record));
        let others = self.scan.prototype.iter().filter_map(|record| {
            let name = other_name(&record.name)?;
            let is_normal = NORMALS.contains(&name.as_str()) && self.normal_names().is_some();
            (!is_normal).then(|| (name, record.name.clone()))
        });
        let mut scalars = Vec::new();
        for (name, record) in known.chain(others) {
            let Some(mut values) = self.column(&record) else {
                continue;
            };
            let invalid = match record {
                RecordName::Intensity => self.column(&RecordName::IsIntensityInvalid),
                RecordName::TimeStamp => self.column(&RecordName::IsTimeStampInvalid),
                _ => None,
            };
            for (value, invalid) in values.iter_mut().zip(invalid.unwrap_or_default()) {
                *value = if invalid == 0.0 { *value } else { 0.0 };
            }
            scalars.push((names.take(&name, attributes::plain_scalar_name), values));
        }
        scalars
    }

    /// The names of the extension for surface normals, under whatever prefix a file gives it.
    fn normal_names(&self) -> Option<[RecordName; 3]> {
        let axis = |axis: &str| {
            self.scan.prototype.iter().find_map(|record| match &record.name {
                RecordName::Unknown { name, .. } if name == axis => Some(record.name.clone()),
                _ => None,
            })
        };
        let [x, y, z] = NORMALS.map(axis);
        Some([x?, y?, z?])
    }

    /// Three columns as vectors; `None` if one is missing.
    fn vectors(&self, names: &[RecordName; 3]) -> Option<Vec<[f64; 3]>> {
        if !names.iter().all(|name| self.has(name)) {
            return None;
        }
        let mut vectors = vec![[0.0; 3]; self.count];
        for (axis, name) in names.iter().enumerate() {
            if let Some(stream) = self.stream(name) {
                stream.for_each(self.count, |index, value| vectors[index][axis] = value);
            }
        }
        Some(vectors)
    }

    /// Coordinates in metres, not a number where there are only directions or nothing at all.
    fn positions(&self, scan: usize, rotation: DQuat) -> Result<Vec<[f64; 3]>, Fault> {
        const CARTESIAN: [RecordName; 3] = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
        const SPHERICAL: [RecordName; 3] = [
            RecordName::SphericalRange,
            RecordName::SphericalAzimuth,
            RecordName::SphericalElevation,
        ];
        let cartesian = self.vectors(&CARTESIAN);
        let spherical = self.vectors(&SPHERICAL).map(|mut vectors| {
            self.invalidate(&mut vectors, &RecordName::SphericalInvalidState);
            for vector in &mut vectors {
                let [range, azimuth, elevation] = *vector;
                let across = range * elevation.cos();
                *vector = [across * azimuth.cos(), across * azimuth.sin(), range * elevation.sin()];
            }
            vectors
        });
        let mut positions = match (cartesian, spherical) {
            (Some(mut positions), spherical) => {
                self.invalidate(&mut positions, &RecordName::CartesianInvalidState);
                for (position, other) in positions.iter_mut().zip(spherical.unwrap_or_default()) {
                    if position[0].is_nan() {
                        *position = other;
                    }
                }
                positions
            }
            (None, Some(positions)) => positions,
            (None, None) => {
                return Err(Fault::entry(
                    "scan",
                    scan,
                    "its points have no coordinates: expected cartesianX, Y, Z or sphericalRange, Azimuth, Elevation",
                ));
            }
        };
        if let Some(pose) = &self.scan.transform {
            let place = DVec3::new(pose.translation.x, pose.translation.y, pose.translation.z);
            for position in &mut positions {
                *position = (rotation * DVec3::from_array(*position) + place).to_array();
            }
        }
        Ok(positions)
    }

    /// Makes those that `state` calls invalid, or directions only, no numbers.
    fn invalidate(&self, vectors: &mut [[f64; 3]], state: &RecordName) {
        if let Some(stream) = self.stream(state) {
            stream.for_each(self.count, |index, state| {
                if state != 0.0 {
                    vectors[index] = [f64::NAN; 3];
                }
            });
        }
    }

    fn normals(&self, rotation: DQuat) -> Option<Vec<[f32; 3]>> {
        let normals = self.vectors(&self.normal_names()?)?;
        let turned = |normal: [f64; 3]| (rotation * DVec3::from_array(normal)).as_vec3().to_array();
        Some(normals.into_iter().map(turned).collect())
    }

    fn colors(&self) -> Option<Vec<[u8; 4]>> {
        const CHANNELS: [RecordName; 3] = [RecordName::ColorRed, RecordName::ColorGreen, RecordName::ColorBlue];
        let channels = self.vectors(&CHANNELS)?;
        let largest = channels.iter().flatten().copied().fold(0.0, f64::max);
        let ranges = [0, 1, 2].map(|channel| self.range(channel, &CHANNELS[channel], largest));
        let mut colors: Vec<[u8; 4]> = channels
            .into_iter()
            .map(|values| {
                let [red, green, blue] = [0, 1, 2].map(|channel| {
                    let (dark, bright) = ranges[channel];
                    ((values[channel] - dark) / (bright - dark) * 255.0).round() as u8
                });
                [red, green, blue, 255]
            })
            .collect();
        if let Some(stream) = self.stream(&RecordName::IsColorInvalid) {
            stream.for_each(self.count, |index, invalid| {
                if invalid != 0.0 {
                    colors[index] = [255; 4];
                }
            });
        }
        Some(colors)
    }

    /// Returns the value range, black and white level, of a colour channel: from the limits of the scan, the limits of
    /// the field, or the largest value.
    fn range(&self, channel: usize, name: &RecordName, largest: f64) -> (f64, f64) {
        let kind = self
            .scan
            .prototype
            .iter()
            .find(|record| record.name == *name)
            .map(|record| &record.data_type);
        let number = |limit: &Option<RecordValue>| limit.as_ref()?.to_f64(kind?).ok();
        let by_scan = self.scan.color_limits.as_ref().and_then(|limits| {
            let (min, max) = [
                (&limits.red_min, &limits.red_max),
                (&limits.green_min, &limits.green_max),
                (&limits.blue_min, &limits.blue_max),
            ][channel];
            Some((number(min)?, number(max)?))
        });
        let by_field = || match *kind? {
            RecordDataType::Integer { min, max } => Some((min as f64, max as f64)),
            RecordDataType::ScaledInteger {
                min,
                max,
                scale,
                offset,
            } => Some((min as f64 * scale + offset, max as f64 * scale + offset)),
            RecordDataType::Single { min, max } => Some((f64::from(min?), f64::from(max?))),
            RecordDataType::Double { min, max } => Some((min?, max?)),
        };
        // Invalid limits mean the full range of the type.
        let is_range = |&(min, max): &(f64, f64)| max > min && max - min <= f64::from(u32::MAX);
        by_scan
            .filter(is_range)
            .or_else(|| by_field().filter(is_range))
            .unwrap_or((
                0.0,
                match largest {
                    ..=1.0 => 1.0,
                    ..=255.0 => 255.0,
                    _ => 65535.0,
                },
            ))
    }
}

/// Returns the rotation of the scan's pose.
fn rotation(scan: &PointCloud) -> DQuat {
    let Some(pose) = &scan.transform else {
        return DQuat::IDENTITY;
    };
    let turn = &pose.rotation;
    let turn = DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w);
    let length = turn.length();
    // A quaternion without a length is not a rotation.
    if length.is_finite() && length > 0.0 {
        turn / length
    } else {
        DQuat::IDENTITY
    }
}
