//! `--columns`: the columns that a user names.

use crate::locks::lock;
use std::fmt;
use std::str::FromStr;
use std::sync::Mutex;

/// Meaning of columns as a user gives it: their number, `7`, or their roles, `x=3,y=4,z=5,intensity=7`, or both,
/// `7:x=0,y=1,z=2`. Columns are counted from 0, or named as the header of the file names them.
///
/// Small and copied with the reading options: the same text is stored once.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct ColumnMap(&'static Parsed);

#[derive(Debug, PartialEq, Eq)]
struct Parsed {
    text: String,
    width: Option<usize>,
    roles: Vec<(String, ColumnName)>,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::io) enum ColumnName {
    /// Counted from 0.
    Index(usize),
    /// In the header of the file.
    Name(String),
}

impl fmt::Display for ColumnName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(formatter, "{index}"),
            Self::Name(name) => write!(formatter, "{name}"),
        }
    }
}

/// The role of the column whose values are frames.
pub(in crate::io) const FRAME_ROLE: &str = "frame";
/// Placeholder instead of a column: nothing has the role.
const NONE: &str = "none";
/// More values per point are not read.
const MAX_WIDTH: usize = 4096;
/// Other names of roles.
const SHORT_ROLES: [(&str, &str); 4] = [("r", "red"), ("g", "green"), ("b", "blue"), ("a", "alpha")];

/// Everything that was parsed: users give few.
static KNOWN: Mutex<Vec<&'static Parsed>> = Mutex::new(Vec::new());

impl ColumnMap {
    /// `width` values per point and nothing else.
    pub fn of_width(width: usize) -> Self {
        Self::interned(Parsed {
            text: width.to_string(),
            width: Some(width),
            roles: Vec::new(),
        })
    }

    fn interned(parsed: Parsed) -> Self {
        let mut known = lock(&KNOWN);
        if let Some(same) = known.iter().find(|known| known.text == parsed.text) {
            return Self(same);
        }
        let parsed: &'static Parsed = Box::leak(Box::new(parsed));
        known.push(parsed);
        Self(parsed)
    }

    /// Values per point, if given by the user.
    pub(in crate::io) fn width(self) -> Option<usize> {
        self.0.width
    }

    /// Roles with their columns.
    pub(in crate::io) fn roles(self) -> &'static [(String, ColumnName)] {
        &self.0.roles
    }

    /// The column of frames: `Some(None)` if there is to be none.
    #[expect(
        clippy::option_option,
        reason = "not said, said to be none, and a column are three answers"
    )]
    pub(in crate::io) fn frame(self) -> Option<Option<&'static ColumnName>> {
        let (_, column) = self.0.roles.iter().find(|(role, _)| role == FRAME_ROLE)?;
        let is_none = matches!(column, ColumnName::Name(name) if name == NONE);
        Some((!is_none).then_some(column))
    }
}

impl FromStr for ColumnMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = || {
            format!(
                "expected a number of columns from 3 to {MAX_WIDTH}, or which is what, such as \
                 x=3,y=4,z=5,intensity=7 (columns counted from 0, or their names)"
            )
        };
        let text = text.trim();
        let number = |text: &str| -> Result<usize, String> {
            let number = text.trim().parse().map_err(|_| expected())?;
            if (3..=MAX_WIDTH).contains(&number) {
                Ok(number)
            } else {
                Err(expected())
            }
        };
        if !text.contains('=') {
            return number(text).map(Self::of_width);
        }
        let starts_with_width = |(width, _): &(&str, &str)| width.bytes().all(|byte| byte.is_ascii_digit());
        let (width, pairs) = match text.split_once(':').filter(starts_with_width) {
            Some((width, pairs)) => (Some(number(width)?), pairs),
            None => (None, text),
        };
        let mut parsed = Parsed {
            text: text.to_owned(),
            width,
            roles: Vec::new(),
        };
        for pair in pairs.split(',').filter(|pair| !pair.trim().is_empty()) {
            let (role, column) = pair.split_once('=').ok_or_else(expected)?;
            let (role, column) = (role.trim(), column.trim());
            if role.is_empty() || column.is_empty() {
                return Err(expected());
            }
            if role == "n" {
                parsed.width = Some(number(column)?);
                continue;
            }
            let lower = role.to_lowercase();
            let known = SHORT_ROLES.iter().find(|(short, _)| *short == lower);
            let role = known.map_or(role, |(_, long)| long);
            let is_axis = ["x", "y", "z", FRAME_ROLE].contains(&lower.as_str());
            let role = if is_axis { lower } else { role.to_owned() };
            if parsed.roles.iter().any(|(known, _)| *known == role) {
                return Err(format!("{role} is given twice"));
            }
            let column = match column.parse::<usize>() {
                Ok(index) if index < MAX_WIDTH => ColumnName::Index(index),
                Ok(_) => return Err(expected()),
                Err(_) => ColumnName::Name(column.to_owned()),
            };
            parsed.roles.push((role, column));
        }
        let largest = parsed.roles.iter().filter_map(|(_, column)| match column {
            ColumnName::Index(index) => Some(*index),
            ColumnName::Name(_) => None,
        });
        if let (Some(width), Some(largest)) = (parsed.width, largest.max())
            && largest >= width
        {
            return Err(format!("column {largest} is not one of {width}, counted from 0"));
        }
        Ok(Self::interned(parsed))
    }
}

impl fmt::Display for ColumnMap {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0.text)
    }
}

impl fmt::Debug for ColumnMap {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "ColumnMap({})", self.0.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_maps_are_parsed() {
        let map: ColumnMap = "7".parse().unwrap();
        assert_eq!((map.width(), map.roles()), (Some(7), &[][..]));
        assert_eq!(map, ColumnMap::of_width(7));
        let map: ColumnMap = "9:x=3, y=4,z=5,r=6,Depth=lon m,frame=none".parse().unwrap();
        assert_eq!(map.width(), Some(9));
        assert_eq!(map.roles()[0], ("x".to_owned(), ColumnName::Index(3)));
        assert_eq!(map.roles()[3], ("red".to_owned(), ColumnName::Index(6)));
        assert_eq!(
            map.roles()[4],
            ("Depth".to_owned(), ColumnName::Name("lon m".to_owned()))
        );
        assert_eq!(map.frame(), Some(None));
        assert_eq!("n=7,x=0,y=1,z=2".parse::<ColumnMap>().unwrap().width(), Some(7));
        for wrong in ["", "2", "x", "x=", "=3", "3:x=3", "x=1,x=2", "5000", "x=1,y"] {
            assert!(wrong.parse::<ColumnMap>().is_err(), "{wrong}");
        }
    }
}
