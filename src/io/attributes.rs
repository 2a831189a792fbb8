//! From named columns to a cloud: which name means what.

use super::column::{Column, Scalar, Values, set_colors, vectors_f32, vectors_f64};
use super::error::Fault;
use crate::cloud::{Positions, RawCloud, ScalarField};

/// Names of normals, in the order PLY, PCD.
const NORMALS: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];

/// Names of colour channels.
const COLORS: [[&str; 3]; 3] = [
    ["red", "green", "blue"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ["r", "g", "b"],
];

/// Names of colours packed into one number.
const PACKED_COLORS: [&str; 2] = ["rgb", "rgba"];

const ALPHA: [&str; 3] = ["alpha", "diffuse_alpha", "a"];

const RADII: [&str; 2] = ["radius", "splat_radius"];

/// Names of scalars, the best to colour by first. `CloudCompare` writes `scalar_` before them.
const SCALARS: [&str; 22] = [
    "intensity",
    "reflectance",
    "reflectivity",
    "scalar",
    "quality",
    "confidence",
    "curvature",
    "classification",
    "class",
    "label",
    "temperature",
    "time",
    "timestamp",
    "t",
    "gps_time",
    "gpstime",
    "ring",
    "return_number",
    "number_of_returns",
    "ambient",
    "near_ir",
    "range",
];

/// True when [`cloud`] looks at a column of this name.
pub(super) fn is_used(name: &str) -> bool {
    is_reserved(name) || is_scalar(&name.to_ascii_lowercase())
}

/// True when a column of this name is no scalar.
pub(super) fn is_reserved(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let name = name.as_str();
    ["x", "y", "z"].contains(&name)
        || NORMALS.iter().flatten().any(|known| *known == name)
        || COLORS.iter().flatten().any(|known| *known == name)
        || PACKED_COLORS.contains(&name)
        || ALPHA.contains(&name)
        || RADII.contains(&name)
}

fn is_scalar(name: &str) -> bool {
    SCALARS.contains(&name.strip_prefix("scalar_").unwrap_or(name))
}

/// The cloud of `count` points in `columns`; what their names do not say is left out.
pub(super) fn cloud(columns: &[Column<'_>], count: usize) -> Result<RawCloud, Fault> {
    let find = |name: &str| {
        columns
            .iter()
            .find(|column| column.name.eq_ignore_ascii_case(name))
    };
    let find_any = |names: &[&str]| names.iter().find_map(|name| find(name));
    let find_all = |names: &[&str; 3]| Some([find(names[0])?, find(names[1])?, find(names[2])?]);

    let coordinates = find_all(&["x", "y", "z"]).ok_or_else(|| {
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        Fault::header(format!(
            "the points have no coordinates: expected x, y and z, found {}",
            if names.is_empty() {
                "nothing".to_owned()
            } else {
                names.join(", ")
            }
        ))
    })?;
    // Narrower integers fit an f32 exactly. Text has the digits that were written, whatever its header calls them.
    let is_wide = |column: &&Column<'_>| {
        matches!(column.values, Values::Parsed(_))
            || matches!(
                column.scalar,
                Scalar::F64 | Scalar::I32 | Scalar::U32 | Scalar::I64 | Scalar::U64
            )
    };
    let positions = if coordinates.iter().any(is_wide) {
        Positions::F64(vectors_f64(coordinates, count))
    } else {
        Positions::F32(vectors_f32(coordinates, count))
    };

    let mut cloud = RawCloud::from_positions(positions);
    cloud.normals = NORMALS
        .iter()
        .find_map(find_all)
        .map(|columns| vectors_f32(columns, count));
    if let Some(channels) = COLORS.iter().find_map(find_all) {
        set_colors(&mut cloud, channels, find_any(&ALPHA), count);
    } else {
        cloud.colors = find_any(&PACKED_COLORS).map(|column| packed_colors(column, count));
    }
    cloud.radii = find_any(&RADII).map(|column| column.to_f32(count));
    let has_name = |column: &Column<'_>, name: &str| {
        let found = column.name.to_ascii_lowercase();
        found.strip_prefix("scalar_").unwrap_or(&found) == name
    };
    cloud.scalars = SCALARS
        .iter()
        .filter_map(|name| columns.iter().find(|column| has_name(column, name)))
        .map(|column| scalar_field(column, count))
        .collect();
    Ok(cloud)
}

fn scalar_field(column: &Column<'_>, count: usize) -> ScalarField {
    let is_wide = matches!(
        column.scalar,
        Scalar::F64 | Scalar::I32 | Scalar::U32 | Scalar::I64 | Scalar::U64
    );
    if is_wide {
        ScalarField::from_f64(&column.name, &column.to_f64(count))
    } else {
        ScalarField::new(&column.name, column.to_f32(count))
    }
}

/// PCL packs colours as 0xAARRGGBB, into an unsigned integer or into the bits of a float. `rgb` leaves alpha at 0.
fn packed_colors(column: &Column<'_>, count: usize) -> Vec<[u8; 4]> {
    let has_alpha = column.name.eq_ignore_ascii_case("rgba");
    let mut colors: Vec<[u8; 4]> = column
        .bits(count)
        .into_iter()
        .map(|bits| {
            let [blue, green, red, alpha] = bits.to_le_bytes();
            [red, green, blue, if has_alpha { alpha } else { 255 }]
        })
        .collect();
    // Writers that know no transparency leave zeros.
    if has_alpha && colors.iter().all(|color| color[3] == 0) {
        for color in &mut colors {
            color[3] = 255;
        }
    }
    colors
}
