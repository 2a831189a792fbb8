//! The compact coding of a frame: level after level, each stream by models that go on from section to section.
//!
//! Streams of different kinds know nothing of each other but the tree, and normals for the offsets; so they are coded
//! at the same time. A section has a coder of its own for each stream: a prefix of sections is a coarser frame.

use super::columns::code_order;
use super::exact::{code_columns, code_positions, columns_by_kind};
use super::grid::Grid;
use super::levels::{Level, Pose, PosePoints};
use super::schema::{Schema, StreamKind};
use super::sections::{CodedSection, CodedStreams, Sizes, Wanted, joined, parted, places_of};
use crate::reel::attributes::{
    NORMAL_CONTEXTS, NormalGrid, OffsetModels, ValueCoder, ValueModels, channel_contexts, code_channels, code_normals,
    code_offsets,
};
use crate::reel::coder::{BitCoder, RangeDecoder, RangeEncoder};
use crate::reel::error::Fault;
use crate::reel::tree::{
    ALONE, Known, Links, NONE, OccupancyModels, cells_below, code_masks, coders_of, first_children, plan,
};
use fearless_simd::{Level as SimdLevel, dispatch};
use std::ops::Range;

/// The streams of a pose, which becomes what a decoder makes of them.
pub(super) fn encode(schema: &Schema, grid: &Grid, pose: &mut Pose, sizes: Sizes<'_>, sections: usize) -> CodedStreams {
    let coders = |_| (0..sections).map(|_| RangeEncoder::default()).collect();
    let of_section = |levels: &Range<usize>| {
        let parts = 0..parts_of_section(sizes.counts, levels);
        parts.map(|_| RangeEncoder::default()).collect()
    };
    let mut geometry: Vec<Vec<RangeEncoder>> = sizes.ranges.iter().map(of_section).collect();
    // An encoder never fails.
    let coded = code_pose(schema, grid, pose, sizes, &mut geometry, coders).unwrap_or_default();
    let finished = |coders: Vec<RangeEncoder>| coders.into_iter().map(RangeEncoder::finish).collect::<Vec<_>>();
    let geometry = geometry.into_iter().map(|parts| joined(&finished(parts))).collect();
    std::iter::once((StreamKind::Geometry, geometry))
        .chain(coded.into_iter().map(|(kind, coders)| (kind, finished(coders))))
        .collect()
}

/// Reads a pose with room for what is in these sections.
pub(super) fn decode(
    wanted: &Wanted<'_>,
    pose: &mut Pose,
    sizes: Sizes<'_>,
    sections: &[CodedSection],
) -> Result<(), Fault> {
    let coders = |kind: StreamKind| {
        let streams = sections.iter().map(|section| section.stream(kind));
        streams.map(RangeDecoder::new).collect::<Vec<_>>()
    };
    let mut geometry = Vec::with_capacity(sizes.ranges.len());
    for (levels, section) in sizes.ranges.iter().zip(sections) {
        let parts = parted(
            section.stream(StreamKind::Geometry),
            parts_of_section(sizes.counts, levels),
        )?;
        geometry.push(parts.into_iter().map(RangeDecoder::new).collect());
    }
    let mut coded = code_pose(wanted.schema, wanted.grid, pose, sizes, &mut geometry, coders)?;
    coded.extend(geometry.into_iter().map(|parts| (StreamKind::Geometry, parts)));
    for (kind, coders) in coded {
        if coders.iter().any(RangeDecoder::has_overrun) {
            return Err(Fault::new(format!("the stream of {} ends too early", kind.name())));
        }
    }
    Ok(())
}

/// Coders of the geometry in a section: of the masks above its first level, or of all levels of the first section.
fn parts_of_section(counts: &[usize], levels: &Range<usize>) -> usize {
    coders_of(counts[levels.start.saturating_sub(1)])
}

/// Codes the whole of a pose; the coders of each stream but the geometry come back.
fn code_pose<C: BitCoder + Send>(
    schema: &Schema,
    grid: &Grid,
    pose: &mut Pose,
    sizes: Sizes<'_>,
    geometry: &mut [Vec<C>],
    coders: impl Fn(StreamKind) -> Vec<C>,
) -> Result<Vec<(StreamKind, Vec<C>)>, Fault> {
    let mut all = Vec::new();
    let mut plans = code_tree(geometry, sizes, &mut pose.levels, schema.has_values())?;
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
        code_values(schema, pose, &plans, sizes, coders, &mut all);
    }
    Ok(all)
}

/// Codes the masks of all levels, fills in their cells, and says what is known of their nodes.
fn code_tree<C: BitCoder + Send>(
    coders: &mut [Vec<C>],
    sizes: Sizes<'_>,
    levels: &mut [Level],
    wants_plan: bool,
) -> Result<Vec<Vec<Known>>, Fault> {
    let counts = sizes.counts;
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
        let section = sizes.section_of(level + 1);
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

/// What is known of points: their cell, and the point before in it. Points outside are put beside each other.
pub(super) fn plan_of_points(points: &PosePoints) -> Vec<Known> {
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
    sizes: Sizes<'_>,
    coders: impl Fn(StreamKind) -> Vec<C>,
    all: &mut Vec<(StreamKind, Vec<C>)>,
) {
    let has_points = pose.points.is_some();
    let places = places_of(sizes.ranges, pose.levels.len(), has_points);
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
            let mut models = ValueModels::new(channel_contexts(3));
            let mut parents = vec![[128u16; 3]];
            if !of_colors.is_empty() {
                for ((plan, values), &place) in plans.iter().zip(colors).zip(&places) {
                    let steps = (u16::from(schema.color_step), 0..=255);
                    let bits = std::mem::take(&mut of_colors[place]);
                    let models = &mut models;
                    let mut coder = ValueCoder { bits, models };
                    dispatch!(SimdLevel::new(), _simd => code_channels(&mut coder, plan, &parents, values, steps));
                    of_colors[place] = coder.bits;
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
                let mut models = ValueModels::new(channel_contexts(1));
                let mut parents = vec![[most / 2]];
                for ((plan, values), &place) in plans.iter().zip(levels).zip(&places) {
                    let steps = (1, 0..=i32::from(most));
                    let bits = std::mem::take(&mut coders[place]);
                    let models = &mut models;
                    let mut coder = ValueCoder { bits, models };
                    dispatch!(SimdLevel::new(), _simd => code_channels(&mut coder, plan, &parents, values, steps));
                    coders[place] = coder.bits;
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
            let mut models = ValueModels::new(NORMAL_CONTEXTS);
            let mut parents = vec![[1i16; 2]];
            for (((plan, values), offsets), &place) in plans.iter().zip(normals).zip(offsets).zip(&places) {
                let bits = std::mem::take(&mut of_normals[place]);
                let models = &mut models;
                let mut coder = ValueCoder { bits, models };
                let may_miss = schema.normals_may_miss;
                dispatch!(SimdLevel::new(), _simd => {
                    code_normals(&mut coder, grid, may_miss, plan, &parents, values);
                });
                of_normals[place] = coder.bits;
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
        let mut of_ellipses = has(schema.has_ellipses, StreamKind::Ellipse);
        for (kind, columns) in columns_by_kind(schema, columns) {
            let single = of_singles.iter_mut().find(|(other, _)| *other == kind);
            let coder = match kind {
                StreamKind::Normal => of_normals.last_mut(),
                StreamKind::Ellipse => of_ellipses.last_mut(),
                _ => single.and_then(|(_, coders)| coders.last_mut()),
            };
            if let Some(coder) = coder {
                code_columns(coder, columns);
            }
        }
        of_singles.push((StreamKind::Ellipse, of_ellipses));
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
