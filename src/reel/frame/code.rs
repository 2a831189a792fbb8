//! A frame as sections of streams, and back.

use super::exact::columns_of;
use super::grid::Grid;
use super::levels::{Level, LevelValues, Pose, PosePoints};
use super::schema::Schema;
use super::sections::{CodedSection, Sizes, Wanted, blank_sections, ranges_of, sections_of};
use super::streams;
use crate::reel::error::Fault;

/// The frame as sections; the pose becomes the decoder's result.
pub(in crate::reel) fn encode_pose(schema: &Schema, grid: &Grid, pose: &mut Pose) -> Vec<CodedSection> {
    let counts = pose.counts();
    let ranges = sections_of(&counts);
    let mut sections = blank_sections(&ranges, pose.points.is_some());
    let sizes = Sizes {
        counts: &counts,
        ranges: &ranges,
    };
    let coded = streams::encode(schema, grid, pose, sizes, sections.len());
    for (kind, of_sections) in coded {
        for (section, bytes) in sections.iter_mut().zip(of_sections) {
            if !bytes.is_empty() {
                section.streams.push((kind, bytes));
            }
        }
    }
    sections
}

/// Returns the number of bytes that the colours of a pose take, of a schema with no other attribute.
pub(super) fn color_bytes(schema: &Schema, pose: &mut Pose) -> usize {
    let counts = pose.counts();
    let ranges = sections_of(&counts);
    let sizes = Sizes {
        counts: &counts,
        ranges: &ranges,
    };
    streams::color_bytes(schema, pose, sizes)
}

/// A pose from its first sections. With the fast coding, the values of fine levels are there if `keeps_levels`, and
/// else those of the last one as [`Pose::flat`].
pub(in crate::reel) fn decode_pose(wanted: &Wanted<'_>, sections: &[CodedSection]) -> Result<Pose, Fault> {
    let levels = sections.iter().map(|section| section.levels.end).max().unwrap_or(0);
    let counts = wanted
        .counts
        .get(..levels)
        .ok_or_else(|| Fault::new("a section of levels that there are not"))?;
    let ranges = ranges_of(sections);
    let has_points = ranges.len() < sections.len();
    let sizes = Sizes {
        counts,
        ranges: &ranges,
    };
    let is_retained = |level: usize| !wanted.schema.is_flat || wanted.keeps_levels || sizes.section_of(level) == 0;
    let mut pose = blank(wanted, counts, has_points, is_retained);
    streams::decode(wanted, &mut pose, sizes, sections)?;
    Ok(pose)
}

/// A pose allocated for the data to be decoded.
fn blank(wanted: &Wanted<'_>, counts: &[usize], has_points: bool, is_retained: impl Fn(usize) -> bool) -> Pose {
    let schema = wanted.schema;
    let deepest = wanted.counts.len().saturating_sub(1);
    let values = |count: usize, offsets: usize| LevelValues {
        colors: vec![[0; 3]; if schema.color_step > 0 { count } else { 0 }],
        normals: vec![[1; 2]; if schema.normal_bits > 0 { count } else { 0 }],
        offsets: vec![0; if schema.offset_bits > 0 { offsets } else { 0 }],
        singles: vec![vec![[0]; count]; schema.singles()],
    };
    let levels = counts.iter().enumerate().map(|(level, &count)| Level {
        masks: vec![0; if level + 1 < counts.len() { count } else { 0 }],
        cells: Vec::new(),
        values: values(
            if is_retained(level) { count } else { 0 },
            if level == deepest { count } else { 0 },
        ),
    });
    let [placed, outside] = wanted.points;
    let points = has_points.then(|| PosePoints {
        counts: vec![0; wanted.counts.last().copied().unwrap_or(0)],
        missing_bits: if schema.has_cell_bits {
            vec![0; wanted.counts.last().copied().unwrap_or(0)]
        } else {
            Vec::new()
        },
        below: vec![[0; 3]; placed],
        outside: vec![[0; 3]; outside],
        values: values(placed + outside, 0),
        columns: vec![vec![0; placed + outside]; columns_of(schema).map(|(_, count)| count).sum()],
        order: vec![0; if schema.has_order { placed + outside } else { 0 }],
    });
    Pose {
        levels: levels.collect(),
        points,
        flat: None,
    }
}
