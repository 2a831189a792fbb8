//! STL files: triangles with three corners each, as text or binary; corners at the same position are merged into one
//! vertex.
//!
//! The header of a binary file may begin with `solid` like a text file. The two are distinguished by the length: a
//! binary file has 50 bytes for each of the triangles that it counts. Some writers (`VisCAM`, `SolidView`) store a
//! colour in the two bytes after a triangle, flagged by the highest bit; a vertex has the colour of the first triangle
//! it is a corner of.

use crate::cloud::{AxisConvention, Positions, RawCloud};
use crate::io::columns::numbers::{Tokens, parse_number, quoted};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::options::ReadOptions;
use std::collections::HashMap;

/// Stereolithography: ascii, binary.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "STL",
    extensions: &["stl"],
    convention: Some(AxisConvention::UsuallyZUp),
    is_for_meshes: true,
    ..Traits::PLAIN
});

const HEADER_BYTES: usize = 80;
/// Header and the count of triangles.
const START_BYTES: usize = HEADER_BYTES + 4;
const TRIANGLE_BYTES: usize = 50;

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let claimed = bytes
        .get(HEADER_BYTES..START_BYTES)
        .map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    let needed = claimed.map(|count| count.saturating_mul(TRIANGLE_BYTES).saturating_add(START_BYTES));
    if needed.is_some_and(|needed| needed == bytes.len()) {
        return binary(bytes, options);
    }
    let is_text = bytes
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match (claimed, needed) {
        _ if is_text => text(bytes, options),
        // Some writers append something after the last triangle.
        (_, Some(needed)) if needed < bytes.len() => binary(&bytes[..needed], options),
        (Some(claimed), _) => Err(Fault::entry(
            "triangle",
            (bytes.len() - START_BYTES) / TRIANGLE_BYTES,
            format!("the file ends here, but it counts {claimed} triangles: it is truncated"),
        )),
        (None, _) => Err(Fault::header(format!(
            "the file has {} bytes, fewer than the header of a binary file, and does not begin with `solid` like a \
             text",
            bytes.len()
        ))),
    }
}

/// Vertices by their bits.
#[derive(Default)]
struct Mesh {
    index_of: HashMap<[u32; 3], u32>,
    positions: Vec<[f32; 3]>,
    colors: Vec<[u8; 4]>,
    faces: Vec<[u32; 3]>,
    has_colors: bool,
}

impl Mesh {
    /// The number of the vertex at `position`, a new one if there is none yet.
    fn vertex(&mut self, position: [f32; 3], color: [u8; 4], options: &ReadOptions) -> Result<u32, Fault> {
        /// Bytes per entry of the index of positions, including the free slots of such tables.
        const INDEX_BYTES: usize = 40;
        if self.positions.len() == self.positions.capacity() {
            let faces = size_of_val(self.faces.as_slice());
            let vertices = 2 * self.positions.len();
            let point_bytes = size_of::<[f32; 3]>() + size_of::<[u8; 4]>();
            options
                .holding(faces)
                .claim_entries("the vertices", vertices, 2 * (point_bytes + INDEX_BYTES))?;
        }
        // Minus zero is the same position as zero.
        let position = position.map(|axis| if axis == 0.0 { 0.0 } else { axis });
        let next = self.positions.len() as u32;
        let index = *self.index_of.entry(position.map(f32::to_bits)).or_insert(next);
        if index == next {
            self.positions.push(position);
            self.colors.push(color);
        }
        Ok(index)
    }

    fn into_cloud(self) -> RawCloud {
        let mut cloud = RawCloud::from_positions(Positions::F32(self.positions));
        cloud.attributes.colors = self.has_colors.then_some(self.colors);
        cloud.faces = self.faces;
        cloud
    }
}

/// Precondition: behind the header is a whole number of triangles.
fn binary(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    const WHITE: [u8; 4] = [255; 4];
    let mut mesh = Mesh::default();
    options.reserve(&mut mesh.faces, bytes.len() / TRIANGLE_BYTES, "the triangles")?;
    for triangle in bytes[START_BYTES..].chunks_exact(TRIANGLE_BYTES) {
        let (numbers, rest) = triangle.as_chunks::<4>();
        let number = |index: usize| f32::from_le_bytes(numbers[index]);
        let color = color(u16::from_le_bytes([rest[0], rest[1]]));
        mesh.has_colors |= color.is_some();
        // The normal comes first; it can be derived from the corners.
        let corners = [3, 6, 9].map(|first| [number(first), number(first + 1), number(first + 2)]);
        let [a, b, c] = corners.map(|corner| mesh.vertex(corner, color.unwrap_or(WHITE), options));
        mesh.faces.push([a?, b?, c?]);
    }
    Ok(mesh.into_cloud())
}

/// Five bits a channel, blue in the lowest.
fn color(attribute: u16) -> Option<[u8; 4]> {
    let channel = |shift: u16| ((attribute >> shift & 0x1f) * 255 / 31) as u8;
    (attribute & 0x8000 != 0).then(|| [channel(10), channel(5), channel(0), 255])
}

fn text(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let mut mesh = Mesh::default();
    let mut tokens = Tokens::new(bytes, 1);
    let mut corners: Vec<u32> = Vec::new();
    let mut is_open = false;
    while let Some(word) = tokens.next() {
        if word.eq_ignore_ascii_case(b"facet") {
            is_open = true;
        } else if word.eq_ignore_ascii_case(b"vertex") && is_open {
            let mut position = [0.0; 3];
            for axis in &mut position {
                let token = tokens.next().unwrap_or_default();
                let number = parse_number(token).ok_or_else(|| {
                    Fault::new(
                        Place::Line(tokens.line()),
                        format!("found {}, expected a coordinate of a vertex", quoted(token)),
                    )
                })?;
                *axis = number as f32;
            }
            corners.push(mesh.vertex(position, [255; 4], options)?);
        } else if word.eq_ignore_ascii_case(b"endfacet") {
            let [a, b, c] = corners[..] else {
                return Err(Fault::new(
                    Place::Line(tokens.line()),
                    format!("the facet that ends here has {} vertices, expected 3", corners.len()),
                ));
            };
            options.reserve(&mut mesh.faces, 1, "the triangles")?;
            mesh.faces.push([a, b, c]);
            corners.clear();
            is_open = false;
        }
    }
    if is_open {
        return Err(Fault::new(
            Place::Line(tokens.line()),
            "the file ends within a facet: it is truncated",
        ));
    }
    Ok(mesh.into_cloud())
}
