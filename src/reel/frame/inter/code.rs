//! Coding of the motion and changes of nodes, as streams and back.

use super::super::schema::{Schema, StreamKind};
use super::super::sections::{CodedSection, blank_sections, places_of, ranges_of, sections_of};
use super::changes::Changes;
use super::followed::Followed;
use super::motion::code_motion;
use super::motion_scale;
use crate::reel::attributes::{
    NORMAL_CONTEXTS, NormalGrid, Turned, ValueCoder, ValueModels, channel_contexts, code_channels, code_turned_normals,
};
use crate::reel::coder::{BitCoder, RangeDecoder, RangeEncoder};
use crate::reel::error::Fault;
use crate::reel::tree::Known;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// A coder for each section, none where nothing changed.
type Coders<C> = Vec<Option<C>>;

/// Coders of every stream.
type CodersByStream<C> = Vec<(StreamKind, Coders<C>)>;

/// Coders of the streams that moved frames have; `coder` makes one for a stream and a section.
fn coders<C>(schema: &Schema, sections: usize, coder: impl Fn(StreamKind, usize) -> Option<C>) -> CodersByStream<C> {
    let singles = (0..schema.singles()).map(|single| (true, schema.stream_of_single(single)));
    let mut kinds: Vec<StreamKind> = [
        (true, StreamKind::Motion),
        (schema.color_step > 0, StreamKind::Color),
        (schema.normal_bits > 0, StreamKind::Normal),
    ]
    .into_iter()
    .chain(singles)
    .filter_map(|(is_there, kind)| is_there.then_some(kind))
    .collect();
    // Scalars share a stream.
    kinds.dedup();
    let of_kind = |kind| (kind, (0..sections).map(|section| coder(kind, section)).collect());
    kinds.into_iter().map(of_kind).collect()
}

/// The frame after `followed` as sections; `followed` becomes the decoder's result.
pub(in crate::reel) fn encode(schema: &Schema, followed: &mut Followed, mut changes: Changes) -> Vec<CodedSection> {
    let counts = followed.counts();
    let ranges = sections_of(&counts);
    let mut sections = blank_sections(&ranges, followed.has_points);
    let places = places_of(&ranges, counts.len(), followed.has_points);
    let has_changed = |kind: StreamKind, section: usize| {
        let levels = changes.levels.iter().zip(&followed.levels).zip(&places);
        let mut own = levels.filter(|(_, place)| **place == section);
        kind == StreamKind::Motion || own.any(|((changed, before), _)| changed.differs(schema, kind, &before.values))
    };
    let coder = |kind, section| has_changed(kind, section).then(RangeEncoder::default);
    let mut coders = coders(schema, sections.len(), coder);
    code_changes(schema, followed, &mut changes, &places, &mut coders);
    coders.sort_by_key(|(kind, _)| *kind);
    for (kind, of_sections) in coders {
        for (section, coder) in sections.iter_mut().zip(of_sections) {
            if let Some(mut bytes) = coder.map(RangeEncoder::finish) {
                // A stream that is not listed has not changed.
                if bytes.is_empty() {
                    bytes.push(0);
                }
                section.streams.push((kind, bytes));
            }
        }
    }
    changes.apply(schema, followed);
    sections
}

/// Reads the first sections of the frame behind `followed`, which becomes that frame.
pub(in crate::reel) fn decode(
    schema: &Schema,
    followed: &mut Followed,
    sections: &[CodedSection],
) -> Result<(), Fault> {
    let ranges = ranges_of(sections);
    let levels = ranges.last().map_or(0, |range| range.end);
    let has_points = ranges.len() < sections.len();
    if levels != followed.counts().len() || has_points != followed.has_points {
        return Err(Fault::new("sections that do not fit those of the frame before"));
    }
    let mut changes = Changes::none(followed);
    let places = places_of(&ranges, levels, has_points);
    let coder = |kind: StreamKind, section: usize| {
        let streams = &sections[section].streams;
        let stream = streams.iter().find(|(other, _)| *other == kind)?;
        Some(RangeDecoder::new(&stream.1))
    };
    let mut coders = coders(schema, sections.len(), coder);
    code_changes(schema, followed, &mut changes, &places, &mut coders);
    for (kind, of_sections) in coders {
        if of_sections.iter().flatten().any(RangeDecoder::has_overrun) {
            return Err(Fault::new(format!("the stream of {} ends too early", kind.name())));
        }
    }
    changes.apply(schema, followed);
    Ok(())
}

/// Coded values of one number, for each level.
type OfLevels<'a, T> = Vec<&'a mut Vec<T>>;

/// Contents of a stream.
enum Told<'a> {
    Motion(OfLevels<'a, [i32; 3]>),
    Colors(OfLevels<'a, [i32; 3]>),
    /// With the unit vectors that an encoder rounded.
    Normals(OfLevels<'a, [i16; 2]>, Vec<&'a [Vec3]>),
    /// For each single number.
    Singles(Vec<OfLevels<'a, [i32; 1]>>),
}

/// Returns the contents of every stream.
fn told<'a>(schema: &Schema, changes: &'a mut Changes) -> Vec<(StreamKind, Told<'a>)> {
    let mut motion = Vec::new();
    let mut colors = Vec::new();
    let (mut normals, mut directions) = (Vec::new(), Vec::new());
    let mut singles: Vec<OfLevels<'_, [i32; 1]>> = (0..schema.singles()).map(|_| Vec::new()).collect();
    for level in &mut changes.levels {
        motion.push(&mut level.steps);
        colors.push(&mut level.colors);
        normals.push(&mut level.normals);
        directions.push(level.directions.as_slice());
        for (of_single, codes) in singles.iter_mut().zip(&mut level.singles) {
            of_single.push(codes);
        }
    }
    let mut by_stream: Vec<(StreamKind, Vec<OfLevels<'_, [i32; 1]>>)> = Vec::new();
    for (single, levels) in singles.into_iter().enumerate() {
        let kind = schema.stream_of_single(single);
        match by_stream.last_mut() {
            // Scalars share a stream.
            Some((last, of_stream)) if *last == kind => of_stream.push(levels),
            _ => by_stream.push((kind, vec![levels])),
        }
    }
    let others = [
        (StreamKind::Motion, Told::Motion(motion)),
        (StreamKind::Color, Told::Colors(colors)),
        (StreamKind::Normal, Told::Normals(normals, directions)),
    ];
    let singles = by_stream
        .into_iter()
        .map(|(kind, levels)| (kind, Told::Singles(levels)));
    others.into_iter().chain(singles).collect()
}

/// Codes all streams at the same time.
fn code_changes<C: BitCoder + Send>(
    schema: &Schema,
    followed: &Followed,
    changes: &mut Changes,
    places: &[usize],
    coders: &mut CodersByStream<C>,
) {
    let mut told = told(schema, changes);
    told.retain(|(kind, _)| coders.iter().any(|(other, _)| other == kind));
    let plans = followed.plans.as_slice();
    coders
        .par_iter_mut()
        .zip(told)
        .for_each(|((_, coders), (_, told))| match told {
            Told::Motion(levels) => code_motion(motion_scale(schema), coders, followed, places, levels),
            Told::Colors(levels) => {
                let step = u16::from(schema.color_step);
                code_levels(coders, plans, places, levels, step, &(-255..=255));
            }
            Told::Normals(levels, directions) => code_normals(schema, coders, followed, places, levels, &directions),
            Told::Singles(of_singles) => {
                for levels in of_singles {
                    let max = i32::from(u16::MAX);
                    code_levels(coders, plans, places, levels, 1, &(-max..=max));
                }
            }
        });
}

/// Codes the changes of the nodes of all levels.
fn code_levels<C: BitCoder, const N: usize>(
    coders: &mut [Option<C>],
    plans: &[Vec<Known>],
    places: &[usize],
    levels: Vec<&mut Vec<[i32; N]>>,
    step: u16,
    range: &RangeInclusive<i32>,
) {
    let mut models = ValueModels::new(channel_contexts(N));
    let mut parents: &[[i32; N]] = &[[0; N]];
    for ((plan, &place), changes) in plans.iter().zip(places).zip(levels) {
        match &mut coders[place] {
            Some(bits) => {
                let models = &mut models;
                let mut coder = ValueCoder {
                    bits: std::mem::take(bits),
                    models,
                };
                code_channels(&mut coder, plan, parents, changes, step, range.clone());
                *bits = coder.bits;
            }
            None => changes.fill([0; N]),
        }
        parents = changes;
    }
}

fn code_normals<C: BitCoder>(
    schema: &Schema,
    coders: &mut [Option<C>],
    followed: &Followed,
    places: &[usize],
    levels: Vec<&mut Vec<[i16; 2]>>,
    directions: &[&[Vec3]],
) {
    let grid = NormalGrid::of(schema.normal_bits);
    let mut models = ValueModels::new(NORMAL_CONTEXTS);
    let mut parents: [&[[i16; 2]]; 2] = [&[[1; 2]]; 2];
    let levels = levels.into_iter().zip(directions).zip(&followed.levels);
    for ((plan, &place), ((of_level, &directions), before)) in followed.plans.iter().zip(places).zip(levels) {
        let before = before.values.normals.as_slice();
        match &mut coders[place] {
            Some(bits) => {
                let turned = Turned {
                    plan,
                    parents,
                    before,
                    directions,
                };
                let models = &mut models;
                let mut coder = ValueCoder {
                    bits: std::mem::take(bits),
                    models,
                };
                code_turned_normals(&mut coder, grid, schema.normals_may_miss, turned, of_level);
                *bits = coder.bits;
            }
            None => of_level.copy_from_slice(before),
        }
        parents = [before, of_level];
    }
}
