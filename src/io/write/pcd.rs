//! PCD, binary: point after point.
//!
//! Lines of an organised cloud stay lines if it is known where the sensor stood: readers take the viewpoint of such a
//! file for true, even where it is the origin.

use super::columns::{CHUNK_BYTES, Colors, Type, columns, plain_name, renamed};
use super::encoder::{Encoder, Held, WriteSeek};
use super::loss::Loss;
use crate::cloud::RawCloud;

const HOLDS: &[Held] = &[
    Held::Normals,
    Held::Alpha,
    Held::Radii,
    Held::Scalars,
    Held::Holes,
    Held::Rows,
    Held::Sensor,
];

/// PCD 0.7, binary: all but ellipses and faces.
pub(in crate::io) const ENCODER: &Encoder = &Encoder {
    name: "pcd",
    extension: "pcd",
    holds: HOLDS,
    lost,
    write: |out, cloud| write(out, cloud),
};

const NORMALS: [&str; 3] = ["normal_x", "normal_y", "normal_z"];

fn name(name: &str) -> String {
    match plain_name(name, |sign| sign.is_ascii_graphic()) {
        // On its own it is the name of padding.
        plain if plain == "_" => "scalar__".to_owned(),
        plain => plain,
    }
}

fn lost(cloud: &RawCloud) -> Vec<(Loss, f64)> {
    let mut lost = renamed(cloud, Colors::None, NORMALS, name);
    if cloud.grid.is_some() && cloud.sensor.is_none() {
        lost.push((Loss::Rows, 0.0));
    }
    lost
}

fn write(out: &mut dyn WriteSeek, cloud: &RawCloud) -> std::io::Result<()> {
    let columns = columns(cloud, Colors::None, NORMALS, name);
    let count = cloud.positions.len();
    let colors = cloud.attributes.colors.as_deref();
    let has_alpha = colors.is_some_and(|colors| colors.iter().any(|color| color[3] != u8::MAX));
    // PCL stores colours in the bits of a float, those with alpha in an unsigned integer.
    let color = colors.map(|_| if has_alpha { ("rgba", "U") } else { ("rgb", "F") });

    let mut lines = ["FIELDS", "SIZE", "TYPE", "COUNT"].map(str::to_owned);
    let columns_then_color = columns
        .iter()
        .map(|column| {
            let size = if column.kind() == Type::F64 { "8" } else { "4" };
            [column.name.as_str(), size, "F", "1"]
        })
        .chain(color.map(|(name, kind)| [name, "4", kind, "1"]));
    for words in columns_then_color {
        for (line, word) in lines.iter_mut().zip(words) {
            line.push(' ');
            line.push_str(word);
        }
    }
    let sensor = cloud.sensor.unwrap_or_default();
    let grid = cloud.grid.filter(|_| cloud.sensor.is_some());
    let (width, height) = grid.map_or((count, 1), |grid| (grid.width() as usize, grid.height()));
    write!(
        out,
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{}\nWIDTH {width}\nHEIGHT {height}\nVIEWPOINT {} {} \
         {} 1 0 0 0\nPOINTS {count}\nDATA binary\n",
        lines.join("\n"),
        sensor.x,
        sensor.y,
        sensor.z
    )?;
    let mut bytes = Vec::new();
    for row in 0..count {
        for column in &columns {
            column.put_bytes(row, &mut bytes);
        }
        if let Some([red, green, blue, alpha]) = colors.map(|colors| colors[row]) {
            bytes.extend([blue, green, red, if has_alpha { alpha } else { 0 }]);
        }
        if bytes.len() >= CHUNK_BYTES {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)
}
