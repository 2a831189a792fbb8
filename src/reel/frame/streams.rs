//! A frame as streams: a coder of symbols for each stream of a section, that knows nothing of other sections. Of the
//! compact coding the geometry is bits ([`super::geometry`]).
//!
//! A stream of several scalars, or of values in steps and as they are, has a part for each. Positions below cells,
//! numbers as they are and the order of the file are bits in either coding.

use super::columns::code_order;
use super::exact::{code_columns, code_positions, columns_by_kind, columns_of};
use super::flat::code_flat;
use super::geometry;
use super::grid::Grid;
use super::levels::{Level, Pose};
use super::parts::{Direction, Part};
use super::schema::{Schema, StreamKind};
use super::sections::{CodedSection, CodedStreams, Sizes, Wanted, joined, parted};
use super::values::code_values;
use crate::reel::coder::{BitCoder, RangeDecoder, RangeEncoder, SymbolDecoder, SymbolEncoder};
use crate::reel::error::Fault;
use crate::reel::fast::{ABOVE_ROOT, MASK_CONTEXTS, code_masks};
use crate::reel::options::Coding;
use crate::reel::parent_level::{CHANNEL_CONTEXTS, NORMAL_CONTEXTS, OFFSET_CONTEXTS};
use crate::reel::tree::cells_below;
use fearless_simd::{Level as SimdLevel, dispatch};

/// A part of symbols.
#[derive(Debug, Clone, Copy)]
struct SymbolPart {
    kind: StreamKind,
    contexts: usize,
}

/// Parts of symbols that a frame has.
fn symbol_parts(schema: &Schema) -> Vec<SymbolPart> {
    let of_values = |contexts: usize| if schema.is_flat { 1 } else { contexts };
    let others = [
        (schema.coding == Coding::Fast, StreamKind::Geometry, MASK_CONTEXTS),
        (schema.color_step > 0, StreamKind::Color, of_values(CHANNEL_CONTEXTS)),
        (schema.normal_bits > 0, StreamKind::Normal, of_values(NORMAL_CONTEXTS)),
        (schema.offset_bits > 0, StreamKind::Offset, of_values(OFFSET_CONTEXTS)),
    ];
    let of_singles = of_values(CHANNEL_CONTEXTS);
    let singles = (0..schema.singles()).map(|single| (true, schema.stream_of_single(single), of_singles));
    let all = others.into_iter().chain(singles).filter(|(is_there, ..)| *is_there);
    all.map(|(_, kind, contexts)| SymbolPart { kind, contexts }).collect()
}

/// Parts of bits that the points have, by their stream.
fn bit_parts(schema: &Schema) -> Vec<StreamKind> {
    std::iter::once(StreamKind::Position)
        .chain(columns_of(schema).map(|(kind, _)| kind))
        .chain(schema.has_order.then_some(StreamKind::Order))
        .collect()
}

/// Returns the number of parts that belong to a stream.
fn count_of(kind: StreamKind, parts: &[SymbolPart]) -> usize {
    parts.iter().filter(|part| part.kind == kind).count()
}

/// Writes.
struct Encoding {
    parts: Vec<SymbolPart>,
}

impl Direction for Encoding {
    type Coder = SymbolEncoder;

    fn open(&self, part: usize, _: usize) -> Result<SymbolEncoder, Fault> {
        let part = self.parts[part];
        Ok(SymbolEncoder::new(part.contexts))
    }

    fn close(&self, _: usize, coder: SymbolEncoder) -> Result<Vec<u8>, Fault> {
        Ok(coder.finish())
    }
}

/// Reads.
struct Decoding<'a> {
    sections: &'a [CodedSection],
    symbols: Vec<SymbolPart>,
    bits: Vec<StreamKind>,
}

impl<'a> Decoding<'a> {
    /// The bytes of the part of a stream in a section: symbols first, then bits.
    fn part(&self, section: usize, kind: StreamKind, place: usize) -> Result<&'a [u8], Fault> {
        let Some(section) = self.sections.get(section) else {
            return Ok(&[]);
        };
        let symbols = count_of(kind, &self.symbols);
        let bits = if section.levels.is_empty() {
            self.bits.iter().filter(|other| **other == kind).count()
        } else {
            0
        };
        match section.stream(kind) {
            [] => Ok(&[]),
            stream => Ok(parted(stream, symbols + bits)?[place]),
        }
    }
}

impl<'a> Direction for Decoding<'a> {
    type Coder = SymbolDecoder<'a>;

    fn open(&self, part: usize, section: usize) -> Result<SymbolDecoder<'a>, Fault> {
        let SymbolPart { kind, contexts } = self.symbols[part];
        let place = count_of(kind, &self.symbols[..part]);
        SymbolDecoder::new(self.part(section, kind, place)?, contexts)
    }

    fn close(&self, part: usize, coder: SymbolDecoder<'a>) -> Result<Vec<u8>, Fault> {
        if coder.is_at_end() {
            return Ok(Vec::new());
        }
        let name = self.symbols[part].kind.name();
        Err(Fault::new(format!(
            "the stream of {name} does not end where its symbols do"
        )))
    }
}

/// The streams of a pose, which becomes the decoder's result.
pub(super) fn encode(schema: &Schema, grid: &Grid, pose: &mut Pose, sizes: Sizes<'_>, sections: usize) -> CodedStreams {
    let direction = Encoding {
        parts: symbol_parts(schema),
    };
    let bits = if pose.points.is_some() {
        bit_parts(schema)
    } else {
        Vec::new()
    };
    let mut coders: Vec<RangeEncoder> = bits.iter().map(|_| RangeEncoder::default()).collect();
    let geometry = match schema.coding {
        Coding::Compact => geometry::encode(&mut pose.levels, sizes),
        Coding::Fast => Vec::new(),
    };
    // An encoder never fails.
    let coded = code(&direction, schema, grid, pose, sizes, &mut coders).unwrap_or_default();
    let of_symbols = direction.parts.iter().map(|part| part.kind).zip(coded);
    let finished = coders.into_iter().map(RangeEncoder::finish);
    let of_bits: Vec<(StreamKind, Vec<u8>)> = bits.into_iter().zip(finished).collect();
    let of_symbols: Vec<(StreamKind, Vec<Vec<u8>>)> = of_symbols.collect();
    let of_kind = |kind: StreamKind| {
        let of_section = |section: usize| {
            let symbols = of_symbols.iter().filter(|(other, _)| *other == kind);
            let symbols = symbols.map(|(_, of_sections)| of_sections.get(section).cloned().unwrap_or_default());
            // Raw bits belong to points, which are the last section.
            let bits = of_bits
                .iter()
                .filter(|(other, _)| *other == kind && section + 1 == sections);
            let parts: Vec<Vec<u8>> = symbols.chain(bits.map(|(_, bytes)| bytes.clone())).collect();
            if parts.iter().all(Vec::is_empty) {
                Vec::new()
            } else {
                joined(&parts)
            }
        };
        (kind, (0..sections).map(of_section).collect())
    };
    let mut streams: CodedStreams = StreamKind::ALL.into_iter().map(of_kind).collect();
    if schema.coding == Coding::Compact {
        streams.retain(|(kind, _)| *kind != StreamKind::Geometry);
        streams.insert(0, (StreamKind::Geometry, geometry));
    }
    streams
}

/// Returns the number of bytes that the colours of a pose take, of a schema with no other attribute.
pub(super) fn color_bytes(schema: &Schema, pose: &mut Pose, sizes: Sizes<'_>) -> usize {
    let parts = symbol_parts(schema);
    let first_part = parts.iter().take_while(|part| part.kind != StreamKind::Color).count();
    let direction = Encoding { parts };
    let coded = if schema.is_flat {
        code_flat(&direction, first_part, schema, pose, sizes).map(|(written, _)| written)
    } else {
        code_values(&direction, first_part, schema, pose, sizes)
    };
    // An encoder never fails.
    coded.unwrap_or_default().iter().flatten().map(Vec::len).sum()
}

/// Reads a pose allocated for these sections.
pub(super) fn decode(
    wanted: &Wanted<'_>,
    pose: &mut Pose,
    sizes: Sizes<'_>,
    sections: &[CodedSection],
) -> Result<(), Fault> {
    let schema = wanted.schema;
    let direction = Decoding {
        sections,
        symbols: symbol_parts(schema),
        bits: if pose.points.is_some() {
            bit_parts(schema)
        } else {
            Vec::new()
        },
    };
    if schema.coding == Coding::Compact {
        geometry::decode(&mut pose.levels, sizes, sections)?;
    }
    let last = sections.len().saturating_sub(1);
    let of_bits = direction.bits.iter().map(|&kind| {
        let place = count_of(kind, &direction.symbols);
        Ok(RangeDecoder::new(direction.part(last, kind, place)?))
    });
    let mut coders = of_bits.collect::<Result<Vec<_>, Fault>>()?;
    code(&direction, schema, wanted.grid, pose, sizes, &mut coders)?;
    match direction
        .bits
        .iter()
        .zip(&coders)
        .find(|(_, coder)| coder.has_overrun())
    {
        None => Ok(()),
        Some((kind, _)) => Err(Fault::new(format!("the stream of {} ends too early", kind.name()))),
    }
}

/// Codes the whole of a pose. Returns, for each part of symbols, the output of each section.
fn code<D: Direction, B: BitCoder>(
    direction: &D,
    schema: &Schema,
    grid: &Grid,
    pose: &mut Pose,
    sizes: Sizes<'_>,
    of_bits: &mut [B],
) -> Result<Vec<Vec<Vec<u8>>>, Fault> {
    let mut coded = Vec::new();
    if schema.coding == Coding::Fast {
        coded.push(code_tree(Part::open(direction, 0)?, sizes, &mut pose.levels)?);
    }
    if let Some(points) = &mut pose.points {
        let mut of_bits = of_bits.iter_mut();
        let deepest = pose.levels.last().map_or(&[][..], |level| level.cells.as_slice());
        if let Some(coder) = of_bits.next() {
            code_positions(coder, schema, grid, deepest, points)?;
        }
        for ((_, columns), coder) in columns_by_kind(schema, &mut points.columns)
            .into_iter()
            .zip(&mut of_bits)
        {
            code_columns(coder, columns);
        }
        if let Some(coder) = of_bits.next() {
            code_order(coder, &mut points.order);
        }
    }
    let first_part = coded.len();
    if schema.is_flat {
        let (written, flat) = code_flat(direction, first_part, schema, pose, sizes)?;
        coded.extend(written);
        pose.flat = Some(flat);
    } else {
        coded.extend(code_values(direction, first_part, schema, pose, sizes)?);
    }
    Ok(coded)
}

/// Codes the masks of all levels, and fills in their cells.
fn code_tree<D: Direction>(
    mut part: Part<'_, D>,
    sizes: Sizes<'_>,
    levels: &mut [Level],
) -> Result<Vec<Vec<u8>>, Fault> {
    if sizes.counts.first().is_none_or(|&count| count == 0) {
        return part.close();
    }
    levels[0].cells = vec![0];
    for level in 0..levels.len() - 1 {
        let (above, below) = levels.split_at_mut(level + 1);
        let (above, of_level) = above.split_at_mut(level);
        let above = above.last().map_or(&[ABOVE_ROOT][..], |above| above.masks.as_slice());
        let masks = of_level[0].masks.as_mut_slice();
        let coder = part.at(sizes.section_of(level + 1))?;
        dispatch!(SimdLevel::new(), _simd => code_masks(coder, above, masks));
        let expected = sizes.counts[level + 1];
        let found: usize = masks.iter().map(|mask| mask.count_ones() as usize).sum();
        if found != expected {
            return Err(Fault::new(format!(
                "level {} has {found} nodes instead of {expected}",
                level + 1
            )));
        }
        below[0].cells = cells_below(&of_level[0].cells, masks);
    }
    part.close()
}
