//! Attributes by the fast coding: level after level, then the points', in the form in which they are drawn.
//!
//! A level is read from the one above it alone, so no more than two of a kind are in memory, unless others are
//! requested: allocated [`LevelValues`](super::levels::LevelValues) are filled in.

use super::levels::{FlatValues, Level, LevelValues, Pose};
use super::parts::{Direction, Part};
use super::schema::Schema;
use super::sections::Sizes;
use super::values::{Kinds, Written};
use crate::reel::attributes::{MISSING, NormalGrid};
use crate::reel::coder::SymbolCoder;
use crate::reel::error::Fault;
use crate::reel::fast::{ABOVE_ROOT, NO_NORMAL, SLACK, Upwards, code_colors, code_normals, code_offsets, code_singles};
use crate::reel::parent_level::{Families, ParentValue};
use fearless_simd::{Level as SimdLevel, dispatch};

/// A level, or the points.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    upwards: Upwards<'a>,
    count: usize,
    section: usize,
}

/// A kind in the form in which it is drawn, and in the form in which levels are stored.
struct Forms<V, K> {
    /// Value of the parent of the root.
    root: V,
    blank: V,
    retained: fn(u8, V) -> K,
    drawn: fn(u8, K) -> V,
    /// Bits of a normal; others have none.
    bits: u8,
}

/// Bytes written by each section of a part, and the values of the last level or of the points.
type Coded<V> = (Written, Vec<V>);

/// Codes the colours, normals, offsets and single numbers present, as parts from a number on; normals and the others at
/// the same time. Returns the output of each part, and the values of the last level or of the points.
pub(super) fn code_flat<D: Direction>(
    direction: &D,
    first_part: usize,
    schema: &Schema,
    pose: &mut Pose,
    sizes: Sizes<'_>,
) -> Result<(Vec<Written>, FlatValues), Fault> {
    let (places, all) = places_of(pose, sizes);
    let places = places.as_slice();
    let Kinds {
        colors,
        normals,
        offsets,
        singles,
    } = Kinds::of(all, schema.singles());
    let [has_colors, has_normals, has_offsets] =
        [schema.color_step > 0, schema.normal_bits > 0, schema.offset_bits > 0];
    let of_normals = first_part + usize::from(has_colors);
    let of_offsets = of_normals + usize::from(has_normals);
    let of_singles = of_offsets + usize::from(has_offsets);
    let (channels, shapes) = rayon::join(
        || {
            let code = |colors| code_all_colors(Part::open(direction, first_part)?, places, schema, colors);
            let of_colors = has_colors.then(|| code(colors)).transpose()?;
            let singles = singles.into_iter().enumerate().map(|(single, values)| {
                let part = Part::open(direction, of_singles + single)?;
                code_all_singles(part, places, schema.max_code(single), values)
            });
            Ok((of_colors, singles.collect::<Result<Vec<Coded<_>>, Fault>>()?))
        },
        || {
            let code = |normals| {
                let part = Part::open(direction, of_normals)?;
                code_all_normals(part, places, schema.normal_bits, normals)
            };
            let of_normals = has_normals.then(|| code(normals)).transpose()?;
            let code = |offsets| {
                let part = Part::open(direction, of_offsets)?;
                code_all_offsets(part, places, schema.offset_bits, offsets)
            };
            Ok((of_normals, has_offsets.then(|| code(offsets)).transpose()?))
        },
    );
    let ((colors, singles), (normals, offsets)) = (channels?, shapes?);
    let (mut written, mut flat) = (Vec::new(), FlatValues::default());
    if let Some((bytes, values)) = colors {
        written.push(bytes);
        flat.colors = values;
    }
    if let Some((bytes, values)) = normals {
        written.push(bytes);
        flat.normals = values;
    }
    written.extend(offsets);
    for (bytes, values) in singles {
        written.push(bytes);
        flat.singles.push(values);
    }
    Ok((written, flat))
}

/// The levels and the points, and their retained values.
fn places_of<'a>(pose: &'a mut Pose, sizes: Sizes<'_>) -> (Vec<Place<'a>>, Vec<&'a mut LevelValues>) {
    let (mut places, mut all) = (Vec::new(), Vec::new());
    let (mut above, mut parents): (&[u8], Option<&[u8]>) = (&[], None);
    for ((number, level), &count) in pose.levels.iter_mut().enumerate().zip(sizes.counts) {
        // The root has no parent.
        let families = parents.map_or(Families::Counts(&[], count.min(1)), Families::Masks);
        places.push(Place {
            upwards: Upwards {
                families,
                masks: above,
                parent_value: ParentValue::Mean,
            },
            count,
            section: sizes.section_of(number),
        });
        above = parents.unwrap_or(&[ABOVE_ROOT]);
        let Level { masks, values, .. } = level;
        parents = Some(masks);
        all.push(values);
    }
    if let Some(points) = &mut pose.points {
        let count = points.len();
        let families = Families::Counts(&points.counts, points.outside.len());
        places.push(Place {
            upwards: Upwards {
                families,
                masks: &[],
                parent_value: ParentValue::Mean,
            },
            count,
            section: sizes.ranges.len(),
        });
        all.push(&mut points.values);
    }
    (places, all)
}

/// Codes a kind, each level by the one above.
fn code_all<D: Direction, V: Copy, K: Copy>(
    mut part: Part<'_, D>,
    places: &[Place<'_>],
    forms: &Forms<V, K>,
    retained: Vec<&mut [K]>,
    code: impl Fn(&mut D::Coder, Upwards<'_>, &[V], &mut [V]),
) -> Result<Coded<V>, Fault> {
    let mut parents = vec![forms.root];
    for (place, retained) in places.iter().zip(retained) {
        let mut values = vec![forms.blank; place.count + SLACK];
        if !D::Coder::DECODES {
            for (value, &retained) in values.iter_mut().zip(retained.iter()) {
                *value = (forms.drawn)(forms.bits, retained);
            }
        }
        code(part.at(place.section)?, place.upwards, &parents, &mut values);
        values.truncate(place.count);
        for (retained, &value) in retained.iter_mut().zip(&values) {
            *retained = (forms.retained)(forms.bits, value);
        }
        if !values.is_empty() {
            parents = values;
        }
    }
    if places.last().is_none_or(|place| place.count == 0) {
        parents.clear();
    }
    Ok((part.close()?, parents))
}

fn code_all_colors<D: Direction>(
    part: Part<'_, D>,
    places: &[Place<'_>],
    schema: &Schema,
    retained: Vec<&mut [[u16; 3]]>,
) -> Result<Coded<[u8; 4]>, Fault> {
    let forms = Forms {
        root: [128, 128, 128, 255],
        blank: [0; 4],
        retained: |_, [red, green, blue, _]: [u8; 4]| [green, red, blue].map(u16::from),
        drawn: |_, [green, red, blue]: [u16; 3]| [red, green, blue, 255].map(|channel| channel as u8),
        bits: 0,
    };
    let parent_value = schema.color_of_parents;
    code_all(part, places, &forms, retained, |coder, upwards, parents, colors| {
        let upwards = Upwards {
            parent_value,
            ..upwards
        };
        dispatch!(SimdLevel::new(), _simd => code_colors(coder, upwards, parents, colors, schema.color_step));
    })
}

fn code_all_normals<D: Direction>(
    part: Part<'_, D>,
    places: &[Place<'_>],
    bits: u8,
    retained: Vec<&mut [[i16; 2]]>,
) -> Result<Coded<u32>, Fault> {
    let forms = Forms {
        root: 0,
        blank: 0,
        retained: |bits, normal| match cell_of(bits, normal) {
            Some(cell) => NormalGrid::of(bits).place_of_cell(cell),
            None => MISSING,
        },
        drawn: normal_at,
        bits,
    };
    code_all(part, places, &forms, retained, |coder, upwards, parents, normals| {
        dispatch!(SimdLevel::new(), _simd => code_normals(coder, bits, upwards, parents, normals));
    })
}

/// Bits of the first axis of the triangles of a grid.
fn first_bits(bits: u8) -> u32 {
    u32::from(bits - 3) / 2 + 2
}

/// The number of a triangle, unless there is none.
#[inline(always)]
pub(super) fn cell_of(bits: u8, normal: u32) -> Option<usize> {
    let cell = normal & 0xffff | normal >> 16 << first_bits(bits);
    (normal & NO_NORMAL == 0).then_some(cell as usize)
}

/// The triangle at a place.
fn normal_at(bits: u8, place: [i16; 2]) -> u32 {
    if place == MISSING {
        return NO_NORMAL;
    }
    let cell = NormalGrid::of(bits).cell_of(place) as u32;
    let first = first_bits(bits);
    cell & ((1 << first) - 1) | cell >> first << 16
}

fn code_all_singles<D: Direction>(
    part: Part<'_, D>,
    places: &[Place<'_>],
    max: u16,
    retained: Vec<&mut [[u16; 1]]>,
) -> Result<Coded<[u16; 1]>, Fault> {
    let forms = Forms {
        root: [max / 2],
        blank: [0],
        retained: |_, value| value,
        drawn: |_, value| value,
        bits: 0,
    };
    code_all(part, places, &forms, retained, |coder, upwards, parents, values| {
        dispatch!(SimdLevel::new(), _simd => code_singles(coder, upwards, parents, values, max));
    })
}

fn code_all_offsets<D: Direction>(
    mut part: Part<'_, D>,
    places: &[Place<'_>],
    bits: u8,
    levels: Vec<&mut [u8]>,
) -> Result<Written, Fault> {
    for (place, offsets) in places.iter().zip(levels) {
        if !offsets.is_empty() {
            let coder = part.at(place.section)?;
            dispatch!(SimdLevel::new(), _simd => code_offsets(coder, bits, offsets));
        }
    }
    part.close()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_triangles_round_trip() {
        for bits in [13, 15, 17] {
            let grid = NormalGrid::of(bits);
            for index in 0..1 << bits {
                let place = grid.place(index);
                let normal = normal_at(bits, place);
                assert!(normal >> 16 < 1 << (first_bits(bits) - 1));
                assert_eq!(cell_of(bits, normal), Some(grid.cell_of(place)));
            }
            assert_eq!(cell_of(bits, normal_at(bits, MISSING)), None);
        }
    }
}
