//! From named columns to a cloud: which name means what.

use super::column::Column;
use super::error::Fault;

const POSITIONS: [&str; 3] = ["x", "y", "z"];

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

/// What `CloudCompare` writes before the names of scalars: whatever follows is one.
const SCALAR_PREFIX: &str = "scalar_";

/// Scalars beyond those of known names that are taken.
const MAX_OTHER_SCALARS: usize = 32;

/// Names of scalars, the best to colour by first.
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

/// True when a cloud looks at a column of this name.
pub(super) fn is_used(name: &str) -> bool {
    is_reserved(name) || is_scalar(&name.to_ascii_lowercase())
}

/// True when a column of this name is no scalar.
pub(super) fn is_reserved(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let name = name.as_str();
    POSITIONS.contains(&name)
        || NORMALS.iter().flatten().any(|known| *known == name)
        || COLORS.iter().flatten().any(|known| *known == name)
        || PACKED_COLORS.contains(&name)
        || ALPHA.contains(&name)
        || RADII.contains(&name)
}

fn is_scalar(name: &str) -> bool {
    name.starts_with(SCALAR_PREFIX) || SCALARS.contains(&name)
}

/// Which column is what, by index; what their names do not say is left out.
#[derive(Debug)]
pub(super) struct Roles {
    pub(super) positions: [usize; 3],
    pub(super) normals: Option<[usize; 3]>,
    pub(super) colors: Option<Colors>,
    pub(super) radii: Option<usize>,
    /// The best to colour by first.
    pub(super) scalars: Vec<usize>,
}

/// Where the colours are.
#[derive(Debug, Clone, Copy)]
pub(super) enum Colors {
    /// Red, green and blue in columns of their own.
    Channels { channels: [usize; 3], alpha: Option<usize> },
    /// All in one number.
    Packed(usize),
}

impl Roles {
    /// Fails when there are no coordinates.
    pub(super) fn of(columns: &[Column<'_>]) -> Result<Self, Fault> {
        let find = |name: &str| columns.iter().position(|column| column.name.eq_ignore_ascii_case(name));
        let find_any = |names: &[&str]| names.iter().find_map(|name| find(name));
        let find_all = |names: &[&str; 3]| Some([find(names[0])?, find(names[1])?, find(names[2])?]);

        let positions = find_all(&POSITIONS).ok_or_else(|| {
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
        let channels = COLORS.iter().find_map(find_all);
        let colors = channels
            .map(|channels| Colors::Channels {
                channels,
                alpha: find_any(&ALPHA),
            })
            .or_else(|| find_any(&PACKED_COLORS).map(Colors::Packed));
        let has_name = |column: &Column<'_>, name: &str| {
            let found = column.name.to_ascii_lowercase();
            found.strip_prefix(SCALAR_PREFIX).unwrap_or(&found) == name
        };
        let scalar = |name: &&str| columns.iter().position(|column| has_name(column, name));
        let mut scalars: Vec<usize> = SCALARS.iter().filter_map(scalar).collect();
        let others = (0..columns.len()).filter(|&index| {
            let name = columns[index].name.to_ascii_lowercase();
            name.starts_with(SCALAR_PREFIX) && !scalars.contains(&index)
        });
        let others: Vec<usize> = others.take(MAX_OTHER_SCALARS).collect();
        scalars.extend(others);
        Ok(Self {
            positions,
            normals: NORMALS.iter().find_map(find_all),
            colors,
            radii: find_any(&RADII),
            scalars,
        })
    }

    /// Whether a row alone tells what it means. Colours wider than a byte do not: the brightest of all tells what is
    /// full intensity.
    pub(super) fn are_local(&self, columns: &[Column<'_>]) -> bool {
        match self.colors {
            Some(Colors::Channels { channels, alpha }) => channels
                .into_iter()
                .chain(alpha)
                .all(|index| columns[index].scalar.byte_size() == 1),
            Some(Colors::Packed(_)) | None => true,
        }
    }
}

/// True if columns of these names hold points.
pub(super) fn has_positions(names: &[&str]) -> bool {
    has_all(names, &POSITIONS)
}

/// True if columns of these names hold normals.
pub(super) fn has_normals(names: &[&str]) -> bool {
    NORMALS.iter().any(|wanted| has_all(names, wanted))
}

fn has_all(names: &[&str], wanted: &[&str; 3]) -> bool {
    let has = |wanted: &&str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    wanted.iter().all(has)
}

/// The `count` normals in `columns`.
pub(super) fn normals(columns: &[Column<'_>], count: usize) -> Result<Vec<[f32; 3]>, Fault> {
    let find = |name: &&str| columns.iter().find(|column| column.name.eq_ignore_ascii_case(name));
    let find_all = |[x, y, z]: &[&str; 3]| Some([find(x)?, find(y)?, find(z)?]);
    let axes = NORMALS.iter().find_map(find_all).ok_or_else(|| {
        Fault::header("there are no normals: expected nx, ny and nz, or normal_x, normal_y and normal_z")
    })?;
    let [x, y, z] = axes.map(|axis| axis.to_f32(count));
    Ok((0..count).map(|row| [x[row], y[row], z[row]]).collect())
}
