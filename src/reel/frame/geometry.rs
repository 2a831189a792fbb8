//! The geometry of the compact coding: level after level, by models that go on from section to section.

use super::levels::{Level, PosePoints};
use super::schema::StreamKind;
use super::sections::{CodedSection, Sizes, joined, parted};
use crate::reel::coder::{BitCoder, RangeDecoder, RangeEncoder};
use crate::reel::error::Fault;
use crate::reel::tree::{
    ALONE, Known, Links, NONE, OccupancyModels, cells_below, code_masks, coders_of, first_children,
};
use std::ops::Range;

/// Encodes the geometry, and returns the bytes of each section.
pub(super) fn encode(levels: &mut [Level], sizes: Sizes<'_>) -> Vec<Vec<u8>> {
    let of_section = |levels: &Range<usize>| {
        let parts = 0..parts_of_section(sizes.counts, levels);
        parts.map(|_| RangeEncoder::default()).collect()
    };
    let mut coders: Vec<Vec<RangeEncoder>> = sizes.ranges.iter().map(of_section).collect();
    // An encoder never fails.
    let _ = code_tree(&mut coders, sizes, levels);
    let finished = |parts: Vec<RangeEncoder>| {
        let parts: Vec<Vec<u8>> = parts.into_iter().map(RangeEncoder::finish).collect();
        joined(&parts)
    };
    coders.into_iter().map(finished).collect()
}

/// Reads levels allocated for these sections.
pub(super) fn decode(levels: &mut [Level], sizes: Sizes<'_>, sections: &[CodedSection]) -> Result<(), Fault> {
    let mut coders = Vec::with_capacity(sizes.ranges.len());
    for (levels, section) in sizes.ranges.iter().zip(sections) {
        let stream = section.stream(StreamKind::Geometry);
        let parts = parted(stream, parts_of_section(sizes.counts, levels))?;
        coders.push(parts.into_iter().map(RangeDecoder::new).collect());
    }
    code_tree(&mut coders, sizes, levels)?;
    if coders.iter().flatten().any(RangeDecoder::has_overrun) {
        let name = StreamKind::Geometry.name();
        return Err(Fault::new(format!("the stream of {name} ends too early")));
    }
    Ok(())
}

/// Coders of the geometry in a section: of the masks above its first level, or of all levels of the first section.
fn parts_of_section(counts: &[usize], levels: &Range<usize>) -> usize {
    coders_of(counts[levels.start.saturating_sub(1)])
}

/// Codes the masks of all levels, and fills in their cells.
fn code_tree<C: BitCoder + Send>(coders: &mut [Vec<C>], sizes: Sizes<'_>, levels: &mut [Level]) -> Result<(), Fault> {
    let counts = sizes.counts;
    if counts.first().is_none_or(|&count| count == 0) {
        return Ok(());
    }
    let mut models = vec![OccupancyModels::default()];
    let mut neighbours = vec![ALONE];
    let mut above = vec![1u8];
    levels[0].cells = vec![0];
    for level in 0..levels.len() {
        let first = first_children(&above);
        let links = Links {
            neighbours: &neighbours,
            masks: &above,
            first: &first,
        };
        let Some(&expected) = counts.get(level + 1) else {
            break;
        };
        let section = sizes.section_of(level + 1);
        let masks = &mut levels[level].masks;
        let wants_neighbours = level + 2 < counts.len();
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
    Ok(())
}

/// Returns the prediction plan of points: their cell, and the previous point in it. Points outside are placed next to
/// each other.
pub(super) fn plan_of_points(points: &PosePoints) -> Vec<Known> {
    let mut plan: Vec<Known> = Vec::with_capacity(points.len());
    let known = |parent: u32, before: Option<usize>, left: u32| Known {
        parent,
        adjacent: [before.map_or(NONE, |before| before as u32), NONE, NONE],
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
