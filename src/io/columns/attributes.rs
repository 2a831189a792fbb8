//! From named columns to a cloud: the meanings of names.

use super::column::Column;
use crate::cloud::ScalarField;
use crate::io::error::Fault;

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

/// `CloudCompare` writes this before the names of scalars.
const SCALAR_PREFIX: &str = "scalar_";

/// Names of scalars in the order in which they come first, the best to colour by foremost. Columns of all other names
/// are scalars as well, behind these.
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

/// True if a column of this name is not a scalar, unless there is another of the same meaning.
pub(in crate::io) fn is_reserved(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let name = name.as_str();
    POSITIONS.contains(&name)
        || NORMALS.iter().flatten().any(|known| *known == name)
        || COLORS.iter().flatten().any(|known| *known == name)
        || PACKED_COLORS.contains(&name)
        || ALPHA.contains(&name)
        || RADII.contains(&name)
}

/// Roles of the columns, by index. Every column without another role is a scalar field.
#[derive(Debug)]
pub(super) struct Roles {
    pub(in crate::io) positions: [usize; 3],
    pub(in crate::io) normals: Option<[usize; 3]>,
    pub(in crate::io) colors: Option<Colors>,
    pub(in crate::io) radii: Option<usize>,
    /// The best to colour by first.
    pub(in crate::io) scalars: Vec<usize>,
}

/// Location of the colours.
#[derive(Debug, Clone, Copy)]
pub(in crate::io) enum Colors {
    /// Red, green and blue in separate columns.
    Channels { channels: [usize; 3], alpha: Option<usize> },
    /// All in one number.
    Packed(usize),
}

impl Roles {
    /// Fails if there are no coordinates.
    pub(in crate::io) fn of(columns: &[Column<'_>]) -> Result<Self, Fault> {
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
        let normals = NORMALS.iter().find_map(find_all);
        let radii = find_any(&RADII);
        let mut is_free = vec![true; columns.len()];
        let (channels, packed) = match colors {
            Some(Colors::Channels { channels, alpha }) => (Some(channels), alpha),
            Some(Colors::Packed(index)) => (None, Some(index)),
            None => (None, None),
        };
        let vectors = [Some(positions), normals, channels];
        let taken = vectors.into_iter().flatten().flatten().chain(packed).chain(radii);
        for index in taken {
            is_free[index] = false;
        }
        let scalars = (0..columns.len()).filter(|&index| is_free[index]);
        let mut scalars: Vec<usize> = scalars.collect();
        // Stable: scalars without a known name stay in the order of the file.
        scalars.sort_by_key(|&index| rank(&columns[index].name));
        Ok(Self {
            positions,
            normals,
            colors,
            radii,
            scalars,
        })
    }

    /// Bytes that a point takes in memory.
    pub(in crate::io) fn point_bytes(&self, columns: &[Column<'_>]) -> usize {
        let number = |is_wide: bool| if is_wide { size_of::<f64>() } else { size_of::<f32>() };
        let is_wide = self.positions.iter().any(|&index| columns[index].may_be_wide());
        // Wide scalars are narrowed in the end.
        let scalars = self
            .scalars
            .iter()
            .map(|&index| number(columns[index].scalar.is_wide()));
        3 * number(is_wide)
            + self.normals.map_or(0, |_| size_of::<[f32; 3]>())
            + self.colors.map_or(0, |_| size_of::<[u8; 4]>())
            + self.radii.map_or(0, |_| size_of::<f32>())
            + scalars.sum::<usize>()
    }

    /// Returns true if a row can be interpreted on its own. Rows with colours wider than a byte cannot: full intensity
    /// is determined by the brightest of all.
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

/// The rank of a scalar among others: the position of its name in the list.
fn rank(name: &str) -> usize {
    let plain = plain_scalar_name(name);
    let known = SCALARS.iter().position(|known| *known == plain);
    known.unwrap_or(SCALARS.len())
}

/// Puts fields into the order in which they are offered, the best to colour by first.
pub(in crate::io) fn sort_fields(fields: &mut [ScalarField]) {
    fields.sort_by_cached_key(|field| rank(&field.name));
}

/// The name of a scalar in lower case and without the prefix of `CloudCompare`.
pub(in crate::io) fn plain_scalar_name(name: &str) -> String {
    let mut name = name.to_ascii_lowercase();
    if name.len() > SCALAR_PREFIX.len() && name.starts_with(SCALAR_PREFIX) {
        name.drain(..SCALAR_PREFIX.len());
    }
    name
}

/// True if columns of these names hold points.
pub(in crate::io) fn has_positions(names: &[&str]) -> bool {
    has_all(names, &POSITIONS)
}

/// True if columns of these names hold normals.
pub(in crate::io) fn has_normals(names: &[&str]) -> bool {
    NORMALS.iter().any(|wanted| has_all(names, wanted))
}

fn has_all(names: &[&str], wanted: &[&str; 3]) -> bool {
    let has = |wanted: &&str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    wanted.iter().all(has)
}

/// The `count` normals in `columns`.
pub(in crate::io) fn normals(columns: &[Column<'_>], count: usize) -> Result<Vec<[f32; 3]>, Fault> {
    let find = |name: &&str| columns.iter().find(|column| column.name.eq_ignore_ascii_case(name));
    let find_all = |[x, y, z]: &[&str; 3]| Some([find(x)?, find(y)?, find(z)?]);
    let axes = NORMALS
        .iter()
        .find_map(find_all)
        .ok_or_else(|| Fault::header("missing normals: expected nx, ny and nz, or normal_x, normal_y and normal_z"))?;
    let [x, y, z] = axes.map(|axis| axis.to_f32(count));
    Ok((0..count).map(|row| [x[row], y[row], z[row]]).collect())
}
