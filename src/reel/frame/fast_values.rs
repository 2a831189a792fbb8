//! Attributes of a frame in the fast coding: level after level, then those of points.

use super::levels::{Level, LevelValues, Pose};
use super::parts::{Direction, Part};
use super::schema::Schema;
use super::sections::Sizes;
use crate::reel::attributes::NormalGrid;
use crate::reel::coder::SymbolCoder;
use crate::reel::error::Fault;
use crate::reel::fast::{ABOVE_ROOT, Families, code_channels, code_normals, code_offsets, to_halves, to_places};
use fearless_simd::{Level as SimdLevel, dispatch};

/// What each section of a part wrote.
type Written = Vec<Vec<u8>>;

/// A level, or the points: whose children its nodes are, and the section that it is in.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    families: Families<'a>,
    section: usize,
}

/// Codes colours, normals, offsets and single numbers, those that there are, as parts 1 and on; normals and the others
/// at the same time.
pub(super) fn code_values<D: Direction>(
    direction: &D,
    schema: &Schema,
    pose: &mut Pose,
    sizes: Sizes<'_>,
) -> Result<Vec<Written>, Fault> {
    let mut places = Vec::new();
    let mut above = &[ABOVE_ROOT][..];
    let mut all: Vec<&mut LevelValues> = Vec::new();
    for (number, level) in pose.levels.iter_mut().enumerate() {
        places.push(Place {
            families: Families::Masks(above),
            section: sizes.section_of(number),
        });
        let Level { masks, values, .. } = level;
        above = masks;
        all.push(values);
    }
    if let Some(points) = &mut pose.points {
        places.push(Place {
            families: Families::Counts(&points.counts, points.outside.len()),
            section: sizes.ranges.len(),
        });
        all.push(&mut points.values);
    }
    let mut colors: Vec<&mut [[u16; 3]]> = Vec::new();
    let mut normals: Vec<&mut [[i16; 2]]> = Vec::new();
    let mut offsets: Vec<&mut [u8]> = Vec::new();
    let mut singles: Vec<Vec<&mut [[u16; 1]]>> = (0..schema.singles()).map(|_| Vec::new()).collect();
    for values in all {
        colors.push(&mut values.colors);
        normals.push(&mut values.normals);
        offsets.push(&mut values.offsets);
        for (of_single, values) in singles.iter_mut().zip(&mut values.singles) {
            of_single.push(values);
        }
    }
    let [has_colors, has_normals, has_offsets] =
        [schema.color_step > 0, schema.normal_bits > 0, schema.offset_bits > 0].map(usize::from);
    let of_normals = 1 + has_colors;
    let of_offsets = of_normals + has_normals;
    let of_singles = of_offsets + has_offsets;
    let (channels, shapes) = rayon::join(
        || {
            let colors = (has_colors > 0).then(|| {
                let step = (u16::from(schema.color_step), 255);
                code_all_channels(Part::open(direction, 1)?, &places, &[[128; 3]], colors, step)
            });
            let singles = singles.into_iter().enumerate().map(|(single, values)| {
                let most = schema.most_code(single);
                let part = Part::open(direction, of_singles + single)?;
                code_all_channels(part, &places, &[[most / 2]], values, (1, most))
            });
            let singles = singles.collect::<Result<Vec<_>, Fault>>()?;
            Ok((colors.transpose()?, singles))
        },
        || {
            if has_normals == 0 {
                return Ok(Vec::new());
            }
            let of_normals = Part::open(direction, of_normals)?;
            let of_offsets = (has_offsets > 0).then(|| Part::open(direction, of_offsets));
            code_shapes(schema, &places, of_normals, of_offsets.transpose()?, normals, offsets)
        },
    );
    let (colors, singles): (Option<Written>, Vec<Written>) = channels?;
    Ok(colors.into_iter().chain(shapes?).chain(singles).collect())
}

fn code_all_channels<'a, D: Direction, const N: usize>(
    mut part: Part<'_, D>,
    places: &[Place<'_>],
    root: &'a [[u16; N]],
    levels: Vec<&'a mut [[u16; N]]>,
    step_and_most: (u16, u16),
) -> Result<Written, Fault> {
    let mut parents = root;
    for (place, values) in places.iter().zip(levels) {
        let coder = part.at(place.section)?;
        let families = place.families;
        dispatch!(SimdLevel::new(), _simd => code_channels(coder, families, parents, values, step_and_most));
        parents = if values.is_empty() { parents } else { values };
    }
    part.close()
}

/// Normals, and behind those of the deepest level its offsets.
fn code_shapes<D: Direction>(
    schema: &Schema,
    places: &[Place<'_>],
    mut of_normals: Part<'_, D>,
    of_offsets: Option<Part<'_, D>>,
    normals: Vec<&mut [[i16; 2]]>,
    offsets: Vec<&mut [u8]>,
) -> Result<Vec<Written>, Fault> {
    let grid = NormalGrid::of(schema.normal_bits);
    let (half, may_miss) = (grid.half(), schema.normals_may_miss);
    let mut parents = &[[0; 2]][..];
    let mut normals = normals;
    for (place, values) in places.iter().zip(&mut normals) {
        if !D::Coder::DECODES {
            to_halves(values);
        }
        let coder = of_normals.at(place.section)?;
        let families = place.families;
        dispatch!(SimdLevel::new(), _simd => code_normals(coder, half, may_miss, families, parents, values));
        parents = if values.is_empty() { parents } else { values };
    }
    let of_normals = of_normals.close()?;
    for values in &mut normals {
        dispatch!(SimdLevel::new(), _simd => to_places(values));
    }
    let Some(mut part) = of_offsets else {
        return Ok(vec![of_normals]);
    };
    for ((place, normals), offsets) in places.iter().zip(normals).zip(offsets) {
        if let (Families::Masks(above), false) = (place.families, offsets.is_empty()) {
            let (coder, bits) = (part.at(place.section)?, schema.offset_bits);
            dispatch!(SimdLevel::new(), _simd => code_offsets(coder, grid, bits, above, normals, offsets));
        }
    }
    Ok(vec![of_normals, part.close()?])
}
