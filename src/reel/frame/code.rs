//! A frame as sections of streams: level after level, each stream by models that go on from section to section.
//!
//! Streams of different kinds know nothing of each other but the tree, and normals for the offsets; so they are coded
//! at the same time. A section has a coder of its own for each stream: a prefix of sections is a coarser frame.

use super::columns::{code_counts, code_even, code_floats, code_order};
use super::grid::Grid;
use super::levels::{Level, LevelValues, Pose, PosePoints};
use super::points::{column_count, ranks};
use super::schema::{Kept, Schema, StreamKind};
use crate::math::morton;
use crate::reel::attributes::{
    ChannelModels, NormalGrid, NormalModels, OffsetModels, code_channels, code_normals, code_offsets,
};
use crate::reel::coder::{BitCoder, RangeDecoder, RangeEncoder};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};
use crate::reel::tree::{
    ALONE, Known, Links, NONE, OccupancyModels, cells_below, code_masks, first_children, parts_of, plan,
};
use std::ops::Range;

/// Levels of at most so many nodes are one section.
const NODES_OF_FIRST_SECTION: usize = 1 << 10;

/// A part of a frame that is read as a whole.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct CodedSection {
    /// Levels that it adds; none if it adds the points.
    pub(in crate::reel) levels: Range<usize>,
    pub(in crate::reel) streams: Vec<(StreamKind, Vec<u8>)>,
}

impl CodedSection {
    /// The bytes of a kind; none if there is no such stream.
    fn stream(&self, kind: StreamKind) -> &[u8] {
        let stream = self.streams.iter().find(|(other, _)| *other == kind);
        stream.map_or(&[], |(_, bytes)| bytes.as_slice())
    }
}

/// Levels that belong to one section each, by the number of nodes of every level.
fn sections_of(counts: &[usize]) -> Vec<Range<usize>> {
    let first = counts
        .iter()
        .position(|&count| count > NODES_OF_FIRST_SECTION)
        .unwrap_or(counts.len())
        .max(1);
    std::iter::once(0..first)
        .chain((first..counts.len()).map(|level| level..level + 1))
        .collect()
}

/// How much of a frame is to be decoded, and what is known of it.
#[derive(Debug, Clone)]
pub(in crate::reel) struct Wanted<'a> {
    pub(in crate::reel) schema: &'a Schema,
    pub(in crate::reel) grid: &'a Grid,
    /// Nodes of each level that there is.
    pub(in crate::reel) counts: &'a [usize],
    /// Points that are kept one by one, in cells and outside.
    pub(in crate::reel) points: [usize; 2],
}

/// The frame as sections; the pose becomes what a decoder makes of them.
pub(in crate::reel) fn encode_pose(schema: &Schema, grid: &Grid, pose: &mut Pose) -> Vec<CodedSection> {
    let counts: Vec<usize> = pose.levels.iter().map(|level| level.cells.len()).collect();
    let ranges = sections_of(&counts);
    let mut sections: Vec<CodedSection> = ranges
        .iter()
        .map(|levels| CodedSection {
            levels: levels.clone(),
            streams: Vec::new(),
        })
        .collect();
    if pose.points.is_some() {
        sections.push(CodedSection {
            levels: counts.len()..counts.len(),
            streams: Vec::new(),
        });
    }
    let coders = |_| (0..sections.len()).map(|_| RangeEncoder::default()).collect();
    let mut geometry: Vec<Vec<RangeEncoder>> = ranges
        .iter()
        .map(|levels| {
            (0..parts_of_section(&counts, levels))
                .map(|_| RangeEncoder::default())
                .collect()
        })
        .collect();
    // An encoder never fails.
    let coded = code_pose(schema, grid, pose, (&counts, &ranges), &mut geometry, coders).unwrap_or_default();
    for (section, parts) in sections.iter_mut().zip(geometry) {
        let bytes = joined(parts);
        if !bytes.is_empty() {
            section.streams.push((StreamKind::Geometry, bytes));
        }
    }
    for (kind, coders) in coded {
        for (section, coder) in sections.iter_mut().zip(coders) {
            let bytes = coder.finish();
            if !bytes.is_empty() {
                section.streams.push((kind, bytes));
            }
        }
    }
    sections
}

/// Parts of the geometry in a section: masks of the level above its first, or of all levels of the first section.
fn parts_of_section(counts: &[usize], levels: &Range<usize>) -> usize {
    parts_of(counts[levels.start.saturating_sub(1)])
}

/// One stream of parts: how long each but the last is, and their bytes.
fn joined(parts: Vec<RangeEncoder>) -> Vec<u8> {
    let parts: Vec<Vec<u8>> = parts.into_iter().map(RangeEncoder::finish).collect();
    let mut writer = ByteWriter::default();
    for part in &parts[..parts.len() - 1] {
        writer.number(part.len() as u64);
    }
    writer.bytes.extend(parts.concat());
    writer.bytes
}

/// The parts that a stream is joined of.
fn parted(stream: &[u8], parts: usize) -> Result<Vec<RangeDecoder<'_>>, Fault> {
    let mut reader = ByteReader::new(stream);
    let lengths: Vec<u64> = (1..parts).map(|_| reader.number()).collect::<Result<_, _>>()?;
    let mut decoders = Vec::with_capacity(parts);
    for length in lengths {
        decoders.push(RangeDecoder::new(reader.take(length as usize)?));
    }
    decoders.push(RangeDecoder::new(reader.take(reader.left())?));
    Ok(decoders)
}

/// A pose from its first sections.
pub(in crate::reel) fn decode_pose(wanted: &Wanted<'_>, sections: &[CodedSection]) -> Result<Pose, Fault> {
    let levels = sections.iter().map(|section| section.levels.end).max().unwrap_or(0);
    let counts = wanted
        .counts
        .get(..levels)
        .ok_or_else(|| Fault::new("a section of levels that there are not"))?;
    let ranges: Vec<Range<usize>> = sections
        .iter()
        .map(|section| section.levels.clone())
        .filter(|levels| !levels.is_empty())
        .collect();
    let has_points = ranges.len() < sections.len();
    let mut pose = blank(wanted, counts, has_points);
    let coders = |kind: StreamKind| {
        let streams = sections.iter().map(|section| section.stream(kind));
        streams.map(RangeDecoder::new).collect::<Vec<_>>()
    };
    let mut geometry = ranges
        .iter()
        .zip(sections)
        .map(|(levels, section)| parted(section.stream(StreamKind::Geometry), parts_of_section(counts, levels)))
        .collect::<Result<Vec<_>, _>>()?;
    let mut coded = code_pose(
        wanted.schema,
        wanted.grid,
        &mut pose,
        (counts, &ranges),
        &mut geometry,
        coders,
    )?;
    coded.extend(geometry.into_iter().map(|parts| (StreamKind::Geometry, parts)));
    for (kind, coders) in coded {
        if coders.iter().any(RangeDecoder::has_overrun) {
            return Err(Fault::new(format!("the stream of {} ends too early", kind.name())));
        }
    }
    Ok(pose)
}

/// A pose with room for what will be decoded.
fn blank(wanted: &Wanted<'_>, counts: &[usize], has_points: bool) -> Pose {
    let schema = wanted.schema;
    let deepest = wanted.counts.len().saturating_sub(1);
    let values = |count: usize, is_deepest: bool| LevelValues {
        colors: vec![[0; 3]; if schema.color_step > 0 { count } else { 0 }],
        normals: vec![[1; 2]; if schema.normal_bits > 0 { count } else { 0 }],
        offsets: vec![0; if schema.offset_bits > 0 && is_deepest { count } else { 0 }],
        singles: vec![vec![[0]; count]; schema.singles()],
    };
    let levels = counts.iter().enumerate().map(|(level, &count)| Level {
        masks: vec![0; if level + 1 < counts.len() { count } else { 0 }],
        cells: Vec::new(),
        values: values(count, level == deepest),
    });
    let [placed, outside] = wanted.points;
    let points = has_points.then(|| PosePoints {
        counts: vec![0; wanted.counts.last().copied().unwrap_or(0)],
        below: vec![[0; 3]; placed],
        outside: vec![[0; 3]; outside],
        values: values(placed + outside, false),
        columns: vec![vec![0; placed + outside]; column_count(schema)],
        order: vec![0; if schema.has_order { placed + outside } else { 0 }],
    });
    Pose {
        levels: levels.collect(),
        points,
    }
}

/// Codes the whole of a pose; the coders of each stream but the geometry come back.
fn code_pose<C: BitCoder + Send>(
    schema: &Schema,
    grid: &Grid,
    pose: &mut Pose,
    (counts, ranges): (&[usize], &[Range<usize>]),
    geometry: &mut [Vec<C>],
    coders: impl Fn(StreamKind) -> Vec<C>,
) -> Result<Vec<(StreamKind, Vec<C>)>, Fault> {
    let mut all = Vec::new();
    let mut plans = code_tree(geometry, (counts, ranges), &mut pose.levels, schema.has_values())?;
    if let Some(points) = &mut pose.points {
        let mut position = coders(StreamKind::Position);
        let deepest = pose.levels.last().map_or(&[][..], |level| level.cells.as_slice());
        if let Some(coder) = position.last_mut() {
            code_positions(coder, schema, grid, deepest, points)?;
        }
        all.push((StreamKind::Position, position));
        plans.push(plan_of_points(points));
        if schema.has_order {
            let mut order = coders(StreamKind::Order);
            if let Some(coder) = order.last_mut() {
                code_order(coder, &mut points.order);
            }
            all.push((StreamKind::Order, order));
        }
    }
    if schema.has_values() || schema.has_ellipses {
        code_values(schema, pose, &plans, ranges, coders, &mut all);
    }
    Ok(all)
}

/// Codes the masks of all levels, fills in their cells, and says what is known of their nodes.
fn code_tree<C: BitCoder + Send>(
    coders: &mut [Vec<C>],
    (counts, ranges): (&[usize], &[Range<usize>]),
    levels: &mut [Level],
    wants_plan: bool,
) -> Result<Vec<Vec<Known>>, Fault> {
    if counts.first().is_none_or(|&count| count == 0) {
        return Ok(vec![Vec::new(); levels.len()]);
    }
    let mut models = vec![OccupancyModels::default()];
    let mut neighbours = vec![ALONE];
    let mut above = vec![1u8];
    let mut plans = Vec::new();
    levels[0].cells = vec![0];
    for level in 0..levels.len() {
        let first = first_children(&above);
        let links = Links {
            neighbours: &neighbours,
            masks: &above,
            first: &first,
        };
        plans.push(if wants_plan { plan(links) } else { Vec::new() });
        let Some(&expected) = counts.get(level + 1) else {
            break;
        };
        let section = ranges
            .iter()
            .position(|range| range.contains(&(level + 1)))
            .unwrap_or(0);
        let masks = &mut levels[level].masks;
        let wants_neighbours = wants_plan || level + 2 < counts.len();
        neighbours = code_masks(&mut coders[section], &mut models, links, masks, wants_neighbours);
        above.clone_from(masks);
        let found: usize = above.iter().map(|mask| mask.count_ones() as usize).sum();
        if found != expected {
            return Err(Fault::new(format!(
                "level {} has {found} nodes instead of {expected}",
                level + 1
            )));
        }
        levels[level + 1].cells = cells_below(&levels[level].cells, &above);
    }
    Ok(plans)
}

/// Numbers of points in cells, and what is below.
fn code_positions<C: BitCoder>(
    coder: &mut C,
    schema: &Schema,
    grid: &Grid,
    cells: &[u64],
    points: &mut PosePoints,
) -> Result<(), Fault> {
    code_counts(coder, &mut points.counts);
    let total: u64 = points.counts.iter().map(|&count| u64::from(count)).sum();
    if total != points.below.len() as u64 {
        return Err(Fault::new(format!(
            "cells have {total} points instead of {}",
            points.below.len()
        )));
    }
    let mut below = points.below.iter_mut();
    for (&cell, &count) in cells.iter().zip(&points.counts) {
        let cell = morton::decode(cell);
        let spans = [0, 1, 2].map(|axis| match schema.kept {
            Kept::Exact => ranks(schema.is_double, grid, axis, u64::from(cell[axis])).1,
            _ => 0,
        });
        for point in below.by_ref().take(count as usize) {
            for (axis, value) in point.iter_mut().enumerate() {
                *value = match schema.kept {
                    Kept::Merged => 0,
                    Kept::Bits(bits) => coder.even_bits(u32::from(bits), *value),
                    Kept::Exact => code_even(coder, spans[axis], *value),
                };
            }
        }
    }
    let bits = if schema.is_double { 64 } else { 32 };
    let mut same = crate::reel::coder::BitModel::default();
    let mut last = [0; 3];
    for point in &mut points.outside {
        let is_same = coder.bit(&mut same, *point == last);
        *point = if is_same {
            last
        } else {
            point.map(|value| coder.even_bits(bits, value))
        };
        last = *point;
    }
    Ok(())
}

/// What is known of points: their cell, and the point before in it. Points outside are put beside each other.
fn plan_of_points(points: &PosePoints) -> Vec<Known> {
    let mut plan: Vec<Known> = Vec::with_capacity(points.len());
    let known = |parent: u32, before: Option<usize>, left: u32| Known {
        parent,
        beside: [before.map_or(NONE, |before| before as u32), NONE, NONE],
        directions: [0; 3],
        left: left.min(255) as u8,
    };
    for (cell, &count) in points.counts.iter().enumerate() {
        for place in 0..count {
            let before = (place > 0).then(|| plan.len() - 1);
            plan.push(known(cell as u32, before, count - place));
        }
    }
    for place in 0..points.outside.len() {
        let before = (place > 0).then(|| plan.len() - 1);
        plan.push(known(0, before, 1));
    }
    plan
}

/// Attributes of all levels and of points, stream by stream at the same time.
fn code_values<C: BitCoder + Send>(
    schema: &Schema,
    pose: &mut Pose,
    plans: &[Vec<Known>],
    ranges: &[Range<usize>],
    coders: impl Fn(StreamKind) -> Vec<C>,
    all: &mut Vec<(StreamKind, Vec<C>)>,
) {
    let has_points = pose.points.is_some();
    // The section of each level, and of the points.
    let places: Vec<usize> = (0..pose.levels.len())
        .map(|level| ranges.iter().position(|range| range.contains(&level)).unwrap_or(0))
        .chain(has_points.then_some(ranges.len()))
        .collect();
    let mut colors = Vec::new();
    let mut normals = Vec::new();
    let mut offsets = Vec::new();
    let mut singles: Vec<Vec<&mut Vec<[u16; 1]>>> = (0..schema.singles()).map(|_| Vec::new()).collect();
    let (mut columns, points) = match &mut pose.points {
        Some(points) => (Some(&mut points.columns), Some(&mut points.values)),
        None => (None, None),
    };
    for values in pose.levels.iter_mut().map(|level| &mut level.values).chain(points) {
        colors.push(&mut values.colors);
        normals.push(&mut values.normals);
        offsets.push(&mut values.offsets);
        for (of_single, values) in singles.iter_mut().zip(&mut values.singles) {
            of_single.push(values);
        }
    }
    let has = |is_there: bool, kind: StreamKind| if is_there { coders(kind) } else { Vec::new() };
    let mut of_colors = has(schema.color_step > 0, StreamKind::Color);
    let mut of_normals = has(schema.normal_bits > 0, StreamKind::Normal);
    let mut of_offsets = has(schema.offset_bits > 0, StreamKind::Offset);
    let mut of_singles: Vec<(StreamKind, Vec<C>)> = Vec::new();
    for single in 0..schema.singles() {
        let kind = schema.stream_of_single(single);
        if of_singles.last().is_none_or(|(last, _)| *last != kind) {
            of_singles.push((kind, coders(kind)));
        }
    }
    rayon::join(
        || {
            let mut models = ChannelModels::new(3);
            let mut parents = vec![[128u16; 3]];
            if !of_colors.is_empty() {
                for ((plan, values), &place) in plans.iter().zip(colors).zip(&places) {
                    let step = (u16::from(schema.color_step), 255);
                    code_channels(&mut of_colors[place], &mut models, plan, &parents, values, step);
                    if !values.is_empty() {
                        parents.clone_from(values);
                    }
                }
            }
            for (single, levels) in singles.into_iter().enumerate() {
                let kind = schema.stream_of_single(single);
                let Some((_, coders)) = of_singles.iter_mut().find(|(other, _)| *other == kind) else {
                    continue;
                };
                let most = schema.most_code(single);
                let mut models = ChannelModels::new(1);
                let mut parents = vec![[most / 2]];
                for ((plan, values), &place) in plans.iter().zip(levels).zip(&places) {
                    code_channels(&mut coders[place], &mut models, plan, &parents, values, (1, most));
                    if !values.is_empty() {
                        parents.clone_from(values);
                    }
                }
            }
        },
        || {
            if of_normals.is_empty() {
                return;
            }
            let grid = NormalGrid::of(schema.normal_bits);
            let mut models = NormalModels::default();
            let mut parents = vec![[1i16; 2]];
            for (((plan, values), offsets), &place) in plans.iter().zip(normals).zip(offsets).zip(&places) {
                code_normals(
                    &mut of_normals[place],
                    &mut models,
                    grid,
                    schema.normals_may_miss,
                    plan,
                    &parents,
                    values,
                );
                if !values.is_empty() {
                    parents.clone_from(values);
                }
                if !offsets.is_empty() {
                    let mut models = OffsetModels::default();
                    code_offsets(
                        &mut of_offsets[place],
                        &mut models,
                        grid,
                        schema.offset_bits,
                        plan,
                        values,
                        offsets,
                    );
                }
            }
        },
    );
    if let Some(columns) = columns.as_mut() {
        code_columns(schema, columns, &mut of_normals, &mut of_singles, &coders, all);
    }
    let streams = [
        (StreamKind::Color, of_colors),
        (StreamKind::Normal, of_normals),
        (StreamKind::Offset, of_offsets),
    ];
    all.extend(
        streams
            .into_iter()
            .chain(of_singles)
            .filter(|(_, coders)| !coders.is_empty()),
    );
}

/// Numbers that are kept as they are, behind what was written of the points in steps.
fn code_columns<C: BitCoder>(
    schema: &Schema,
    columns: &mut [Vec<u32>],
    of_normals: &mut [C],
    of_singles: &mut [(StreamKind, Vec<C>)],
    coders: &impl Fn(StreamKind) -> Vec<C>,
    all: &mut Vec<(StreamKind, Vec<C>)>,
) {
    let mut columns = columns.iter_mut();
    if let (true, Some(coder)) = (schema.has_exact_normals, of_normals.last_mut()) {
        for column in columns.by_ref().take(3) {
            code_floats(coder, column);
        }
    }
    let mut of_kind = |kind: StreamKind, columns: &mut dyn Iterator<Item = &mut Vec<u32>>| {
        let coder = of_singles
            .iter_mut()
            .find(|(other, _)| *other == kind)
            .and_then(|(_, coders)| coders.last_mut());
        if let Some(coder) = coder {
            for column in columns {
                code_floats(coder, column);
            }
        }
    };
    if schema.radii == super::schema::Values::Exact {
        of_kind(StreamKind::Radius, &mut columns.by_ref().take(1));
    }
    if schema.has_ellipses {
        let mut of_ellipses = coders(StreamKind::Ellipse);
        if let Some(coder) = of_ellipses.last_mut() {
            for column in columns.by_ref().take(4) {
                code_floats(coder, column);
            }
        }
        all.push((StreamKind::Ellipse, of_ellipses));
    }
    of_kind(StreamKind::Scalar, &mut columns);
}
