//! Packed splats of four words each, as `PlayCanvas` and `SuperSplat` save them (`.compressed.ply`).
//!
//! 256 splats are a chunk, for which the file has the least and the largest coordinates, logarithms of half axes, and,
//! in later files, colours. A word holds 11, 10 and 11 bits of a position between those, from the top down; a rotation
//! is two bits for its largest component (the real one first) and ten for each of the others; colour and opacity are
//! bytes. Harmonics after the splats are ignored.

use super::super::splats::{LARGEST_OF_OTHERS, SPLAT_BYTES, SplatShape, byte, put_shapes, with_largest};
use super::binary::rows;
use super::header::{Element, PlyHeader};
use super::retained_columns::POINTS;
use crate::cloud::{Positions, RawCloud};
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use glam::{Quat, Vec3};
use ply_rs_bw::ply::Encoding;

const CHUNKS: &str = "chunk";

const CHUNK_SPLATS: usize = 256;

const WORDS: [&str; 4] = ["packed_position", "packed_rotation", "packed_scale", "packed_color"];

/// Names of the ends of a range of three numbers, in chunks.
const PLACES: [&str; 6] = ["min_x", "min_y", "min_z", "max_x", "max_y", "max_z"];
const SCALES: [&str; 6] = [
    "min_scale_x",
    "min_scale_y",
    "min_scale_z",
    "max_scale_x",
    "max_scale_y",
    "max_scale_z",
];
const COLORS: [&str; 6] = ["min_r", "min_g", "min_b", "max_r", "max_g", "max_b"];

/// True for the columns of packed splats.
pub(super) fn is_used(name: &str) -> bool {
    WORDS.contains(&name)
}

/// The splats of a file with this header; `None` where they are not packed.
pub(super) fn decode(bytes: &[u8], header: &PlyHeader, options: &ReadOptions) -> Option<Result<RawCloud, Fault>> {
    let find = |name: &str| header.elements.iter().find(|element| element.name == name);
    let (chunks, splats) = (find(CHUNKS)?, find(POINTS)?);
    let has_words = WORDS
        .iter()
        .all(|word| splats.properties.iter().any(|property| property.name == *word));
    if !has_words || matches!(header.encoding, Encoding::Ascii) {
        return None;
    }
    Some(unpack(bytes, header, chunks, splats, options))
}

fn unpack(
    bytes: &[u8],
    header: &PlyHeader,
    chunks: &Element,
    splats: &Element,
    options: &ReadOptions,
) -> Result<RawCloud, Fault> {
    if chunks.count < splats.count.div_ceil(CHUNK_SPLATS) {
        return Err(Fault::header(format!(
            "there are {} chunks of {CHUNK_SPLATS} for {} splats: the header is wrong",
            chunks.count, splats.count
        )));
    }
    let numbers = |element: &Element, names: &[&str]| -> Result<Option<Vec<Vec<f64>>>, Fault> {
        let big_endian = header.encoding == Encoding::BinaryBigEndian;
        let Some((start, rows)) = start_of(header, element).zip(rows(element, 0, big_endian)) else {
            return Err(Fault::header("the rows before the splats are not of one length"));
        };
        let payload = bytes.get(start..).unwrap_or_default();
        element.check_claim(rows.row_bytes, payload.len())?;
        // The packed splats stay in memory next to the cloud.
        let row_bytes = names.len() * size_of::<f64>() + SPLAT_BYTES;
        options.claim_entries(&format!("{} splats", element.count), element.count, row_bytes)?;
        let columns = rows.columns(payload);
        let column = |name: &&str| {
            let column = columns.iter().find(|column| column.name == **name)?;
            Some(column.to_f64(element.count))
        };
        Ok(names.iter().map(column).collect())
    };
    let missing = |what: &str| Fault::header(format!("chunks of packed splats have no {what}"));
    let places = numbers(chunks, &PLACES)?.ok_or_else(|| missing("min_x to max_z"))?;
    let scales = numbers(chunks, &SCALES)?.ok_or_else(|| missing("min_scale_x to max_scale_z"))?;
    let colors = numbers(chunks, &COLORS)?;
    let words = numbers(splats, &WORDS)?.ok_or_else(|| missing("words"))?;
    let word = |kind: usize, splat: usize| words[kind][splat] as u32;

    let place = |splat: usize| within(&places, splat, three_parts(word(0, splat))).to_array();
    let mut cloud = RawCloud::from_positions(Positions::F32((0..splats.count).map(place).collect()));
    let color = |splat: usize| {
        let [r, g, b, alpha] = word(3, splat).to_be_bytes();
        let shares = Vec3::from_array([r, g, b].map(|channel| f32::from(channel) / 255.0));
        let [r, g, b] = match &colors {
            Some(colors) => within(colors, splat, shares),
            None => shares,
        }
        .to_array()
        .map(byte);
        [r, g, b, alpha]
    };
    cloud.attributes.colors = Some((0..splats.count).map(color).collect());
    put_shapes(&mut cloud, &[], |splat| SplatShape {
        log_scales: within(&scales, splat, three_parts(word(2, splat))).to_array(),
        rotation: rotation(word(1, splat)),
    });
    Ok(cloud)
}

/// Returns the byte offset of the rows of an element.
fn start_of(header: &PlyHeader, element: &Element) -> Option<usize> {
    let before = header.elements.iter().take_while(|other| other.name != element.name);
    before.into_iter().try_fold(header.byte_size, |start, other| {
        start.checked_add(other.count.checked_mul(other.fixed_row_bytes()?)?)
    })
}

/// The place at these shares between the ends of the chunk of a splat.
fn within(ends: &[Vec<f64>], splat: usize, shares: Vec3) -> Vec3 {
    let chunk = splat / CHUNK_SPLATS;
    Vec3::from_array([0, 1, 2].map(|axis| {
        let [min, max] = [ends[axis][chunk], ends[axis + 3][chunk]];
        let share = f64::from(shares[axis]);
        (min * (1.0 - share) + max * share) as f32
    }))
}

/// Three shares of 11, 10 and 11 bits.
fn three_parts(word: u32) -> Vec3 {
    let share = |shift: u32, bits: u32| {
        let max = (1 << bits) - 1;
        (word >> shift & max) as f32 / max as f32
    };
    Vec3::new(share(21, 11), share(11, 10), share(0, 11))
}

fn rotation(word: u32) -> Quat {
    let part = |shift: u32| ((word >> shift & 1023) as f32 / 1023.0 - 0.5) * 2.0 * LARGEST_OF_OTHERS;
    let [real, i, j, k] = with_largest([part(20), part(10), part(0)], word >> 30);
    Quat::from_xyzw(i, j, k, real)
}
