//! All rows of a file, with the meaning of their columns.

use super::counted::{self, Counted};
use super::dialect::comment;
use super::divide::divide;
use super::frames::{Frame, Rows};
use super::guess::guessed_names;
use super::head::{Head, Header, count_of_points, names_in, strs};
use super::layout::plain;
use super::markers::unrolled;
use super::naming::Naming;
use super::parsed::Parsed;
use super::refusal::refuse;
use super::rows::{self, Kind, MAX_WORDS, Odd, ParsedRows};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{LengthUnit, Positions, RawCloud};
use crate::io::columns::attributes::is_reserved;
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::column_map::ColumnMap;
use crate::io::columns::column_names::axes;
use crate::io::columns::growing;
use crate::io::error::{Fault, Place};
use crate::io::files::utm::Zone;
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use std::borrow::Cow;
use std::path::Path;

/// Scalars per point that are read.
const MAX_SCALARS: usize = 256;

/// A parsed file.
#[derive(Debug, Default)]
pub(in crate::io) struct Table {
    columns: Vec<Column<'static>>,
    rows: usize,
    /// Empty where all rows are one cloud.
    pub(super) frames: Vec<Frame>,
    unit: Option<LengthUnit>,
    assumptions: Vec<Assumption>,
    warnings: Vec<String>,
}

impl Table {
    /// Opens the table of the file `name` with these `bytes`.
    pub(in crate::io) fn open(
        name: &Path,
        bytes: &[u8],
        options: &ReadOptions,
        progress: &Progress,
    ) -> Result<Self, Fault> {
        let plain = plain(bytes);
        let text = &plain.text;
        let counted = Counted::of(text)?;
        let copied = match text {
            Cow::Owned(text) => text.len(),
            Cow::Borrowed(_) => 0,
        };
        let counted_bytes = counted.as_ref().map_or(0, |counted| counted.text.len());
        let options = &options.holding(copied + counted_bytes);
        let body: &[u8] = counted.as_ref().map_or(text, |counted| &counted.text);
        let mut head = Head::read(body)?;
        let Some(width) = head.width else {
            return no_rows(&head, body);
        };
        if let Some(counted) = &counted {
            let comment = counted.blocks.first().map_or("", |block| &block.comment);
            let properties = counted::properties(comment);
            if let Some(properties) = properties.as_ref().filter(|names| names.len() != width) {
                let problem = format!(
                    "`Properties=` names {} columns ({}), but rows have {width}",
                    properties.len(),
                    properties.join(", ")
                );
                return Err(Fault::new(Place::Line(2), problem));
            }
            let names = properties.unwrap_or_else(|| names_in(comment.as_bytes(), head.dialect));
            let is_header = names.len() == width && axes(&strs(&names)).is_some();
            head.header = is_header.then_some(Header {
                names,
                line: 2,
                is_comment: true,
            });
        }
        let map: Option<ColumnMap> = options.columns;
        let mut naming = Naming::of(&head, width, map, counted.is_some())?;
        let is_named = |known: &str| {
            name.extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case(known))
        };
        let is_north_first = is_named("neu") && naming.names.is_none();
        if is_north_first {
            naming.positions.swap(0, 1);
        }
        let mut kinds = head.kinds.clone();
        for axis in naming.positions {
            if kinds[axis] != Kind::Number {
                let line = counted
                    .as_ref()
                    .map_or(head.line_count + 1, |counted| counted.line_of(1));
                let problem = format!("column {axis} (counted from 0) is to hold coordinates, and has words");
                return Err(Fault::new(Place::Line(line), problem));
            }
            kinds[axis] = Kind::Required;
        }
        progress.set(head.byte_count, body.len());
        let start = head.line_count + 1;
        let mut parsed = rows::parse(&body[head.byte_count..], start, &kinds, head.dialect, options, progress)?;
        if let Some(counted) = &counted {
            for odd in [&mut parsed.odd_lines, &mut parsed.odd_cells] {
                odd.first = odd.first.take().map(|(line, problem)| (counted.line_of(line), problem));
            }
        }
        if naming.names.is_none() && naming.leading.is_empty() {
            refuse(&parsed, &kinds, start)?;
        }
        let mut table = Self {
            rows: parsed.len(),
            warnings: plain.notes.iter().map(|note| (*note).to_owned()).collect(),
            unit: naming.unit,
            assumptions: naming.assumptions.clone(),
            ..Self::default()
        };
        table.check_lines(&mut parsed, &head, width)?;
        table.project(&mut parsed, &naming)?;
        let mut names = match &naming.names {
            Some(names) => names.clone(),
            None => table.guess(&parsed, &kinds, &naming, counted.is_some()),
        };
        if is_north_first {
            table.take_north_first(&mut names, &naming);
        }
        let line_of_names = head.header.as_ref().map(|header| header.line);
        let title = head.title.filter(|(line, _)| Some(*line) != line_of_names);
        let parsed = Parsed {
            title: title.map_or_else(String::new, |(_, title)| title),
            rows: parsed,
            names,
            raw_names: head.header.map_or_else(Vec::new, |header| header.names),
            naming,
            counted,
            is_one_cloud: is_named("pts"),
        };
        if !parsed.naming.markers.is_empty() {
            let (columns, frames) = unrolled(&parsed, &mut table.assumptions);
            table.rows *= parsed.naming.markers.len();
            table.columns = columns;
            table.frames = frames;
            return Ok(table);
        }
        table.frames = divide(&parsed, &mut table.assumptions, &mut table.warnings);
        table.take_columns(parsed, &kinds);
        Ok(table)
    }

    /// Skipped lines and missing values: said, and if there are many an error.
    fn check_lines(&mut self, parsed: &mut ParsedRows, head: &Head, width: usize) -> Result<(), Fault> {
        /// One in this many lines may be odd, or one alone if there are two rows.
        const ROWS_PER_ODD: usize = 10;
        let claimed = claimed_points(head.claimed, parsed, width);
        if let Some(claimed) = claimed.filter(|&claimed| claimed > self.rows + parsed.odd_lines.count) {
            return Err(cut_short(claimed, self.rows));
        }
        let odd = parsed.odd_lines.count;
        let is_allowed = odd == 0 || (odd == 1 && self.rows > 1) || odd * ROWS_PER_ODD <= self.rows;
        if !is_allowed && let Some(fault) = parsed.odd_lines.fault() {
            return Err(fault);
        }
        if let Some((line, problem)) = &parsed.odd_lines.first {
            let others = match odd {
                1 => "this line is skipped".to_owned(),
                odd => format!("this line and {} more are skipped", odd - 1),
            };
            self.warnings.push(format!("line {line}: {problem}: {others}"));
        }
        if let Odd {
            count,
            first: Some((line, problem)),
        } = &parsed.odd_cells
        {
            let cells = if *count == 1 {
                "this value is"
            } else {
                "such values are"
            };
            self.warnings
                .push(format!("line {line}: {problem}: {cells} missing ({count} in all)"));
        }
        Ok(())
    }

    /// Longitude and latitude become metres.
    fn project(&mut self, parsed: &mut ParsedRows, naming: &Naming) -> Result<(), Fault> {
        if !naming.is_geographic || self.rows == 0 {
            return Ok(());
        }
        let [longitude, latitude, _] = naming.positions;
        let places = (0..self.rows).map(|row| [longitude, latitude].map(|column| parsed.columns[column][row]));
        let Some(zone) = Zone::of_center(places) else {
            return Ok(());
        };
        for row in 0..self.rows {
            let [east, north] = [longitude, latitude].map(|column| parsed.columns[column][row]);
            if east.is_nan() || north.is_nan() {
                continue;
            }
            if !Zone::are_degrees(east, north) {
                return Err(Fault::entry(
                    "point",
                    row,
                    format!(
                        "longitude {east} and latitude {north} are not degrees: say which columns to take as they \
                         are, such as --columns x={longitude},y={latitude},z={}",
                        naming.positions[2]
                    ),
                ));
            }
            let [x, y] = zone
                .project_near(east, north)
                .map_err(|problem| Fault::entry("point", row, problem))?;
            parsed.columns[longitude][row] = x;
            parsed.columns[latitude][row] = y;
        }
        self.unit = self.unit.or(Some(LengthUnit::Metre));
        let projection = Assumption::new(
            Subject::Projection,
            format!("UTM zone {zone}, metres"),
            "the columns are longitude and latitude in degrees, WGS 84 is supposed",
            Evidence::Fallback,
        );
        self.assumptions.push(projection);
        Ok(())
    }

    /// North, east and up, as files with this name have them.
    fn take_north_first(&mut self, names: &mut [String], naming: &Naming) {
        let [east, north, _] = naming.positions;
        names.swap(east, north);
        self.assumptions
            .retain(|assumption| assumption.subject != Subject::Columns);
        let [x, y, z] = naming.positions;
        let value = format!("x y z are columns {x}, {y} and {z}");
        let why = "files named .neu have north, east and up";
        let columns = Assumption::new(Subject::Columns, value, why, Evidence::Convention);
        self.assumptions.push(columns);
    }

    /// Names by values, where the file has none.
    fn guess(&mut self, parsed: &ParsedRows, kinds: &[Kind], naming: &Naming, is_counted: bool) -> Vec<String> {
        let is_words = |column: usize| matches!(kinds[column], Kind::Text | Kind::Time | Kind::Hex);
        let first = naming.leading.len();
        let is_asked = |column: &usize| *column >= first && !is_words(*column) && Some(*column) != naming.index;
        let numbers: Vec<usize> = (0..kinds.len()).filter(is_asked).collect();
        let values: Vec<Vec<f64>> = numbers.iter().map(|&column| parsed.columns[column].clone()).collect();
        let guessed = guessed_names(&values);
        let is_molecule = is_counted && kinds[0] == Kind::Text;
        let mut names: Vec<String> = Vec::new();
        let mut free = guessed.into_iter();
        for (column, kind) in kinds.iter().enumerate() {
            let name = match kind {
                _ if column < first => unique(naming.leading[column], &names),
                Kind::Hex => unique("color", &names),
                Kind::Text if is_molecule && column == 0 => "element".to_owned(),
                Kind::Text => unique("label", &names),
                Kind::Time => unique("time", &names),
                _ if Some(column) == naming.index => unique("index", &names),
                _ => free.next().unwrap_or_default(),
            };
            names.push(name);
        }
        if is_molecule {
            self.assumptions.push(Assumption::new(
                Subject::Columns,
                names.join(" "),
                "a count, a comment and rows that start with a word: a molecule in XYZ format",
                Evidence::Convention,
            ));
        } else if first > 0 && names.len() == first + 3 {
            // Everything has already been reported.
        } else if names.len() > 3 {
            let values_tell = first > 0 || names.iter().any(|name| ["red", "nx"].contains(&name.as_str()));
            let (why, evidence) = if values_tell {
                (
                    "the file does not name its columns, their values are like that",
                    Evidence::Statistics,
                )
            } else {
                ("the file does not name its columns", Evidence::Fallback)
            };
            self.assumptions
                .push(Assumption::new(Subject::Columns, names.join(" "), why, evidence));
        } else {
            let why = "the file does not name its columns: the first three";
            self.assumptions
                .push(Assumption::new(Subject::Columns, "x y z", why, Evidence::Convention));
        }
        names
    }

    /// Keeps the columns that points have.
    fn take_columns(&mut self, parsed: Parsed, kinds: &[Kind]) {
        let Parsed {
            rows, names, naming, ..
        } = parsed;
        let words = &rows.words;
        let missing =
            (0..self.rows).filter(|&row| naming.positions.iter().any(|&axis| rows.columns[axis][row].is_nan()));
        let missing = missing.count();
        if missing > 0 {
            self.warnings.push(format!(
                "{missing} of {} points have no coordinates (empty or NaN cells): they are missing points",
                self.rows
            ));
        }
        let is_sequence = self.frames.len() > 1;
        let is_channel = |name: &str| ["red", "green", "blue"].contains(&name);
        let channels = names.iter().zip(&rows.columns).filter(|(name, _)| is_channel(name));
        let full = channels
            .flat_map(|(_, values)| values.iter().copied())
            .fold(0.0, f64::max);
        let channels_named = names.iter().any(|name| is_channel(name));
        let mut dropped: Vec<String> = Vec::new();
        let mut scalars = 0;
        for (column, (name, mut values)) in names.into_iter().zip(rows.columns).enumerate() {
            if Some(column) == naming.index {
                continue;
            }
            if kinds[column] == Kind::Text {
                let words = &words[column];
                if words.len() > MAX_WORDS {
                    self.warnings.push(format!(
                        "column `{name}` holds words, more than {MAX_WORDS} different ones: it is ignored"
                    ));
                    continue;
                }
                let listed: Vec<String> = words
                    .iter()
                    .enumerate()
                    .map(|(code, word)| format!("{code} = {word}"))
                    .collect();
                self.assumptions.push(
                    Assumption::new(
                        Subject::Columns,
                        format!("`{name}`: words as numbers: {}", listed.join(", ")),
                        "in alphabetical order",
                        Evidence::Convention,
                    )
                    .with_option(None),
                );
            }
            if kinds[column] == Kind::Hex {
                self.take_hex_colors(&name, &values, channels_named);
                continue;
            }
            if !is_reserved(&name) {
                scalars += 1;
                if scalars > MAX_SCALARS {
                    dropped.push(name);
                    continue;
                }
            }
            let mut scalar = Scalar::F64;
            if is_sequence && is_channel(&name) {
                // Full intensity is determined over all frames.
                scalar = Scalar::U8;
                let factor = if full <= 1.0 {
                    255.0
                } else if full <= 255.0 {
                    1.0
                } else {
                    255.0 / 65_535.0
                };
                for value in &mut values {
                    *value *= factor;
                }
            }
            self.columns.push(Column {
                name,
                scalar,
                values: Values::Parsed(values),
            });
        }
        if let Some(first) = dropped.first() {
            self.warnings.push(format!(
                "{} columns from `{first}` on are ignored: {MAX_SCALARS} scalars per point are read",
                dropped.len()
            ));
        }
    }

    /// Channels of the colours in a column of hexadecimal digits, unless other columns are the colours.
    fn take_hex_colors(&mut self, name: &str, values: &[f64], has_channels: bool) {
        let has_colors = has_channels || self.columns.iter().any(|column| column.name == "red");
        if has_colors {
            self.warnings.push(format!(
                "column `{name}` holds colours, and others do as well: it is ignored"
            ));
            return;
        }
        let channels = ["red", "green", "blue", "alpha"];
        for (channel, name) in channels.into_iter().enumerate() {
            let of = |value: &f64| f64::from((*value as u32).to_be_bytes()[channel]);
            self.columns.push(Column {
                name: name.to_owned(),
                scalar: Scalar::U8,
                values: Values::Parsed(values.iter().map(of).collect()),
            });
        }
        let assumption = Assumption::new(
            Subject::Columns,
            format!("`{name}`: red, green and blue"),
            "its cells are colours in hexadecimal digits",
            Evidence::Convention,
        );
        self.assumptions.push(assumption);
    }

    /// Number of frames.
    pub(in crate::io) fn frame_count(&self) -> usize {
        self.frames.len().max(1)
    }

    /// One of the frames.
    pub(in crate::io) fn frame(&self, index: usize, options: &ReadOptions) -> Result<RawCloud, Fault> {
        if index >= self.frame_count() {
            return Err(Fault::header(format!(
                "frame {index} does not exist, only {} counted from 0: the file has changed since it was opened",
                self.frame_count()
            )));
        }
        let gathered = |rows: &Rows| -> Vec<Column<'static>> {
            let of = |column: &Column<'static>| {
                let values = match (&column.values, rows) {
                    (Values::Parsed(values), Rows::Range(range)) => values[range.clone()].to_vec(),
                    (Values::Parsed(values), Rows::List(rows)) => {
                        rows.iter().map(|&row| values[row as usize]).collect()
                    }
                    (Values::Packed { .. }, _) => Vec::new(),
                };
                Column {
                    name: column.name.clone(),
                    scalar: column.scalar,
                    values: Values::Parsed(values),
                }
            };
            self.columns.iter().map(of).collect()
        };
        let mut cloud = match self.frames.get(index) {
            Some(Frame { rows, .. }) if self.frames.len() > 1 => {
                let count = match rows {
                    Rows::Range(range) => range.len(),
                    Rows::List(rows) => rows.len(),
                };
                let all = self.columns.iter().map(Column::parsed_bytes).sum();
                let options = options.holding(all);
                options.claim_entries("the frame", count, size_of::<f64>() * self.columns.len())?;
                growing::cloud(&gathered(rows), count, &options)?
            }
            _ if self.columns.is_empty() => RawCloud::from_positions(Positions::F64(Vec::new())),
            _ => growing::cloud(&self.columns, self.rows, options)?,
        };
        cloud.unit = self.unit;
        cloud.assumptions.clone_from(&self.assumptions);
        // Warnings about lines belong to the file, not to one of its frames.
        if index == 0 {
            cloud.warnings.clone_from(&self.warnings);
        }
        Ok(cloud)
    }

    /// All of the file, or the first frame of several.
    pub(super) fn first(&self, options: &ReadOptions) -> Result<RawCloud, Fault> {
        let mut cloud = self.frame(0, options)?;
        if self.frames.len() > 1 {
            cloud.warnings.push(format!(
                "the file holds {} frames, of which this is the first: open it alone to see all",
                self.frames.len()
            ));
        }
        Ok(cloud)
    }
}

/// `name`, or with a number behind it if another column has it.
fn unique(name: &str, names: &[String]) -> String {
    let is_free = |name: &String| !names.contains(name);
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
    candidates.find(is_free).unwrap_or_default()
}

/// The cloud of a file without rows.
fn no_rows(head: &Head, text: &[u8]) -> Result<Table, Fault> {
    let lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let lines = lines.filter(|line| !line.is_empty() && comment(line).is_none()).count();
    let has_names = head
        .header
        .as_ref()
        .is_some_and(|header| axes(&strs(&header.names)).is_some());
    let known = usize::from(head.claimed.is_some()) + usize::from(has_names);
    match head.claimed {
        Some(claimed) if claimed > 0 => Err(cut_short(claimed, 0)),
        // A header alone, or a count of zero with or without a comment after it, is an empty cloud.
        _ if known > 0 && lines <= known + usize::from(head.claimed.is_some()) => Ok(Table::default()),
        _ => Err(Fault::new(
            Place::Line(1),
            "no line has numbers: expected x y z in columns",
        )),
    }
}

fn cut_short(claimed: usize, count: usize) -> Fault {
    Fault::entry(
        "point",
        count,
        format!("the file ends here, but its first line counts {claimed} points: it is truncated"),
    )
}

/// Points of all scans by the lone number before each: `.pts` files count their points there. Other lone numbers are
/// odd lines.
fn claimed_points(first: Option<usize>, rows: &mut ParsedRows, width: usize) -> Option<usize> {
    let mut claimed = first;
    for lone in std::mem::take(&mut rows.lones) {
        // A further count follows once all points of those before it are complete.
        match (claimed, count_of_points(lone.value)) {
            (Some(before), Some(count)) if lone.row > 0 && lone.row == before => {
                claimed = Some(before.saturating_add(count));
                rows.lones.push(lone);
            }
            _ => {
                let odd = &mut rows.odd_lines;
                odd.count += 1;
                if odd.first.as_ref().is_none_or(|(line, _)| *line > lone.line) {
                    odd.first = Some((lone.line, format!("found 1 numbers, expected {width}")));
                }
            }
        }
    }
    claimed
}
