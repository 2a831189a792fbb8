//! Conversion of scalar values of points to the records that are drawn, through a map or the colours of classes.
//!
//! How it works: a batch of numbers at a time becomes indices into a table of colours, several of them at once; then
//! records are written. Compared with a pass that writes records of one colour that takes half as much again
//! (`benches/prepare.rs`).

use super::{FieldName, PaintValues};
use crate::analysis::{ColorMap, ColorScale, NO_PLACE, Placer, class_color};
use crate::cloud::{Frame, PointRecord, ScalarField};
use std::ops::Range;

/// Points whose value is not a number.
pub const NO_VALUE_COLOR: [u8; 4] = [110, 110, 118, 255];

/// Numbers at a time.
const CHUNK: usize = 64;

/// Classes of files are bytes; others are taken for the nearest.
const CLASSES: usize = 256;

/// The field of this name.
pub(super) fn field<'a>(frame: &'a Frame, name: &FieldName) -> Option<&'a ScalarField> {
    let mut fields = frame.scalar_fields().iter();
    fields.find(|field| name.names(&field.name))
}

/// Records in the colours of numbers on a scale; `None` if the frame does not have them.
pub(super) fn points_on_scale(
    frame: &Frame,
    values: &PaintValues,
    map: ColorMap,
    scale: &ColorScale,
) -> Option<Vec<PointRecord>> {
    let mut table = map.table().to_vec();
    debug_assert_eq!(table.len(), NO_PLACE as usize);
    table.push(NO_VALUE_COLOR);
    let on_scale = |offset: f64, fill: &dyn Fn(Range<usize>, &mut [f32])| {
        let placer = Placer::new(scale, offset);
        in_chunks(frame, &table, fill, |values, places| {
            placer.place(values, places);
        })
    };
    let positions = frame.positions();
    Some(match values {
        PaintValues::Field(name) => {
            let field = field(frame, name)?;
            on_scale(field.offset, &|points, values| {
                values.copy_from_slice(&field.values[points]);
            })
        }
        PaintValues::Height(up) => {
            let offset = frame.value_sample().origin.dot(up.as_dvec3());
            on_scale(offset, &|points, values| {
                for (value, position) in values.iter_mut().zip(&positions[points]) {
                    *value = position.dot(*up);
                }
            })
        }
        PaintValues::Distance(from) => on_scale(0.0, &|points, values| {
            for (value, position) in values.iter_mut().zip(&positions[points]) {
                *value = position.distance(*from);
            }
        }),
        PaintValues::Change => return None,
    })
}

/// Records in the colours of `classes`, one per point.
pub(super) fn points_in_class_colors(frame: &Frame, classes: &[f32]) -> Vec<PointRecord> {
    let mut table: Vec<[u8; 4]> = (0..CLASSES as i32).map(class_color).collect();
    table.push(NO_VALUE_COLOR);
    let fill = |points: Range<usize>, values: &mut [f32]| {
        values.copy_from_slice(&classes[points]);
    };
    in_chunks(frame, &table, &fill, |values, places| {
        for (place, value) in places.iter_mut().zip(values) {
            let class = (value.clamp(0.0, (CLASSES - 1) as f32) + 0.5) as i32 as u32;
            *place = if value.is_nan() { CLASSES as u32 } else { class };
        }
    })
}

/// Records in colours of `table`: `fill` gives the numbers of some points, `place` their position in the table.
fn in_chunks(
    frame: &Frame,
    table: &[[u8; 4]],
    fill: &dyn Fn(Range<usize>, &mut [f32]),
    place: impl Fn(&[f32], &mut [u32]),
) -> Vec<PointRecord> {
    let mut records = Vec::with_capacity(frame.len());
    let (mut values, mut places) = ([0.0; CHUNK], [0; CHUNK]);
    for positions in frame.positions().chunks(CHUNK) {
        let points = records.len()..records.len() + positions.len();
        let values = &mut values[..positions.len()];
        let places = &mut places[..positions.len()];
        fill(points, values);
        place(values, places);
        let colored = positions.iter().zip(&*places);
        records.extend(colored.map(|(position, &place)| PointRecord {
            position: position.to_array(),
            color: table[place as usize],
        }));
    }
    records
}
