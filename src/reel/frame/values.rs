//! Attributes of a frame: level after level, then the points'.

use super::levels::{Level, LevelValues, Pose};
use super::parts::{Direction, Part};
use super::schema::Schema;
use super::sections::Sizes;
use crate::reel::attributes::NormalGrid;
use crate::reel::error::Fault;
use crate::reel::parent_level::{
    Above, ChannelCoding, Families, ParentValue, code_channels, code_normals, code_offsets,
};
use crate::reel::tree::{Faces, NO_FACES, faces_below, first_children};
use fearless_simd::{Level as SimdLevel, dispatch};

/// Bytes written by each section of a part.
pub(super) type Written = Vec<Vec<u8>>;

/// A level, or the points: whose children its nodes are, and the section that it is in.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    above: Above<'a>,
    section: usize,
}

/// Attribute values of each level, by kind.
pub(super) struct Kinds<'a> {
    pub(super) colors: Vec<&'a mut [[u16; 3]]>,
    pub(super) normals: Vec<&'a mut [[i16; 2]]>,
    pub(super) offsets: Vec<&'a mut [u8]>,
    pub(super) singles: Vec<Vec<&'a mut [[u16; 1]]>>,
}

impl<'a> Kinds<'a> {
    /// With this number of single numbers.
    pub(super) fn of(levels: Vec<&'a mut LevelValues>, singles: usize) -> Self {
        let mut kinds = Self {
            colors: Vec::new(),
            normals: Vec::new(),
            offsets: Vec::new(),
            singles: (0..singles).map(|_| Vec::new()).collect(),
        };
        for values in levels {
            kinds.colors.push(&mut values.colors);
            kinds.normals.push(&mut values.normals);
            kinds.offsets.push(&mut values.offsets);
            for (of_single, values) in kinds.singles.iter_mut().zip(&mut values.singles) {
                of_single.push(values);
            }
        }
        kinds
    }
}

/// Returns the face neighbours of the nodes of each level that has something below it.
fn faces_of(levels: &[Level], has_points: bool) -> Vec<Vec<Faces>> {
    let wanted = if has_points {
        levels.len()
    } else {
        levels.len().saturating_sub(1)
    };
    let mut faces = vec![vec![NO_FACES]];
    for level in levels.iter().take(wanted.saturating_sub(1)) {
        let above = faces.last().map_or(&[][..], Vec::as_slice);
        let first = first_children(&level.masks);
        // Bit counting needs instructions that not every CPU has.
        let below = dispatch!(SimdLevel::new(), _simd => faces_below(above, &level.masks, &first));
        faces.push(below);
    }
    faces
}

/// Codes colours, normals, offsets and single numbers, those that there are, as parts from a number on; normals and the
/// others at the same time.
pub(super) fn code_values<D: Direction>(
    direction: &D,
    first_part: usize,
    schema: &Schema,
    pose: &mut Pose,
    sizes: Sizes<'_>,
) -> Result<Vec<Written>, Fault> {
    if !schema.has_values() {
        return Ok(Vec::new());
    }
    let faces = faces_of(&pose.levels, pose.points.is_some());
    let mut places = Vec::new();
    // The root has no parent.
    let roots = sizes.counts.first().map_or(0, |&count| count.min(1));
    let mut families = Families::Counts(&[], roots);
    let mut all: Vec<&mut LevelValues> = Vec::new();
    let of_parents = std::iter::once(&[][..]).chain(faces.iter().map(Vec::as_slice));
    let mut of_parents = of_parents.chain(std::iter::repeat(&[][..]));
    for (number, level) in pose.levels.iter_mut().enumerate() {
        let faces = of_parents.next().unwrap_or_default();
        places.push(Place {
            above: Above { families, faces },
            section: sizes.section_of(number),
        });
        let Level { masks, values, .. } = level;
        families = Families::Masks(masks);
        all.push(values);
    }
    if let Some(points) = &mut pose.points {
        let families = Families::Counts(&points.counts, points.outside.len());
        let faces = of_parents.next().unwrap_or_default();
        places.push(Place {
            above: Above { families, faces },
            section: sizes.ranges.len(),
        });
        all.push(&mut points.values);
    }
    let Kinds {
        colors,
        normals,
        offsets,
        singles,
    } = Kinds::of(all, schema.singles());
    let [has_colors, has_normals, has_offsets] =
        [schema.color_step > 0, schema.normal_bits > 0, schema.offset_bits > 0].map(usize::from);
    let of_normals = first_part + has_colors;
    let of_offsets = of_normals + has_normals;
    let of_singles = of_offsets + has_offsets;
    let (channels, shapes) = rayon::join(
        || {
            let colors = (has_colors > 0).then(|| {
                let coding = ChannelCoding {
                    step: u16::from(schema.color_step),
                    max: 255,
                    parent_value: schema.color_of_parents,
                };
                let part = Part::open(direction, first_part)?;
                code_all_channels(part, &places, &[[128; 3]], colors, coding)
            });
            let singles = singles.into_iter().enumerate().map(|(single, values)| {
                let max = schema.max_code(single);
                let coding = ChannelCoding {
                    step: 1,
                    max,
                    parent_value: ParentValue::Mean,
                };
                let part = Part::open(direction, of_singles + single)?;
                code_all_channels(part, &places, &[[max / 2]], values, coding)
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
    coding: ChannelCoding,
) -> Result<Written, Fault> {
    let mut parents = root;
    for (place, values) in places.iter().zip(levels) {
        let coder = part.at(place.section)?;
        let above = place.above;
        dispatch!(SimdLevel::new(), _simd => code_channels(coder, above, parents, values, coding));
        parents = if values.is_empty() { parents } else { values };
    }
    part.close()
}

/// Normals, and after those of the deepest level its offsets.
fn code_shapes<D: Direction>(
    schema: &Schema,
    places: &[Place<'_>],
    mut of_normals: Part<'_, D>,
    of_offsets: Option<Part<'_, D>>,
    normals: Vec<&mut [[i16; 2]]>,
    offsets: Vec<&mut [u8]>,
) -> Result<Vec<Written>, Fault> {
    let grid = NormalGrid::of(schema.normal_bits);
    let mut parents = &[[1; 2]][..];
    let mut normals = normals;
    for (place, values) in places.iter().zip(&mut normals) {
        let coder = of_normals.at(place.section)?;
        let (above, bits) = (place.above, schema.normal_bits);
        dispatch!(SimdLevel::new(), _simd => code_normals(coder, bits, above, parents, values));
        parents = if values.is_empty() { parents } else { values };
    }
    let of_normals = of_normals.close()?;
    let Some(mut part) = of_offsets else {
        return Ok(vec![of_normals]);
    };
    for ((place, normals), offsets) in places.iter().zip(normals).zip(offsets) {
        if !offsets.is_empty() {
            let (coder, above, bits) = (part.at(place.section)?, place.above, schema.offset_bits);
            dispatch!(SimdLevel::new(), _simd => code_offsets(coder, grid, bits, above, normals, offsets));
        }
    }
    Ok(vec![of_normals, part.close()?])
}
