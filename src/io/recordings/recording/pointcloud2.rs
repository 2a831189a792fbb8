//! `sensor_msgs/PointCloud2`: rows of points whose fields are named, in the serialisations of ROS 1 and ROS 2.

use super::serialisation::Serialisation;
use crate::cloud::{AxisConvention, ImageGrid, RawCloud};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::growing;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use std::borrow::Cow;

/// Is in the names of frames that look along Z with Y down (REP 103, "Suffix Frames").
const OPTICAL: &[u8] = b"optical";

/// Max numbers of a field: more than the longest descriptors have.
const MAX_NUMBERS: u64 = 2048;

struct PointField {
    name: String,
    offset: u32,
    datatype: u8,
    count: u32,
}

struct Cloud<'a> {
    /// The name of the coordinate frame.
    frame_id: &'a [u8],
    height: u32,
    width: u32,
    fields: Vec<PointField>,
    big_endian: bool,
    point_step: u32,
    row_step: u32,
    data: &'a [u8],
}

fn parse(message: &[u8], serialisation: Serialisation) -> Option<Cloud<'_>> {
    let mut fields = serialisation.body(message)?;
    let frame_id = serialisation.header(&mut fields)?.frame_id;
    let (height, width) = (fields.u32()?, fields.u32()?);
    let field_count = fields.u32()?;
    // Not allocated for the claimed count: every field takes bytes that must be there.
    let mut list = Vec::new();
    for _ in 0..field_count {
        list.push(PointField {
            name: fields.text()?,
            offset: fields.u32()?,
            datatype: fields.u8()?,
            count: fields.u32()?,
        });
    }
    Some(Cloud {
        frame_id,
        height,
        width,
        fields: list,
        big_endian: fields.u8()? != 0,
        point_step: fields.u32()?,
        row_step: fields.u32()?,
        data: fields.counted()?,
    })
}

/// The cloud of a message.
pub(super) fn decode(message: &[u8], serialisation: Serialisation, options: &ReadOptions) -> Result<RawCloud, Fault> {
    let cloud = parse(message, serialisation)
        .ok_or_else(|| Fault::header("the message ends before its last field: it is truncated or damaged"))?;
    let grid = Grid::of(&cloud)?;
    let gapless = grid.count().saturating_mul(grid.point_step);
    options.claim("the cloud", gapless)?;
    let bytes = grid.without_gaps(cloud.data);
    let options = &options.holding(if let Cow::Owned(bytes) = &bytes { bytes.len() } else { 0 });
    let mut columns = Vec::new();
    for field in &cloud.fields {
        columns.extend(numbers(field, &cloud, &grid, &bytes)?);
    }
    let mut read = growing::cloud(&columns, grid.count() as usize, options)?;
    read.convention = Some(convention(&cloud));
    read.grid = ImageGrid::of(cloud.width, cloud.height, read.positions.len());
    Ok(read)
}

/// Layout of the points in the bytes of a cloud.
struct Grid {
    width: u64,
    height: u64,
    point_step: u64,
    row_step: u64,
}

impl Grid {
    /// Fails where there are fewer bytes than that.
    fn of(cloud: &Cloud<'_>) -> Result<Self, Fault> {
        let (width, height) = (u64::from(cloud.width), u64::from(cloud.height));
        let (point_step, row_step) = (u64::from(cloud.point_step), u64::from(cloud.row_step));
        let row_bytes = width * point_step;
        // A single line needs no row step; some writers leave it at zero.
        let row_step = if height <= 1 { row_bytes } else { row_step };
        let needed = row_step
            .saturating_mul(height.saturating_sub(1))
            .saturating_add(row_bytes);
        let grid = Self {
            width,
            height,
            point_step,
            row_step,
        };
        let there = cloud.data.len() as u64;
        if grid.count() > 0 && (point_step == 0 || row_step < row_bytes || needed > there) {
            return Err(Fault::header(format!(
                "{width} x {height} points of {point_step} bytes in rows of {row_step} need {needed} bytes, {there} \
                 are there"
            )));
        }
        Ok(grid)
    }

    fn count(&self) -> u64 {
        self.width * self.height
    }

    /// The bytes of all points, one after the other.
    fn without_gaps<'a>(&self, data: &'a [u8]) -> Cow<'a, [u8]> {
        let row_bytes = self.width * self.point_step;
        if self.count() == 0 || self.row_step == row_bytes {
            return Cow::Borrowed(data);
        }
        let rows = data.chunks(self.row_step as usize).take(self.height as usize);
        let points = rows.flat_map(|row| &row[..row_bytes as usize]);
        Cow::Owned(points.copied().collect())
    }
}

/// The numbers of a field, each as a column. Some drivers count a lone number as none. Without points, the first of
/// several is enough: the count cannot be verified.
fn numbers<'a>(field: &PointField, cloud: &Cloud<'_>, grid: &Grid, bytes: &'a [u8]) -> Result<Vec<Column<'a>>, Fault> {
    let Some(scalar) = scalar(field.datatype) else {
        return Err(Fault::header(format!(
            "field `{}` is of type {}, expected 1 to 8",
            field.name, field.datatype
        )));
    };
    let count = u64::from(field.count.max(1));
    let end = u64::from(field.offset) + count * scalar.byte_size() as u64;
    if end > grid.point_step && grid.count() > 0 {
        return Err(Fault::header(format!(
            "field `{}` ends at byte {end} of a point, which has {}",
            field.name, grid.point_step
        )));
    }
    let retained = if grid.count() > 0 { count.min(MAX_NUMBERS) } else { 1 };
    let column = |place: u64| Column {
        name: match count {
            1 => field.name.clone(),
            _ => format!("{}_{place}", field.name),
        },
        scalar,
        values: Values::Packed {
            bytes,
            start: field.offset as usize + place as usize * scalar.byte_size(),
            step: grid.point_step as usize,
            big_endian: cloud.big_endian,
        },
    };
    Ok((0..retained).map(column).collect())
}

/// By the name of the frame of reference.
fn convention(cloud: &Cloud<'_>) -> AxisConvention {
    let mut parts = cloud.frame_id.windows(OPTICAL.len());
    if parts.any(|part| part == OPTICAL) {
        AxisConvention::Camera
    } else {
        AxisConvention::UsuallyZUp
    }
}

fn scalar(datatype: u8) -> Option<Scalar> {
    Some(match datatype {
        1 => Scalar::I8,
        2 => Scalar::U8,
        3 => Scalar::I16,
        4 => Scalar::U16,
        5 => Scalar::I32,
        6 => Scalar::U32,
        7 => Scalar::F32,
        8 => Scalar::F64,
        _ => return None,
    })
}
