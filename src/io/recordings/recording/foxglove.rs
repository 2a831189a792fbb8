//! `foxglove.PointCloud`: rows of points whose fields are named, as a message of Protocol Buffers or as JSON;
//! <https://docs.foxglove.dev/docs/sdk/schemas/point-cloud>.

use super::protobuf::{MessageFields, Value};
use crate::cloud::{Positions, RawCloud};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::growing;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{DQuat, DVec3};
use serde::Deserialize;
use std::borrow::Cow;
use std::time::Duration;

const NANOS_PER_SECOND: u64 = 1_000_000_000;
/// The key of the time in JSON.
const TIMESTAMP: &[u8] = b"\"timestamp\"";

/// The point cloud of a message.
#[derive(Default)]
struct Cloud<'a> {
    pose: Pose,
    point_stride: u64,
    fields: Vec<PackedElementField>,
    data: Cow<'a, [u8]>,
}

/// Pose of the cloud in its frame of reference.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Pose {
    position: PoseComponents,
    orientation: PoseComponents,
}

/// A vector or a quaternion.
#[derive(Default, Deserialize)]
#[serde(default)]
struct PoseComponents {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct PackedElementField {
    name: String,
    offset: u64,
    #[serde(rename = "type")]
    kind: u64,
}

#[derive(Deserialize)]
struct JsonCloud {
    #[serde(default)]
    pose: Pose,
    point_stride: u64,
    fields: Vec<PackedElementField>,
    data: String,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct JsonTime {
    sec: u64,
    nsec: u64,
}

/// Acquisition time of the cloud, if `start`, the first bytes of a message of Protocol Buffers, has it.
pub(super) fn protobuf_stamp(start: &[u8]) -> Option<Duration> {
    let time = MessageFields::new(start).map_while(|field| field);
    let time = time.into_iter().find(|(number, _)| *number == 1)?.1.bytes();
    let (mut seconds, mut nanos) = (0, 0);
    for field in MessageFields::new(time) {
        match field? {
            (1, value) => seconds = value.number(),
            (2, value) => nanos = value.number(),
            _ => {}
        }
    }
    time_of(seconds, nanos)
}

/// Acquisition time of the cloud, if `start`, the first bytes of a message in JSON, has it.
pub(super) fn json_stamp(start: &[u8]) -> Option<Duration> {
    let mut rest = start;
    loop {
        let at = rest.windows(TIMESTAMP.len()).position(|key| key == TIMESTAMP)?;
        rest = &rest[at + TIMESTAMP.len()..];
        // A field of the points may have that name, too; only the key is followed by a value.
        if let Some(value) = rest.trim_ascii_start().strip_prefix(b":") {
            let mut value = serde_json::Deserializer::from_slice(value);
            let time = JsonTime::deserialize(&mut value).ok()?;
            return time_of(time.sec, time.nsec);
        }
    }
}

/// Zero is not a time, nor is a negative number, before 1970.
fn time_of(seconds: u64, nanos: u64) -> Option<Duration> {
    let is_time = i64::try_from(seconds).is_ok() && nanos < NANOS_PER_SECOND && (seconds, nanos) != (0, 0);
    is_time.then(|| Duration::new(seconds, nanos as u32))
}

/// The cloud of a message of Protocol Buffers.
pub(super) fn decode_protobuf(message: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let cloud =
        parse(message).ok_or_else(|| Fault::header("the message ends within a field: it is truncated or damaged"))?;
    cloud.decode(options)
}

/// The cloud of a message in JSON.
pub(super) fn decode_json(message: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let cloud: JsonCloud = serde_json::from_slice(message)
        .map_err(|error| Fault::header(format!("the message is not a foxglove.PointCloud: {error}")))?;
    let data = STANDARD
        .decode(&cloud.data)
        .map_err(|error| Fault::header(format!("`data` is not in base 64: {error}")))?;
    let cloud = Cloud {
        pose: cloud.pose,
        point_stride: cloud.point_stride,
        fields: cloud.fields,
        data: data.into(),
    };
    cloud.decode(options)
}

fn parse(message: &[u8]) -> Option<Cloud<'_>> {
    let mut cloud = Cloud::default();
    for field in MessageFields::new(message) {
        match field? {
            (3, value) => cloud.pose = pose(value)?,
            (4, value) => cloud.point_stride = value.number(),
            (5, value) => cloud.fields.push(packed_field(value)?),
            (6, value) => cloud.data = value.bytes().into(),
            _ => {}
        }
    }
    Some(cloud)
}

fn pose(message: Value<'_>) -> Option<Pose> {
    let mut pose = Pose::default();
    for field in MessageFields::new(message.bytes()) {
        match field? {
            (1, value) => pose.position = numbers(value)?,
            (2, value) => pose.orientation = numbers(value)?,
            _ => {}
        }
    }
    Some(pose)
}

fn numbers(message: Value<'_>) -> Option<PoseComponents> {
    let mut numbers = PoseComponents::default();
    for field in MessageFields::new(message.bytes()) {
        match field? {
            (1, value) => numbers.x = value.double(),
            (2, value) => numbers.y = value.double(),
            (3, value) => numbers.z = value.double(),
            (4, value) => numbers.w = value.double(),
            _ => {}
        }
    }
    Some(numbers)
}

fn packed_field(message: Value<'_>) -> Option<PackedElementField> {
    let mut packed = PackedElementField::default();
    for field in MessageFields::new(message.bytes()) {
        match field? {
            (1, value) => packed.name = String::from_utf8_lossy(value.bytes()).into_owned(),
            (2, value) => packed.offset = value.number(),
            (3, value) => packed.kind = value.number(),
            _ => {}
        }
    }
    Some(packed)
}

impl Cloud<'_> {
    fn decode(&self, options: &ReadOptions) -> Result<RawCloud, Fault> {
        let (bytes, stride) = (self.data.len() as u64, self.point_stride);
        let Some(count) = bytes.checked_div(stride).or((bytes == 0).then_some(0)) else {
            return Err(Fault::header("points of 0 bytes, expected a `point_stride` above 0"));
        };
        if count * stride != bytes {
            return Err(Fault::header(format!(
                "{bytes} bytes of points are there, expected a multiple of {stride}, the size of one: the message is \
                 truncated"
            )));
        }
        let columns: Result<Vec<_>, _> = self.fields.iter().map(|field| self.column(field)).collect();
        let mut cloud = growing::cloud(&columns?, count as usize, options)?;
        self.pose.apply(&mut cloud)?;
        Ok(cloud)
    }

    fn column(&self, field: &PackedElementField) -> Result<Column<'_>, Fault> {
        let Some(scalar) = scalar(field.kind) else {
            return Err(Fault::header(format!(
                "field `{}` is of type {}, expected 1 to 8",
                field.name, field.kind
            )));
        };
        let end = field.offset.saturating_add(scalar.byte_size() as u64);
        if end > self.point_stride && !self.data.is_empty() {
            return Err(Fault::header(format!(
                "field `{}` ends at byte {end} of a point, which has {}",
                field.name, self.point_stride
            )));
        }
        Ok(Column {
            name: field.name.clone(),
            scalar,
            values: Values::Packed {
                bytes: &self.data,
                start: field.offset as usize,
                step: self.point_stride as usize,
                big_endian: false,
            },
        })
    }
}

impl Pose {
    /// Moves the points of `cloud` into the frame of reference.
    fn apply(&self, cloud: &mut RawCloud) -> Result<(), Fault> {
        let (p, q) = (&self.position, &self.orientation);
        let position = DVec3::new(p.x, p.y, p.z);
        let orientation = DQuat::from_xyzw(q.x, q.y, q.z, q.w);
        if !position.is_finite() || !orientation.is_finite() {
            return Err(Fault::header("the pose has numbers that are not finite"));
        }
        // An absent rotation is all zeros.
        let rotation = if orientation.length_squared() > 0.0 {
            orientation.normalize()
        } else {
            DQuat::IDENTITY
        };
        if (position, rotation) == (DVec3::ZERO, DQuat::IDENTITY) {
            return Ok(());
        }
        let points =
            (0..cloud.positions.len()).map(|index| (rotation * cloud.positions.get(index) + position).to_array());
        cloud.positions = Positions::F64(points.collect());
        let rotation = rotation.as_quat();
        for normal in cloud.attributes.normals.iter_mut().flatten() {
            *normal = (rotation * glam::Vec3::from_array(*normal)).to_array();
        }
        Ok(())
    }
}

fn scalar(kind: u64) -> Option<Scalar> {
    Some(match kind {
        1 => Scalar::U8,
        2 => Scalar::I8,
        3 => Scalar::U16,
        4 => Scalar::I16,
        5 => Scalar::U32,
        6 => Scalar::I32,
        7 => Scalar::F32,
        8 => Scalar::F64,
        _ => return None,
    })
}
