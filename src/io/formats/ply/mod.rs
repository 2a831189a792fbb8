//! PLY: a header of elements with typed properties, then their rows as text or binary.
//!
//! The header's lines are read by `ply-rs-bw`; of the payload the columns of the `vertex` element and the triangles of
//! the `face` and `tristrips` elements are stored, everything else is skipped, and data after these is not read. Damage
//! after the points costs faces, not points: these are shown, with a warning.

mod ascii;
mod binary;
mod dropped;
mod faces;
mod header;
mod moving_splats;
mod packed_splats;
mod retained_columns;
mod splat_columns;
mod splats;
mod writer;

use super::splats::SPLAT_BYTES;
use crate::cloud::RawCloud;
use crate::io::columns::column::Column;
use crate::io::columns::fixed_rows::{FixedRows, bytes_behind};
use crate::io::columns::{attributes, growing};
use crate::io::error::Fault;
use crate::io::format::{Format, Magic, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use faces::{FaceList, Faces};
use header::PlyHeader;
use ply_rs_bw::ply::Encoding;
use retained_columns::POINTS;
use splats::Splats;

/// Stanford polygon file: ascii, little and big endian.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "PLY",
    extensions: &["ply"],
    magic: &[Magic::start(b"ply\n"), Magic::start(b"ply\r"), Magic::start(b"ply ")],
    ..Traits::PLAIN
});

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<RawCloud, Fault> {
    let header = PlyHeader::parse(bytes)?;
    if let Some(splats) = packed_splats::decode(bytes, &header, options) {
        return splats;
    }
    let PlyRows {
        mut columns,
        count,
        faces,
        warnings,
    } = read_rows(bytes, &header, options, progress)?;
    let options = &options.holding(faces.byte_size());
    let anchors = splats::drop_anchors(&mut columns);
    let mut cloud = match Splats::take(columns) {
        Ok((splats, columns)) => {
            options.claim_entries("the splats", count, SPLAT_BYTES)?;
            let mut cloud = growing::cloud(&columns, count, options)?;
            splats.put_into(&mut cloud);
            cloud.dropped.extend(dropped::dropped_of_splats(&header));
            cloud
        }
        Err(columns) => growing::cloud(&columns, count, options)?,
    };
    cloud.convention = cloud.convention.or_else(|| writer::convention(bytes));
    faces.put_into(&mut cloud);
    cloud.dropped.extend(dropped::dropped(&header));
    cloud.warnings.extend(header.warnings);
    cloud.warnings.extend(anchors);
    cloud.warnings.extend(warnings);
    Ok(cloud)
}

/// The normals in a file that may have no points.
pub(in crate::io) fn normals(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<Vec<[f32; 3]>, Fault> {
    let rows = read_rows(bytes, &PlyHeader::parse(bytes)?, options, progress)?;
    attributes::normals(&rows.columns, rows.count)
}

/// Names of the point attributes in a file that begins with `head`.
pub(in crate::io) fn point_names(head: &[u8]) -> Option<Vec<String>> {
    let mut elements = PlyHeader::parse(head).ok()?.elements.into_iter();
    let vertex = elements.find(|element| element.name == POINTS)?;
    let properties = vertex.properties.into_iter();
    Some(properties.map(|property| property.name).collect())
}

/// Parsed rows of a file.
struct PlyRows<'a> {
    /// Columns of the points.
    columns: Vec<Column<'a>>,
    /// Number of points.
    count: usize,
    faces: Faces,
    warnings: Vec<String>,
}

fn read_rows<'a>(
    bytes: &'a [u8],
    header: &PlyHeader,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<PlyRows<'a>, Fault> {
    let Some(vertex) = header.elements.iter().find(|element| element.name == POINTS) else {
        return Err(no_points(header));
    };
    let last = header
        .elements
        .iter()
        .rposition(|element| element.name == POINTS || FaceList::of(element).is_some());
    let elements = &header.elements[..last.map_or(0, |last| last + 1)];
    let is_all = elements.len() == header.elements.len();
    let (columns, faces, warnings) = match header.encoding {
        Encoding::Ascii => ascii::read(bytes, header, elements, vertex, options, progress)?,
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => {
            let big_endian = header.encoding == Encoding::BinaryBigEndian;
            let (columns, faces, rest) =
                binary::read(&bytes[header.byte_size..], big_endian, elements, vertex, options)?;
            let warnings = bytes_behind(rest as u64).filter(|_| is_all);
            (columns, faces, warnings.into_iter().collect())
        }
    };
    Ok(PlyRows {
        columns,
        count: vertex.count,
        faces,
        warnings,
    })
}

/// Returns the error for a file without points.
fn no_points(header: &PlyHeader) -> Fault {
    let elements: Vec<String> = header
        .elements
        .iter()
        .map(|element| {
            let names: Vec<&str> = element
                .properties
                .iter()
                .map(|property| property.name.as_str())
                .collect();
            format!("`{}` of {} rows ({})", element.name, element.count, names.join(" "))
        })
        .collect();
    let found = if elements.is_empty() {
        "no element".to_owned()
    } else {
        elements.join(", ")
    };
    Fault::header(format!(
        "missing element `vertex`, which has the points of a point cloud; found {found}: rename the one with the \
         points in the header"
    ))
}

/// Returns the layout of the point rows in a file that begins with `head`, if they can be read without the whole of it.
pub(in crate::io) fn fixed_rows(head: &[u8]) -> Option<FixedRows> {
    let header = PlyHeader::parse(head).ok()?;
    let mut rows = match header.encoding {
        Encoding::Ascii => None,
        Encoding::BinaryLittleEndian => binary::fixed_rows(&header, false),
        Encoding::BinaryBigEndian => binary::fixed_rows(&header, true),
    };
    if let Some(rows) = &mut rows {
        rows.convention = writer::convention(head);
    }
    // If a header is as long as `head`, the ending of its last line may be truncated. Splats need all their columns.
    // Warnings about the header are reported when the whole file is read.
    rows.filter(|rows| {
        let is_there = |name: &str| rows.fields.iter().any(|field| field.name == name);
        let are_splats =
            splats::are_splats(&is_there) || rows.fields.iter().any(|field| packed_splats::is_used(&field.name));
        let says_something =
            !header.warnings.is_empty() || rows.fields.iter().any(|field| splats::is_anchor(&field.name));
        header.byte_size < head.len() && !says_something && !are_splats
    })
}
