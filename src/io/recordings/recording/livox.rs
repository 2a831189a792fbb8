//! `CustomMsg` of the drivers of Livox: points with the time at which each was measured.
//!
//! The same fields in all drivers (`livox_ros_driver`, `livox_ros_driver2`, `livox_interfaces`), in the serialisations
//! of ROS 1 and ROS 2: <https://github.com/Livox-SDK/livox_ros_driver2/blob/master/msg/CustomMsg.msg>.

use super::bytes::Bytes;
use super::serialisation::Serialisation;
use crate::cloud::{AxisConvention, Positions, RawCloud, ScalarField};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;

/// The name of the message in every package of Livox.
const TYPE: &str = "CustomMsg";
const PACKAGES: &str = "livox";

/// Bytes of a point without alignment.
const MIN_POINT_BYTES: usize = 19;

/// Bytes of a point in the cloud: a position and four numbers.
const POINT_BYTES: u64 = 28;

const SECONDS_PER_TICK: f64 = 1e-9;

/// Returns true if messages of this type are Livox clouds: `package/CustomMsg` or `package/msg/CustomMsg`.
pub(super) fn is_type(kind: &str) -> bool {
    let mut parts = kind.split('/');
    parts.next().is_some_and(|package| package.starts_with(PACKAGES)) && parts.next_back() == Some(TYPE)
}

/// The numbers of a message, a column each.
#[derive(Default)]
struct Columns {
    positions: Vec<[f32; 3]>,
    reflectivity: Vec<f32>,
    tag: Vec<f32>,
    line: Vec<f32>,
    time_s: Vec<f32>,
}

impl Columns {
    /// Appends the next point of `fields`; `None` where they end before it does.
    fn push(&mut self, fields: &mut Bytes<'_>) -> Option<()> {
        let offset_time = fields.u32()?;
        self.positions.push([fields.f32()?, fields.f32()?, fields.f32()?]);
        self.reflectivity.push(f32::from(fields.u8()?));
        self.tag.push(f32::from(fields.u8()?));
        self.line.push(f32::from(fields.u8()?));
        self.time_s.push((f64::from(offset_time) * SECONDS_PER_TICK) as f32);
        Some(())
    }

    fn finish(self) -> RawCloud {
        let mut cloud = RawCloud::from_positions(Positions::F32(self.positions));
        cloud.attributes.scalars = vec![
            ScalarField::new("reflectivity", self.reflectivity),
            ScalarField::new("time", self.time_s),
            ScalarField::new("line", self.line),
            ScalarField::new("tag", self.tag),
        ];
        cloud.convention = Some(AxisConvention::UsuallyZUp);
        cloud
    }
}

/// The fields from the list of points on, and the number of points that it claims.
fn points(message: &[u8], serialisation: Serialisation) -> Option<(Bytes<'_>, u32)> {
    let mut fields = serialisation.body(message)?;
    serialisation.header(&mut fields)?;
    let _timebase_ns = fields.u64()?;
    let _point_count = fields.u32()?;
    let _lidar = fields.u8()?;
    let _reserved = fields.take(3)?;
    let count = fields.u32()?;
    Some((fields, count))
}

/// The cloud of a message. Times of points are seconds since the time of the frame.
pub(super) fn decode(message: &[u8], serialisation: Serialisation, options: &ReadOptions) -> Result<RawCloud, Fault> {
    let cut = |problem: &str| Fault::header(format!("{problem}: it is truncated or damaged"));
    let (mut fields, count) =
        points(message, serialisation).ok_or_else(|| cut("the message ends before its points"))?;
    if count as usize > message.len() / MIN_POINT_BYTES {
        return Err(cut(&format!(
            "the message claims {count} points of {MIN_POINT_BYTES} bytes, and has {} bytes",
            message.len()
        )));
    }
    options.claim("the cloud", u64::from(count) * POINT_BYTES)?;
    let mut columns = Columns::default();
    for index in 0..count {
        columns
            .push(&mut fields)
            .ok_or_else(|| cut(&format!("the message ends in point {index} of {count}")))?;
    }
    Ok(columns.finish())
}
