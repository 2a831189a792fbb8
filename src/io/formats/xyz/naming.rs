//! Column roles, determined by the header line, by the user or by position.

use super::head::{Head, Header, names_fit, strs};
use super::leading::leading;
use super::rows::Kind;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::LengthUnit;
use crate::io::columns::column_map::{ColumnMap, ColumnName, FRAME_ROLE};
use crate::io::columns::column_names::{Match, axes, colors_and_normals, longitude_and_latitude, markers, plain_name};
use crate::io::error::{Fault, Place};

/// The meaning of columns before their values are examined.
#[derive(Debug)]
#[expect(
    clippy::option_option,
    reason = "not said, said to be none, and a column are three answers"
)]
pub(super) struct Naming {
    /// Names of all columns; `None` where they are determined by the values.
    pub(super) names: Option<Vec<String>>,
    pub(super) positions: [usize; 3],
    /// Coordinates are longitude and latitude in degrees, and height.
    pub(super) is_geographic: bool,
    /// The column whose values are frames, if given by the user: `Some(None)` for none.
    pub(super) frame: Option<Option<usize>>,
    /// The column that numbers the rows.
    pub(super) index: Option<usize>,
    /// Names of the columns before the coordinates, by their values.
    pub(super) leading: &'static [&'static str],
    /// Columns of the points of a row that has several.
    pub(super) markers: Vec<[usize; 3]>,
    pub(super) unit: Option<LengthUnit>,
    pub(super) assumptions: Vec<Assumption>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Naming {
    /// Determines the naming of a table with at least one row; `width` is the width of `head`, and rows follow lines
    /// that count them if they are `counted`.
    pub(super) fn of(head: &Head, width: usize, map: Option<ColumnMap>, is_counted: bool) -> Result<Self, Fault> {
        let raw = head.header.as_ref().and_then(|header| aligned(header, head, width));
        if let Some(map) = map.filter(|map| !map.roles().is_empty()) {
            let only_frames = map.roles().iter().all(|(role, _)| role == FRAME_ROLE);
            let names = raw.as_deref();
            let mut naming = if only_frames {
                Self::of(head, width, None, is_counted)
            } else {
                Self::of_map(map, names, head, width)
            }?;
            naming.frame = map
                .frame()
                .map(|column| column.map(|column| find(column, names, head, width)).transpose())
                .transpose()?;
            return Ok(naming);
        }
        let Some(raw) = raw else {
            return Self::of_values(head, is_counted);
        };
        let markers = markers(&strs(&raw));
        if let Some(first) = markers.first().copied() {
            return Ok(Self {
                names: Some(with_roles(&raw, first, &[])),
                markers,
                ..Self::of_columns(first)
            });
        }
        let Some(found) = axes(&strs(&raw)) else {
            let is_generic = raw.iter().enumerate().all(|(index, name)| is_generic(name, index));
            if is_generic {
                let index = raw.first().filter(|name| is_index_name(name)).map(|_| 0);
                return Self::of_places(head, index);
            }
            return Err(unmatched(&raw, head));
        };
        let mut naming = Self {
            is_geographic: found.by == Match::Geographic,
            index: raw.first().filter(|name| is_index_name(name)).map(|_| 0),
            unit: found.unit,
            ..Self::of_columns(found.columns)
        };
        let line = head.header.as_ref().map_or(1, |header| header.line);
        let named = found.columns.map(|column| raw[column].as_str()).join(", ");
        let evidence = match found.by {
            Match::Unknown => Evidence::Statistics,
            _ => Evidence::File,
        };
        let why = format!("the names in line {line}");
        naming.assume(Subject::Columns, format!("x y z are {named}"), why, evidence);
        if let Some(unit) = found.unit {
            let why = format!("line {line} names the columns {named}");
            naming.assume(Subject::Unit, unit.symbol(), why, Evidence::File);
        }
        if let Some(index) = naming.index {
            let why = "it has no name and numbers the rows".to_owned();
            let value = format!("column {index} is the index of the rows and is ignored");
            naming.assume(Subject::Columns, value, why, Evidence::File);
        }
        naming.names = Some(with_roles(&raw, naming.positions, &[]));
        Ok(naming)
    }

    fn assume(&mut self, subject: Subject, value: impl Into<String>, why: String, evidence: Evidence) {
        self.assumptions.push(Assumption::new(subject, value, why, evidence));
    }

    /// Coordinates in these columns, and nothing else.
    fn of_columns(positions: [usize; 3]) -> Self {
        Self {
            names: None,
            positions,
            is_geographic: false,
            frame: None,
            index: None,
            leading: &[],
            markers: Vec::new(),
            unit: None,
            assumptions: Vec::new(),
        }
    }

    /// The first three columns of numbers are coordinates, behind those that cannot be by their values.
    fn of_values(head: &Head, is_counted: bool) -> Result<Self, Fault> {
        let Some(leading) = leading(head, is_counted) else {
            return Self::of_places(head, None);
        };
        let first = leading.names.len();
        Ok(Self {
            index: leading.is_index.then_some(0),
            leading: leading.names,
            assumptions: vec![leading.assumption],
            ..Self::of_columns([first, first + 1, first + 2])
        })
    }

    /// The first three columns of numbers are coordinates.
    fn of_places(head: &Head, index: Option<usize>) -> Result<Self, Fault> {
        let numbers = head
            .kinds
            .iter()
            .enumerate()
            .filter(|(column, kind)| **kind == Kind::Number && Some(*column) != index);
        let mut numbers = numbers.map(|(column, _)| column);
        let (Some(x), Some(y), Some(z)) = (numbers.next(), numbers.next(), numbers.next()) else {
            return Err(Fault::new(
                Place::Line(head.line_count + 1),
                "fewer than three columns hold numbers: expected x y z and what follows them",
            ));
        };
        Ok(Self {
            index,
            ..Self::of_columns([x, y, z])
        })
    }

    fn of_map(map: ColumnMap, raw: Option<&[String]>, head: &Head, width: usize) -> Result<Self, Fault> {
        let by_place = || {
            (0..width)
                .map(|column| format!("value_{}", column + 1))
                .collect::<Vec<String>>()
        };
        let names = raw.map_or_else(by_place, <[String]>::to_vec);
        let mut roles = Vec::new();
        for (role, column) in map.roles().iter().filter(|(role, _)| role != FRAME_ROLE) {
            roles.push((find(column, raw, head, width)?, role.as_str()));
        }
        let of_header = raw.and_then(|raw| axes(&strs(raw)));
        let of_axis = |axis: usize| {
            let given = roles.iter().find(|(_, role)| *role == AXES[axis]);
            let found = given
                .map(|(column, _)| *column)
                .or_else(|| of_header.as_ref().map(|axes| axes.columns[axis]));
            // A mapping of other columns leaves the coordinates where they are.
            let has_axes = roles.iter().any(|(_, role)| AXES.contains(role));
            found
                .or((!has_axes && raw.is_none()).then_some(axis))
                .ok_or_else(|| Fault::header(format!("--columns {map} does not say which column is {}", AXES[axis])))
        };
        let positions = [of_axis(0)?, of_axis(1)?, of_axis(2)?];
        let given = |axis: &str| roles.iter().any(|(_, role)| *role == axis);
        let by_header = of_header.filter(|_| !AXES.iter().any(|axis| given(axis)));
        let mut naming = Self {
            names: Some(with_roles(&names, positions, &roles)),
            is_geographic: by_header.is_some_and(|axes| axes.by == Match::Geographic),
            ..Self::of_columns(positions)
        };
        let degrees = raw.and_then(|raw| longitude_and_latitude(&strs(raw)));
        if !naming.is_geographic
            && let Some([longitude, latitude]) = degrees
            && positions.contains(&longitude)
            && positions.contains(&latitude)
        {
            let why = "--columns takes longitude and latitude as coordinates".to_owned();
            naming.assume(
                Subject::Projection,
                "none: degrees as they are",
                why,
                Evidence::Convention,
            );
        }
        Ok(naming)
    }
}

/// The names of `width` columns; `None` where the line cannot be theirs.
fn aligned(header: &Header, head: &Head, width: usize) -> Option<Vec<String>> {
    let mut names = header.names.clone();
    let last = axes(&strs(&names)).map(|axes| axes.columns.into_iter().max().unwrap_or(0));
    if !names_fit(names.len(), width) && last.is_none_or(|last| last >= width) {
        return None;
    }
    // R has row names, but no name for their column.
    let numbers_rows = names.len() + 1 == width && head.first_is_index;
    if numbers_rows {
        names.insert(0, String::new());
    }
    names.truncate(width);
    while names.len() < width {
        names.push(format!("value_{}", names.len() + 1));
    }
    Some(names)
}

/// The names that a cloud knows: roles of coordinates, colours and normals, and plain names of the others, all
/// different. `given` roles override the names in the file.
fn with_roles(raw: &[String], positions: [usize; 3], given: &[(usize, &str)]) -> Vec<String> {
    let mut roles: Vec<Option<&str>> = vec![None; raw.len()];
    for (column, role) in colors_and_normals(&strs(raw)) {
        roles[column] = Some(role);
    }
    for (column, role) in given {
        for other in roles.iter_mut().filter(|other| **other == Some(*role)) {
            *other = None;
        }
        roles[*column] = Some(role);
    }
    for (column, role) in positions.into_iter().zip(AXES) {
        roles[column] = Some(role);
    }
    let mut names: Vec<String> = Vec::new();
    for (column, name) in raw.iter().enumerate() {
        let plain = match plain_name(name) {
            "" => format!("value_{}", column + 1),
            plain => plain.to_owned(),
        };
        // The names of coordinates that are not used as such must not be confused with the ones that are.
        let is_taken = |name: &str| {
            let known = names.iter().any(|other| other.eq_ignore_ascii_case(name));
            known || roles.iter().flatten().any(|role| role.eq_ignore_ascii_case(name))
        };
        let numbered = (2..).map(|number| format!("{plain}_{number}"));
        let mut free = std::iter::once(plain.clone())
            .chain(numbered)
            .filter(|name| !is_taken(name));
        let name = match roles[column] {
            Some(role) => role.to_owned(),
            None => free.next().unwrap_or(plain),
        };
        names.push(name);
    }
    names
}

/// The place of a column that the user names.
fn find(column: &ColumnName, raw: Option<&[String]>, head: &Head, width: usize) -> Result<usize, Fault> {
    let found = match column {
        ColumnName::Index(index) => Some(*index).filter(|index| *index < width),
        ColumnName::Name(name) => raw.and_then(|names| place_of(name, names)),
    };
    found.ok_or_else(|| no_column(column, raw, head, width))
}

fn place_of(name: &str, names: &[String]) -> Option<usize> {
    let exact = names.iter().position(|known| known.eq_ignore_ascii_case(name));
    exact.or_else(|| {
        names
            .iter()
            .position(|known| plain_name(known).eq_ignore_ascii_case(name))
    })
}

fn is_index_name(name: &str) -> bool {
    name.is_empty() || name.eq_ignore_ascii_case("unnamed: 0")
}

/// True for names that programs give to columns without any: `V1`, `col0`, `3`.
fn is_generic(name: &str, column: usize) -> bool {
    const STEMS: [&str; 12] = [
        "", "v", "c", "col", "column", "field", "f", "var", "attr", "value", "unnamed", "feature",
    ];
    let name = plain_name(name).to_lowercase();
    let stem = name.trim_end_matches(|sign: char| sign.is_ascii_digit());
    let number = name[stem.len()..].parse::<usize>();
    let stem = stem.trim_end_matches(['_', ' ', ':', '-']);
    (column == 0 && is_index_name(&name)) || (number.is_ok() && STEMS.contains(&stem))
}

/// Names in a sentence; of many the first ones.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 40;
    let shown: Vec<String> = names
        .iter()
        .take(SHOWN)
        .enumerate()
        .map(|(index, name)| format!("{index} {name}"))
        .collect();
    let more = if names.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", shown.join(", "))
}

fn unmatched(raw: &[String], head: &Head) -> Fault {
    let line = head.header.as_ref().map_or(1, |header| header.line);
    let found = listed(raw);
    let problem = if longitude_and_latitude(&strs(raw)).is_some() {
        format!(
            "the columns are {found}: longitude and latitude are projected to metres only with a height, altitude or \
             elevation next to them. Say which columns to take as they are, such as --columns x=0,y=1,z=2 (counted \
             from 0, or by name)"
        )
    } else {
        format!(
            "no three columns are named like x, y and z, the names are {found}: say which they are, such as --columns \
             x=0,y=1,z=2,intensity=3 (counted from 0, or by name)"
        )
    };
    Fault::new(Place::Line(line), problem)
}

fn no_column(column: &ColumnName, raw: Option<&[String]>, head: &Head, width: usize) -> Fault {
    let found = match raw {
        Some(raw) => format!("the columns are {}", listed(raw)),
        None => format!("there are {width} columns without names, counted from 0"),
    };
    let line = head.header.as_ref().map_or(head.line_count + 1, |header| header.line);
    Fault::new(
        Place::Line(line),
        format!("column {column} of --columns does not exist: {found}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn naming(text: &str, map: Option<&str>) -> Result<Naming, Fault> {
        let head = Head::read(text.as_bytes()).unwrap();
        let map = map.map(|map| map.parse().unwrap());
        Naming::of(&head, head.width.unwrap(), map, false)
    }

    #[test]
    fn column_names_become_roles() {
        for (text, expected) in [
            ("x,y,z,Rf,Gf,Bf\n1,2,3,1,1,1\n", "x y z red green blue"),
            ("id,pos_x,pos_y,pos_z\n1,2,3,4\n", "id x y z"),
            (
                "x,y,z,Points:0,Points:1,Points:2\n1,2,3,4,5,6\n",
                "x y z Points:0 Points:1 Points:2",
            ),
            ("\"x\" \"y\" \"z\"\n\"1\" 1 2 3\n\"2\" 1 2 3\n", "value_1 x y z"),
            ("X Y Z s (dB) s\n1 2 3 4 5\n", "x y z s s_2"),
            ("x y z\n1 2 3 4\n5 6 7 8\n", "x y z value_4"),
            (",x,y,z\n0,1,2,3\n", "value_1 x y z"),
        ] {
            let naming = naming(text, None).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"));
            assert_eq!(naming.names.unwrap().join(" "), expected, "{text:?}");
        }
        assert!(naming("V1,V2,V3\n1,2,3\n", None).unwrap().names.is_none());
        assert_eq!(naming(",0,1,2\n0,1.5,2,3\n", None).unwrap().positions, [1, 2, 3]);
    }

    #[test]
    fn unprojected_degrees_chosen_by_the_user_are_reported() {
        let text = "Longitude,Latitude,Elevation\n8.5,47,400\n";
        let naming = naming(text, Some("x=Longitude,y=Latitude,z=Elevation")).unwrap();
        let [projection] = naming.assumptions.as_slice() else {
            panic!("{:?}", naming.assumptions)
        };
        assert_eq!(projection.value, "none: degrees as they are");
        assert!(!naming.is_geographic);
    }

    #[test]
    fn unknown_names_are_rejected_with_a_suggestion() {
        for (text, expected) in [
            ("a,b,c,d\n1,2,3,4\n", "0 a, 1 b, 2 c, 3 d"),
            (
                "# range azimuth elevation power\n1 2 3 4\n",
                "0 range, 1 azimuth, 2 elevation, 3 power",
            ),
            ("lon,lat,speed\n1,2,3\n", "projected to metres only with a height"),
        ] {
            let fault = naming(text, None).unwrap_err();
            assert!(
                fault.problem.contains(expected) && fault.problem.contains("--columns x=0"),
                "{fault:?}"
            );
        }
    }

    #[test]
    fn the_user_overrides_names() {
        for (text, map, expected) in [
            ("a,b,c,d\n1,2,3,4\n", "x=b,y=2,z=d", "a x y z"),
            ("1 2 3 4 5\n", "x=2,y=3,z=4,intensity=0", "intensity value_2 x y z"),
            ("x,y,z,w\n1,2,3,4\n", "x=w,y=x,z=y", "y z z_2 x"),
            ("x,y,z,w\n1,2,3,4\n", "intensity=w", "x y z intensity"),
        ] {
            let naming = naming(text, Some(map)).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"));
            assert_eq!(naming.names.unwrap().join(" "), expected, "{map}");
        }
        for map in ["x=5,y=1,z=2", "x=a,y=q,z=c", "x=0"] {
            assert!(naming("a,b,c,d\n1,2,3,4\n", Some(map)).is_err(), "{map}");
        }
    }
}
