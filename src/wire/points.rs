//! Frames of points: positions and attributes, one array each.

use super::bytes::{Fields, Written, f32_triples, f32s};
use super::error::WireError;
use crate::cloud::codes::{AXES, UNITS, choice_of, code_of};
use crate::cloud::{ImageGrid, Positions, RawCloud, ScalarField};
use glam::DVec3;
use std::sync::Arc;

/// Bytes of a body before its arrays, as this version writes them.
const LAYOUT_BYTES: usize = 80;

/// Maximum number of arrays of a frame.
const MAX_ARRAYS: u32 = 256;

/// Longest name of an array.
const MAX_NAME_BYTES: u32 = 1 << 10;

/// Name of the part being read, for errors.
const WHAT: &str = "a frame of points";

/// Kind of data in an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ArrayKind {
    /// Three single floats from the origin.
    Positions = 1,
    /// Red, green, blue, alpha.
    Colors = 2,
    /// Three single floats.
    Normals = 3,
    /// Single floats.
    Radii = 4,
    /// Single floats with a name.
    Scalar = 5,
}

impl ArrayKind {
    const ALL: [Self; 5] = [Self::Positions, Self::Colors, Self::Normals, Self::Radii, Self::Scalar];

    /// Bytes of a point.
    fn point_bytes(self) -> u64 {
        match self {
            Self::Positions | Self::Normals => 12,
            Self::Colors | Self::Radii | Self::Scalar => 4,
        }
    }
}

/// The body of a frame of these points: their positions, colours, normals, radii and numbers. Faces and ellipses are
/// not sent.
pub fn points_body(cloud: &RawCloud) -> Vec<u8> {
    let count = cloud.positions.len();
    let attributes = &cloud.attributes;
    let (origin, positions) = from_origin(&cloud.positions);
    let arrays = 1
        + u32::from(attributes.colors.is_some())
        + u32::from(attributes.normals.is_some())
        + u32::from(attributes.radii.is_some())
        + attributes.scalars.len() as u32;
    let [grid_width, grid_height] = cloud.grid.map_or([0; 2], |grid| [grid.width(), grid.height()]);
    let point_bytes = 12 + attributes.point_bytes();
    let mut body = Written(Vec::with_capacity(
        LAYOUT_BYTES + count * point_bytes + 64 * arrays as usize,
    ));
    body.u32(LAYOUT_BYTES as u32)
        .u32(arrays)
        .u64(count as u64)
        .f64s(&origin.to_array())
        .f64s(&cloud.sensor.unwrap_or(DVec3::NAN).to_array())
        .u32(code_of(&AXES, cloud.convention).into())
        .u32(code_of(&UNITS, cloud.unit).into())
        .u32(grid_width)
        .u32(grid_height);
    debug_assert_eq!(body.0.len(), LAYOUT_BYTES);
    array_head(&mut body, ArrayKind::Positions, count, "", 0.0);
    body.f32s(positions.as_flattened());
    if let Some(colors) = &attributes.colors {
        array_head(&mut body, ArrayKind::Colors, count, "", 0.0);
        body.0.extend_from_slice(colors.as_flattened());
    }
    if let Some(normals) = &attributes.normals {
        array_head(&mut body, ArrayKind::Normals, count, "", 0.0);
        body.f32s(normals.as_flattened());
    }
    if let Some(radii) = &attributes.radii {
        array_head(&mut body, ArrayKind::Radii, count, "", 0.0);
        body.f32s(radii);
    }
    for field in &attributes.scalars {
        array_head(&mut body, ArrayKind::Scalar, count, &field.name, field.offset);
        body.f32s(&field.values);
    }
    body.0
}

/// Returns the positions as single-precision floats relative to an origin that loses no more precision than the origin
/// of a sequence does: the centre of the points, rounded to a power of two; zero for positions that already are
/// single-precision floats.
fn from_origin(positions: &Positions) -> (DVec3, std::borrow::Cow<'_, [[f32; 3]]>) {
    let exact = match positions {
        Positions::F32(positions) => return (DVec3::ZERO, positions.into()),
        Positions::F64(positions) => positions,
    };
    let is_single = |position: &[f64; 3]| position.iter().all(|&x| x.is_nan() || f64::from(x as f32) == x);
    let origin = match positions.finite_bounds() {
        (_, Some((min, max))) if !exact.iter().all(is_single) => {
            let extent = (max - min).max_element().max(f64::MIN_POSITIVE);
            let step = extent.log2().ceil().exp2();
            let origin = (0.5 * (min + max) / step).round() * step;
            if origin.is_finite() { origin } else { DVec3::ZERO }
        }
        _ => DVec3::ZERO,
    };
    let relative = exact
        .iter()
        .map(|&position| (DVec3::from_array(position) - origin).as_vec3().to_array());
    (origin, relative.collect::<Vec<_>>().into())
}

fn array_head(body: &mut Written, kind: ArrayKind, count: usize, name: &str, offset: f64) {
    let name = name.get(..name.len().min(MAX_NAME_BYTES as usize)).unwrap_or_default();
    body.u32(kind as u32)
        .u32(name.len() as u32)
        .u64(count as u64 * kind.point_bytes())
        .f64s(&[offset]);
    body.0.extend_from_slice(name.as_bytes());
}

/// A frame of points as it came.
#[derive(Debug, Clone)]
pub struct ReceivedPoints {
    payload: Arc<Vec<u8>>,
    body: usize,
}

impl ReceivedPoints {
    pub(super) fn new(payload: Arc<Vec<u8>>, body: usize) -> Self {
        Self { payload, body }
    }

    /// Its points. Takes no more memory than the frame has bytes, or twice that where the origin is not zero.
    ///
    /// # Errors
    /// [`WireError`], for arrays that are not as long as they should be.
    pub fn cloud(&self) -> Result<RawCloud, WireError> {
        let bytes = self.payload.get(self.body..).unwrap_or_default();
        let mut fields = Fields::new(bytes, WHAT);
        let layout_bytes = fields.u32()?;
        let (arrays, count) = (fields.u32()?, fields.u64()?);
        let origin = DVec3::from_array(fields.f64s()?);
        let sensor = DVec3::from_array(fields.f64s()?);
        let (axes, unit) = (fields.u32()?, fields.u32()?);
        let (grid_width, grid_height) = (fields.u32()?, fields.u32()?);
        if (layout_bytes as usize) < LAYOUT_BYTES || arrays > MAX_ARRAYS || !origin.is_finite() {
            let reason = format!("{layout_bytes} bytes before {arrays} arrays, from an origin at {origin}");
            return Err(WireError::malformed(WHAT, reason));
        }
        fields.take(u64::from(layout_bytes) - LAYOUT_BYTES as u64)?;
        let mut cloud = RawCloud::from_positions(Positions::F32(Vec::new()));
        let mut has_positions = false;
        for _ in 0..arrays {
            let (kind, name_bytes, array_bytes) = (fields.u32()?, fields.u32()?, fields.u64()?);
            let offset = fields.f64()?;
            if name_bytes > MAX_NAME_BYTES {
                let reason = format!("a name of {name_bytes} bytes, and {MAX_NAME_BYTES} are read");
                return Err(WireError::malformed(WHAT, reason));
            }
            let name = String::from_utf8_lossy(fields.take(name_bytes.into())?).into_owned();
            let array = fields.take(array_bytes)?;
            let known = ArrayKind::ALL.into_iter().find(|known| *known as u32 == kind);
            let Some(kind) = known else { continue };
            if count.checked_mul(kind.point_bytes()) != Some(array_bytes) {
                let reason = format!("{array_bytes} bytes of {kind:?} for {count} points");
                return Err(WireError::malformed(WHAT, reason));
            }
            let attributes = &mut cloud.attributes;
            match kind {
                ArrayKind::Positions => {
                    has_positions = true;
                    cloud.positions = to_file_coordinates(f32_triples(array), origin);
                }
                ArrayKind::Colors => attributes.colors = Some(array.as_chunks().0.to_vec()),
                ArrayKind::Normals => attributes.normals = Some(f32_triples(array)),
                ArrayKind::Radii => attributes.radii = Some(f32s(array)),
                ArrayKind::Scalar => attributes.scalars.push(ScalarField {
                    offset,
                    ..ScalarField::new(name, f32s(array))
                }),
            }
        }
        if !has_positions {
            return Err(WireError::malformed(WHAT, "it has no positions"));
        }
        cloud.sensor = Some(sensor).filter(|sensor| sensor.is_finite());
        cloud.convention = choice_of(&AXES, axes);
        cloud.unit = choice_of(&UNITS, unit);
        cloud.grid = ImageGrid::of(grid_width, grid_height, cloud.positions.len());
        Ok(cloud)
    }
}

fn to_file_coordinates(positions: Vec<[f32; 3]>, origin: DVec3) -> Positions {
    if origin == DVec3::ZERO {
        return Positions::F32(positions);
    }
    let exact = |&position: &[f32; 3]| (glam::Vec3::from_array(position).as_dvec3() + origin).to_array();
    Positions::F64(positions.iter().map(exact).collect())
}
