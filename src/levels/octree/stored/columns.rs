//! Shapes as four columns of four bytes a point, each written once where all points have the same.

use super::StoredOctreeError;
use crate::cloud::ShapeRecord;
use bytemuck::Zeroable;

/// One number of a shape as four bytes.
#[derive(Debug)]
struct ShapeColumn {
    name: &'static str,
    get: fn(&ShapeRecord) -> [u8; 4],
    set: fn(&mut ShapeRecord, [u8; 4]),
    /// Whether these bytes can be drawn.
    is_valid: fn([u8; 4]) -> bool,
}

const COLUMNS: [ShapeColumn; 4] = [
    ShapeColumn {
        name: "normals",
        get: |shape| {
            let [x, y] = shape.normal.map(i16::to_le_bytes);
            [x[0], x[1], y[0], y[1]]
        },
        set: |shape, [x0, x1, y0, y1]| {
            shape.normal = [[x0, x1], [y0, y1]].map(i16::from_le_bytes);
        },
        is_valid: |_| true,
    },
    ShapeColumn {
        name: "radii",
        get: |shape| shape.radius.to_le_bytes(),
        set: |shape, bytes| shape.radius = f32::from_le_bytes(bytes),
        is_valid: |bytes| {
            let radius = f32::from_le_bytes(bytes);
            radius.is_finite() && radius >= 0.0
        },
    },
    ShapeColumn {
        name: "ellipses",
        get: |shape| shape.ellipse.to_le_bytes(),
        set: |shape, bytes| shape.ellipse = u32::from_le_bytes(bytes),
        is_valid: |_| true,
    },
    ShapeColumn {
        name: "scalars",
        get: |shape| shape.scalar.to_le_bytes(),
        set: |shape, bytes| shape.scalar = f32::from_le_bytes(bytes),
        is_valid: |bytes| f32::from_le_bytes(bytes).is_finite(),
    },
];

/// Before the bytes that all points have.
const SAME: u8 = 0;
/// Before the bytes of each point.
const EACH: u8 = 1;

/// Appends the columns of `shapes`.
///
/// # Panics
/// Precondition: finite radii and scalars, no radius below zero.
pub(super) fn write(shapes: &[ShapeRecord], out: &mut Vec<u8>) {
    for column in &COLUMNS {
        let values = shapes.iter().map(column.get);
        let invalid = values.clone().position(|value| !(column.is_valid)(value));
        assert_eq!(invalid, None, "a point whose {} are no number to draw", column.name);
        let first = values.clone().next().unwrap_or_default();
        if values.clone().all(|value| value == first) {
            out.push(SAME);
            out.extend(first);
        } else {
            out.push(EACH);
            out.extend(values.flatten());
        }
    }
}

/// The shapes of `count` points from the beginning of `bytes`, and the bytes after them.
///
/// Precondition: memory for so many shapes may be reserved.
pub(super) fn read(mut bytes: &[u8], count: usize) -> Result<(Vec<ShapeRecord>, &[u8]), StoredOctreeError> {
    let mut shapes = vec![ShapeRecord::zeroed(); count];
    for column in &COLUMNS {
        bytes = read_column(column, bytes, &mut shapes)?;
    }
    Ok((shapes, bytes))
}

/// Sets one number of all shapes; the bytes after its column.
fn read_column<'a>(
    column: &ShapeColumn,
    bytes: &'a [u8],
    shapes: &mut [ShapeRecord],
) -> Result<&'a [u8], StoredOctreeError> {
    let part = column.name;
    let truncated = |expected, found| StoredOctreeError::Truncated { part, expected, found };
    let (&kind, bytes) = bytes.split_first().ok_or(truncated(1, 0))?;
    let value_count = match kind {
        SAME => 1,
        EACH => shapes.len(),
        found => return Err(StoredOctreeError::ColumnKind { part, found }),
    };
    let expected = value_count.saturating_mul(4);
    let (values, rest) = bytes
        .split_at_checked(expected)
        .ok_or(truncated(expected, bytes.len()))?;
    let values = values.as_chunks::<4>().0;
    if let Some(point) = values.iter().position(|&value| !(column.is_valid)(value)) {
        return Err(StoredOctreeError::InvalidNumber { part, point });
    }
    for (shape, &value) in shapes.iter_mut().zip(values.iter().cycle()) {
        (column.set)(shape, value);
    }
    Ok(rest)
}
