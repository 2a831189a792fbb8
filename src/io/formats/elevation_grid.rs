//! Elevation grids as text: ESRI's ASCII grid (`.asc`, also of GDAL), GRASS' and Surfer's (`DSAA`).
//!
//! A cell with a value is a point: at the centre of the cell in ESRI's and GRASS', at a node in Surfer's. Cells of no
//! data are skipped, with their number as an assumption. Rows go from north to south, Surfer's from south to north.

use super::xyz;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{AxisConvention, Positions, RawCloud};
use crate::io::columns::numbers::{Tokens, quoted};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Magic, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use std::path::Path;

/// ESRI's ASCII grid, in the units of its map projection.
pub(in crate::io) const ESRI: Format = Format::new(&Traits {
    name: "ESRI ASCII grid",
    looks_like: Some(is_esri),
    convention: Some(AxisConvention::ZUp),
    ..Traits::PLAIN
});

/// Surfer's grid of text.
pub(in crate::io) const SURFER: Format = Format::new(&Traits {
    name: "Surfer grid",
    magic: &[Magic::start(b"DSAA")],
    convention: Some(AxisConvention::ZUp),
    ..Traits::PLAIN
});

/// The value of blank nodes, and all beyond.
const SURFER_BLANK: f64 = 1.7e38;

/// A grid of values.
struct Grid {
    columns: usize,
    rows: usize,
    /// The first value's place.
    start: [f64; 2],
    /// From a column, and from a row, to the next.
    step: [f64; 2],
    is_missing: Missing,
}

/// Values of cells without data.
enum Missing {
    Value(f64),
    From(f64),
}

/// Keywords at the start of a GRASS header.
const GRASS_WORDS: [&str; 6] = ["north:", "south:", "east:", "west:", "rows:", "cols:"];

/// True for a text that begins with the number of columns by name, or with an edge of GRASS.
fn is_esri(_: &Path, bytes: &[u8]) -> bool {
    let text = xyz::utf8(&bytes[..bytes.len().min(64)]);
    let start = text.trim_ascii_start().to_ascii_lowercase();
    if GRASS_WORDS.iter().any(|word| start.starts_with(word.as_bytes())) {
        return true;
    }
    let rest = start.strip_prefix(b"ncols").or_else(|| start.strip_prefix(b"nrows"));
    rest.is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_whitespace))
}

pub(in crate::io) fn decode_esri(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<RawCloud, Fault> {
    let text = xyz::utf8(bytes);
    let decimal = with_points_in_grid(&text);
    let text = decimal.as_deref().unwrap_or(&text);
    let mut header = EsriHeader::default();
    let mut tokens = Tokens::new(text, 1);
    let mut values = tokens.clone();
    while let Some(word) = tokens.next() {
        // The first token that is a number is the first value.
        if !word[0].is_ascii_alphabetic() || crate::io::columns::numbers::parse_number(word).is_some() {
            break;
        }
        let value = tokens.next_number();
        let Some(Ok(value)) = value else {
            let problem = format!("{} has no number behind it: the grid is truncated", quoted(word));
            return Err(Fault::new(Place::Line(tokens.line()), problem));
        };
        header.take(word, value, tokens.line())?;
        values = tokens.clone();
    }
    let grid = header.grid()?;
    let copied = if decimal.is_some() { text.len() } else { 0 };
    grid.read(&mut values, text.len(), &options.holding(copied), progress)
}

/// Returns a grid with decimal points instead of decimal commas: each comma is between digits, and some line of the
/// header has one. In a list of values commas are separators.
fn with_points_in_grid(text: &[u8]) -> Option<Vec<u8>> {
    let is_decimal = |word: &[u8]| {
        let commas = word.split(|&byte| byte == b',').count() - 1;
        let is_between = word
            .windows(3)
            .any(|three| three[1] == b',' && three[0].is_ascii_digit() && three[2].is_ascii_digit());
        commas == 0 || (commas == 1 && is_between)
    };
    let mut words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    if !text.contains(&b',') || text.contains(&b'.') || !words.all(is_decimal) {
        return None;
    }
    Some(
        text.iter()
            .map(|&byte| if byte == b',' { b'.' } else { byte })
            .collect(),
    )
}

/// Values of the header by their names.
#[derive(Default)]
struct EsriHeader {
    columns: Option<f64>,
    rows: Option<f64>,
    corner: [Option<f64>; 2],
    centre: [Option<f64>; 2],
    cell: [Option<f64>; 2],
    /// North, south, east and west of GRASS.
    edges: [Option<f64>; 4],
    no_data: Option<f64>,
}

impl EsriHeader {
    fn take(&mut self, word: &[u8], value: f64, line: usize) -> Result<(), Fault> {
        let field = match word.to_ascii_lowercase().as_slice() {
            b"ncols" | b"cols:" => &mut self.columns,
            b"nrows" | b"rows:" => &mut self.rows,
            b"xllcorner" => &mut self.corner[0],
            b"yllcorner" => &mut self.corner[1],
            b"xllcenter" => &mut self.centre[0],
            b"yllcenter" => &mut self.centre[1],
            b"dx" => &mut self.cell[0],
            b"dy" => &mut self.cell[1],
            b"cellsize" => {
                self.cell = [Some(value); 2];
                return Ok(());
            }
            b"north:" => &mut self.edges[0],
            b"south:" => &mut self.edges[1],
            b"east:" => &mut self.edges[2],
            b"west:" => &mut self.edges[3],
            b"nodata_value" | b"nodata" | b"null:" => &mut self.no_data,
            _ => {
                let problem = format!(
                    "found {}, expected a line of the header of a grid or values",
                    quoted(word)
                );
                return Err(Fault::new(Place::Line(line), problem));
            }
        };
        *field = Some(value);
        Ok(())
    }

    fn grid(&self) -> Result<Grid, Fault> {
        let missing = |name: &str| Fault::header(format!("the header of the grid has no {name}"));
        let columns = count_of(self.columns.ok_or_else(|| missing("ncols"))?, "ncols")?;
        let rows = count_of(self.rows.ok_or_else(|| missing("nrows"))?, "nrows")?;
        if let [Some(north), Some(south), Some(east), Some(west)] = self.edges {
            let step = [
                (east - west) / columns.max(1) as f64,
                (south - north) / rows.max(1) as f64,
            ];
            return Ok(Grid {
                columns,
                rows,
                start: [west + 0.5 * step[0], north + 0.5 * step[1]],
                step,
                is_missing: Missing::Value(self.no_data.unwrap_or(f64::NAN)),
            });
        }
        let [Some(width), Some(height)] = self.cell else {
            return Err(missing("cellsize"));
        };
        let mut start = [0.0; 2];
        for (axis, step) in [width, height].into_iter().enumerate() {
            start[axis] = match (self.centre[axis], self.corner[axis]) {
                (Some(centre), _) => centre,
                (None, Some(corner)) => corner + 0.5 * step,
                (None, None) => return Err(missing(["xllcorner", "yllcorner"][axis])),
            };
        }
        start[1] += height * (rows.max(1) - 1) as f64;
        Ok(Grid {
            columns,
            rows,
            start,
            step: [width, -height],
            // The default of GIS programs if the line is missing.
            is_missing: Missing::Value(self.no_data.unwrap_or(-9999.0)),
        })
    }
}

fn count_of(number: f64, name: &str) -> Result<usize, Fault> {
    const MAX_CELLS: f64 = 1e9;
    if number.fract() == 0.0 && (0.0..=MAX_CELLS).contains(&number) {
        return Ok(number as usize);
    }
    Err(Fault::header(format!("{name} is {number}, expected a number of cells")))
}

pub(in crate::io) fn decode_surfer(
    bytes: &[u8],
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, Fault> {
    let mut tokens = Tokens::new(bytes, 1);
    tokens.next();
    let mut header = [0.0; 8];
    for number in &mut header {
        *number = if let Some(Ok(found)) = tokens.next_number() {
            found
        } else {
            let problem = "expected two numbers of nodes and three ranges behind DSAA: the grid is truncated";
            return Err(Fault::new(Place::Line(tokens.line()), problem));
        };
    }
    let [columns, rows, west, east, south, north, _, _] = header;
    let (columns, rows) = (
        count_of(columns, "the number of columns")?,
        count_of(rows, "the number of rows")?,
    );
    let step = |low: f64, high: f64, count: usize| (high - low) / (count.max(2) - 1) as f64;
    let grid = Grid {
        columns,
        rows,
        start: [west, south],
        step: [step(west, east, columns), step(south, north, rows)],
        is_missing: Missing::From(SURFER_BLANK),
    };
    grid.read(&mut tokens, bytes.len(), options, progress)
}

impl Grid {
    /// The points of the values in `tokens`, which are at most `byte_count` bytes.
    fn read(
        &self,
        tokens: &mut Tokens<'_>,
        byte_count: usize,
        options: &ReadOptions,
        progress: &Progress,
    ) -> Result<RawCloud, Fault> {
        let cells = self.columns.checked_mul(self.rows);
        // Each value takes at least a digit and a space.
        let Some(cells) = cells.filter(|&cells| cells <= byte_count / 2 + 1) else {
            let problem = format!(
                "the grid has {} × {} cells, more than the file has values",
                self.columns, self.rows
            );
            return Err(Fault::header(problem));
        };
        options.claim_entries(&format!("{cells} cells"), cells, size_of::<[f64; 3]>())?;
        let mut points = Vec::with_capacity(cells);
        let mut missing = 0;
        for row in 0..self.rows {
            crate::io::columns::numbers::note_row(row, self.rows, progress)?;
            for column in 0..self.columns {
                let value = match tokens.next_number() {
                    Some(Ok(value)) => value,
                    // The notation of GRASS for cells without data.
                    Some(Err(b"*")) => f64::NAN,
                    Some(Err(word)) => {
                        let problem = format!("found {}, expected a number", quoted(word));
                        return Err(Fault::new(Place::Line(tokens.line()), problem));
                    }
                    None => {
                        let found = row * self.columns + column;
                        let problem =
                            format!("the file ends here, {found} of {cells} values are there: it is truncated");
                        return Err(Fault::new(Place::Line(tokens.line()), problem));
                    }
                };
                let is_missing = match self.is_missing {
                    Missing::Value(none) => value == none,
                    Missing::From(min) => value >= min,
                };
                if is_missing || value.is_nan() {
                    missing += 1;
                    continue;
                }
                let x = self.start[0] + self.step[0] * column as f64;
                let y = self.start[1] + self.step[1] * row as f64;
                points.push([x, y, value]);
            }
        }
        let mut cloud = RawCloud::from_positions(Positions::F64(points));
        if missing > 0 {
            let value = match self.is_missing {
                Missing::Value(none) => format!("{none}"),
                Missing::From(min) => format!("{min:e} and beyond"),
            };
            cloud.assumptions.push(
                Assumption::new(
                    Subject::NoData,
                    format!("{value}: {missing} of {cells} cells are skipped"),
                    "the grid says so",
                    Evidence::File,
                )
                .with_option(None),
            );
        }
        Ok(cloud)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(cloud: &RawCloud) -> Vec<[f64; 3]> {
        (0..cloud.positions.len())
            .map(|index| cloud.positions.get(index).to_array())
            .collect()
    }

    #[test]
    fn rows_of_esri_go_south_and_those_of_surfer_north() {
        let esri = "ncols 2\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n1 2\n3 -1\n";
        let cloud = decode_esri(esri.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap();
        assert_eq!(
            points(&cloud),
            [[105.0, 215.0, 1.0], [115.0, 215.0, 2.0], [105.0, 205.0, 3.0]]
        );
        assert_eq!(cloud.assumptions[0].value, "-1: 1 of 4 cells are skipped");
        let centre = "NCOLS 2 NROWS 1 XLLCENTER 0 YLLCENTER 5 DX 2 DY 1\n1 -9999\n";
        let cloud = decode_esri(centre.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap();
        assert_eq!(points(&cloud), [[0.0, 5.0, 1.0]]);
        let grass = "north: 20\nsouth: 0\neast: 30\nwest: 10\nrows: 2\ncols: 2\n1 2\n3 *\n";
        assert!(is_esri(Path::new("a.asc"), grass.as_bytes()));
        let cloud = decode_esri(grass.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap();
        assert_eq!(points(&cloud), [[15.0, 15.0, 1.0], [25.0, 15.0, 2.0], [15.0, 5.0, 3.0]]);
        let commas = "ncols 2\nnrows 1\nxllcorner 0,5\nyllcorner 0,5\ncellsize 1\n1,25 2,5\n";
        let cloud = decode_esri(commas.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap();
        assert_eq!(points(&cloud), [[1.0, 1.0, 1.25], [2.0, 1.0, 2.5]]);
        let surfer = "DSAA\n2 2\n0 10\n0 5\n1 4\n1 2\n1.70141e+38 4\n";
        let cloud = decode_surfer(surfer.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap();
        assert_eq!(points(&cloud), [[0.0, 0.0, 1.0], [10.0, 0.0, 2.0], [10.0, 5.0, 4.0]]);
    }

    #[test]
    fn invalid_grids_are_rejected_with_their_location() {
        for (text, expected) in [
            (
                "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n",
                "3 of 4 values",
            ),
            ("ncols 2\nnrows 2\ncellsize 1\n1 2 3 4\n", "no xllcorner"),
            (
                "ncols 1e9\nnrows 1e9\nxllcorner 0\nyllcorner 0\ncellsize 1\n1\n",
                "more than the file has",
            ),
            (
                "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 oops\n",
                "`oops`",
            ),
            ("ncols 2\nnrows\n", "no number behind"),
            ("ncols 2\nspeed 3\n", "`speed`"),
        ] {
            let fault = decode_esri(text.as_bytes(), &ReadOptions::default(), &Progress::default()).unwrap_err();
            assert!(fault.problem.contains(expected), "{fault:?}");
        }
        for end in 0..29 {
            let surfer = &b"DSAA\n2 2\n0 10\n0 5\n1 4\n1 2\n3 4\n"[..end];
            assert!(decode_surfer(surfer, &ReadOptions::default(), &Progress::default()).is_err());
        }
    }
}
