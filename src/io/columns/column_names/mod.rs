//! Names of columns → roles: coordinates, colours and normals under the names that other programs give them.
//!
//! **How it works.** A name is taken apart into words: `Points_m_XYZ:0` is `points m xyz 0`, `posX` is `pos x`. One of
//! the words, or a suffix of a known word, is an axis; the others are the *stem*. Three columns of one stem with the
//! three axes are a triple. A bare stem (`x`) is taken before one of known words (`pos_x`, `Points:0`), these before
//! surveyors' names (`Easting`), and these before unknown words (`head_x`), which count only if there is nothing else
//! and they are not a vector of another kind (`vel_x`). Longitude and latitude come last. Units are in brackets or the
//! last word.

use crate::cloud::LengthUnit;

/// Words that say nothing but that a column is a coordinate.
const COORDINATE_WORDS: &[&str] = &[
    "point",
    "points",
    "pt",
    "pts",
    "p",
    "pos",
    "position",
    "positions",
    "coord",
    "coords",
    "coordinate",
    "coordinates",
    "koordinate",
    "loc",
    "location",
    "locations",
    "vertex",
    "vertices",
    "xyz",
    "cart",
    "cartesian",
    "utm",
    "ecef",
    "enu",
    "world",
    "global",
    "local",
    "map",
    "translation",
    "t",
    "center",
    "centre",
    "centroid",
    "field",
    "0",
    "1",
];

/// Words before or behind an axis without anything in between, as in `Xcoord` and `posx`.
const GLUED_WORDS: &[&str] = &["coordinate", "coord", "position", "point", "pos", "pt", "loc", "p", "t"];

/// Words of vectors that are not coordinates.
const OTHER_VECTORS: &[&str] = &[
    "v",
    "vel",
    "velocity",
    "velocities",
    "speed",
    "n",
    "normal",
    "normals",
    "norm",
    "a",
    "acc",
    "accel",
    "acceleration",
    "f",
    "force",
    "forces",
    "omega",
    "w",
    "rot",
    "rotation",
    "q",
    "quat",
    "quaternion",
    "orientation",
    "angle",
    "euler",
    "gyro",
    "mag",
    "magnetic",
    "dir",
    "direction",
    "color",
    "colors",
    "colour",
    "colours",
    "rgb",
    "scale",
    "size",
    "std",
    "sigma",
    "err",
    "error",
    "cov",
    "grad",
    "gradient",
    "tex",
    "texture",
    "flow",
    "displacement",
    "delta",
    "momentum",
    "u",
    "uv",
    "scalar",
    "min",
    "max",
];

/// Surveyors' words for the three axes.
const SURVEY_WORDS: [&[&str]; 3] = [
    &["easting", "eastings", "east", "rechtswert", "ostwert", "e"],
    &["northing", "northings", "north", "hochwert", "nordwert", "n"],
    HEIGHT_WORDS,
];

const HEIGHT_WORDS: &[&str] = &[
    "z",
    "elevation",
    "elev",
    "height",
    "altitude",
    "alt",
    "up",
    "hoehe",
    "höhe",
    "level",
    "h",
];

const LONGITUDE_WORDS: &[&str] = &["lon", "long", "longitude", "lng"];
const LATITUDE_WORDS: &[&str] = &["lat", "latitude"];

/// Units of length as column names have them.
const UNITS: &[(LengthUnit, &[&str])] = &[
    (LengthUnit::Metre, &["m", "meter", "meters", "metre", "metres"]),
    (
        LengthUnit::Centimetre,
        &["cm", "centimeter", "centimeters", "centimetre", "centimetres"],
    ),
    (
        LengthUnit::Millimetre,
        &["mm", "millimeter", "millimeters", "millimetre", "millimetres"],
    ),
    (LengthUnit::Foot, &["ft", "foot", "feet"]),
    (LengthUnit::SurveyFoot, &["ftus", "usft", "us-ft"]),
];

/// Names of three colour channels and of alpha.
const COLORS: [[&str; 4]; 16] = [
    ["red", "green", "blue", "alpha"],
    ["r", "g", "b", "a"],
    ["rf", "gf", "bf", "af"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ["color_r", "color_g", "color_b", "color_a"],
    ["colour_r", "colour_g", "colour_b", "colour_a"],
    ["color_red", "color_green", "color_blue", "color_alpha"],
    ["colorr", "colorg", "colorb", "colora"],
    ["rgb_r", "rgb_g", "rgb_b", "rgb_a"],
    ["colr", "colg", "colb", "cola"],
    ["col_r", "col_g", "col_b", "col_a"],
    ["rouge", "vert", "bleu", "alpha"],
    ["rot", "grün", "blau", "alpha"],
    ["rot", "gruen", "blau", "alpha"],
    ["rojo", "verde", "azul", "alpha"],
    ["rosso", "verde", "blu", "alpha"],
];
const COLOR_STEMS: &[&str] = &["rgb", "rgba", "color", "colors", "colour", "colours"];
const COLOR_ROLES: [&str; 4] = ["red", "green", "blue", "alpha"];

const NORMALS: [[&str; 3]; 6] = [
    ["nx", "ny", "nz"],
    ["normal_x", "normal_y", "normal_z"],
    ["normals_x", "normals_y", "normals_z"],
    ["normalx", "normaly", "normalz"],
    ["norm_x", "norm_y", "norm_z"],
    ["n_x", "n_y", "n_z"],
];
const NORMAL_STEMS: &[&str] = &["normal", "normals", "n"];
const NORMAL_ROLES: [&str; 3] = ["nx", "ny", "nz"];

/// Match quality of the names of coordinates, surest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::io) enum Match {
    /// `x`, `y` and `z`.
    Plain,
    /// With words that say that they are coordinates.
    Known,
    /// Easting, northing and height.
    Survey,
    /// With a word of unknown meaning.
    Unknown,
    /// Longitude, latitude and height, in degrees.
    Geographic,
}

/// The columns of coordinates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::io) struct Axes {
    pub(in crate::io) columns: [usize; 3],
    pub(in crate::io) by: Match,
    /// The unit in their names.
    pub(in crate::io) unit: Option<LengthUnit>,
}

/// A name, taken apart.
pub(in crate::io) struct Words {
    pub(in crate::io) words: Vec<String>,
    unit: Option<LengthUnit>,
}

impl Words {
    pub(in crate::io) fn of(name: &str) -> Self {
        let name = unquoted(name);
        let (name, bracket) = split_bracket(name);
        let mut unit = bracket.and_then(unit_of);
        let mut words = words_of(name);
        // An index: `Points[0]`.
        if let Some(index) = bracket.filter(|index| index.len() == 1 && index.bytes().all(|byte| byte.is_ascii_digit()))
        {
            words.push(index.to_owned());
        }
        // `x_m` has its unit at the end, `Points_m_XYZ` within it.
        if words.len() > 1
            && let Some(place) = words.iter().rposition(|word| unit_of(word).is_some())
            && place > 0
        {
            unit = unit.or_else(|| unit_of(&words[place]));
            words.remove(place);
        }
        Self { words, unit }
    }

    /// The axis and the other words, joined.
    fn axis(&self) -> Option<(usize, Vec<&str>)> {
        let without = |place: usize| -> Vec<&str> {
            let others = self.words.iter().enumerate().filter(|(index, _)| *index != place);
            others.map(|(_, word)| word.as_str()).collect()
        };
        for (place, word) in self.words.iter().enumerate() {
            if let Some(axis) = axis_of(word) {
                return Some((axis, without(place)));
            }
        }
        for (place, word) in self.words.iter().enumerate() {
            for glued in GLUED_WORDS {
                let letter = word.strip_prefix(glued).or_else(|| word.strip_suffix(glued));
                if let Some(axis) = letter.and_then(axis_of) {
                    let mut stem = without(place);
                    stem.push(glued);
                    return Some((axis, stem));
                }
            }
        }
        None
    }

    /// The number behind words of `stems` and nothing else.
    fn index(&self, stems: &[&str]) -> Option<usize> {
        let (last, stem) = self.words.split_last()?;
        let is_stem = !stem.is_empty() && stem.iter().all(|word| stems.contains(&word.as_str()));
        (is_stem && last.len() == 1).then(|| last.parse().ok())?
    }
}

fn axis_of(word: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == word)
}

/// The unit of this symbol or word.
pub(in crate::io) fn unit_of(word: &str) -> Option<LengthUnit> {
    let word = word.trim().to_lowercase();
    let is = |(_, names): &&(LengthUnit, &[&str])| names.contains(&word.as_str());
    UNITS.iter().find(is).map(|(unit, _)| *unit)
}

/// A name without quotes and marks of comments.
fn unquoted(name: &str) -> &str {
    let name = name.trim_matches(['"', '\'', ' ', '\t']);
    name.trim_start_matches('#').trim_start_matches("//").trim()
}

/// Splits off the first bracket: returns the text before it and the text in it.
fn split_bracket(name: &str) -> (&str, Option<&str>) {
    match name.split_once(['(', '[', '{']) {
        Some((before, rest)) => {
            let inside = rest.split([')', ']', '}']).next().unwrap_or("").trim();
            // The whole name may be in brackets.
            if before.trim().is_empty() {
                (inside, None)
            } else {
                (before.trim(), Some(inside))
            }
        }
        None => (name, None),
    }
}

/// Words between other signs, at changes from small letters to capitals, and between letters and digits.
fn words_of(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<char> = None;
    for sign in name.chars() {
        let is_new = match before {
            Some(before) if before.is_alphanumeric() => {
                (before.is_lowercase() && sign.is_uppercase()) || before.is_ascii_digit() != sign.is_ascii_digit()
            }
            _ => true,
        };
        if sign.is_alphanumeric() {
            match words.last_mut().filter(|_| !is_new) {
                Some(word) => word.extend(sign.to_lowercase()),
                None => words.push(sign.to_lowercase().collect()),
            }
        }
        before = Some(sign);
    }
    words
}

/// A name for display and for scalars: without quotes, and without unit and remarks in brackets.
pub(in crate::io) fn plain_name(name: &str) -> &str {
    split_bracket(unquoted(name)).0
}

/// The columns of coordinates among `names`; `None` where no three of them are.
pub(in crate::io) fn axes(names: &[&str]) -> Option<Axes> {
    let words: Vec<Words> = names.iter().map(|name| Words::of(name)).collect();
    let found = cartesian(&words).or_else(|| survey(&words));
    let (columns, by) = found.or_else(|| unknown(&words)).or_else(|| geographic(&words))?;
    Some(Axes {
        columns,
        by,
        unit: words[columns[0]].unit,
    })
}

/// The columns of longitude and latitude.
pub(in crate::io) fn longitude_and_latitude(names: &[&str]) -> Option<[usize; 2]> {
    let words: Vec<Words> = names.iter().map(|name| Words::of(name)).collect();
    Some([with_word(&words, LONGITUDE_WORDS)?, with_word(&words, LATITUDE_WORDS)?])
}

type Found = ([usize; 3], Match);

/// Triples of one stem, in the order of their first columns.
fn triples(words: &[Words]) -> Vec<(Vec<&str>, [usize; 3])> {
    let mut stems: Vec<(Vec<&str>, [Option<usize>; 3])> = Vec::new();
    for (column, words) in words.iter().enumerate() {
        let Some((axis, stem)) = words.axis() else { continue };
        let place = stems.iter().position(|(known, _)| *known == stem);
        let place = place.unwrap_or_else(|| {
            stems.push((stem, [None; 3]));
            stems.len() - 1
        });
        stems[place].1[axis].get_or_insert(column);
    }
    let complete = |(stem, [x, y, z]): (_, [Option<usize>; 3])| Some((stem, [x?, y?, z?]));
    stems.into_iter().filter_map(complete).collect()
}

/// The columns of several markers in a row, named alike but for a number: `x0 y0 z0 x1 y1 z1 …`, `marker2_x …`. None
/// where the names describe one point, or few without a column of frames or times.
pub(in crate::io) fn markers(names: &[&str]) -> Vec<[usize; 3]> {
    const MIN_WITH_FRAMES: usize = 3;
    /// Three may be the corners of a triangle, four of a tetrahedron.
    const MIN: usize = 5;
    const FRAME_WORDS: [&str; 6] = ["frame", "frames", "time", "timestamp", "t", "step"];
    let words: Vec<Words> = names.iter().map(|name| Words::of(name)).collect();
    let is_number = |word: &str| word.bytes().all(|byte| byte.is_ascii_digit());
    let text = |stem: &[&str]| -> Vec<String> {
        let others = stem.iter().filter(|word| !is_number(word));
        others.map(|word| (*word).to_owned()).collect()
    };
    let triples = triples(&words);
    let is_numbered = |stem: &[&str]| {
        stem.iter().any(|word| is_number(word)) && !stem.iter().any(|word| OTHER_VECTORS.contains(word))
    };
    let has_one = triples.iter().any(|(stem, _)| stem.is_empty());
    let Some((first, _)) = triples.iter().find(|(stem, _)| is_numbered(stem)).filter(|_| !has_one) else {
        return Vec::new();
    };
    let alike = triples
        .iter()
        .filter(|(stem, _)| is_numbered(stem) && text(stem) == text(first));
    let columns: Vec<[usize; 3]> = alike.map(|(_, columns)| *columns).collect();
    let is_frame = |words: &Words| {
        words
            .words
            .first()
            .is_some_and(|word| FRAME_WORDS.contains(&word.as_str()))
    };
    let min = if words.iter().any(is_frame) {
        MIN_WITH_FRAMES
    } else {
        MIN
    };
    if columns.len() < min { Vec::new() } else { columns }
}

fn cartesian(words: &[Words]) -> Option<Found> {
    let triples = triples(words);
    if let Some((_, columns)) = triples.iter().find(|(stem, _)| stem.is_empty()) {
        return Some((*columns, Match::Plain));
    }
    let is_known = |stem: &[&str]| stem.iter().all(|word| COORDINATE_WORDS.contains(word));
    let known = triples.iter().find(|(stem, _)| is_known(stem));
    let columns = known
        .map(|(_, columns)| *columns)
        .or_else(|| indexed(words, COORDINATE_WORDS));
    Some((columns?, Match::Known))
}

/// Three columns with numbers from 0 or 1 behind words of `stems`.
fn indexed(words: &[Words], stems: &[&str]) -> Option<[usize; 3]> {
    let column = |index: usize| words.iter().position(|words| words.index(stems) == Some(index));
    let first = usize::from(column(0).is_none());
    Some([column(first)?, column(first + 1)?, column(first + 2)?])
}

fn with_word(words: &[Words], wanted: &[&str]) -> Option<usize> {
    // Single letters mean an axis only if they are the whole name.
    let has = |words: &Words| {
        let is =
            |word: &String| wanted.contains(&word.as_str()) && (word.chars().count() > 1 || words.words.len() == 1);
        words.words.iter().any(is)
    };
    // Better matches first.
    let exact = |name: &&str| {
        words
            .iter()
            .position(|words| words.words.len() == 1 && words.words[0] == **name)
    };
    wanted.iter().find_map(exact).or_else(|| words.iter().position(has))
}

fn survey(words: &[Words]) -> Option<Found> {
    let plain = |axis: usize| words.iter().position(|words| words.axis() == Some((axis, Vec::new())));
    let [east, north, height] = SURVEY_WORDS.map(|wanted| with_word(words, wanted));
    let horizontal = match (east, north) {
        (Some(east), Some(north)) => [east, north],
        _ => [plain(0)?, plain(1)?],
    };
    // A single u means up only next to east and north: elsewhere it is a velocity.
    let up = east.zip(north).and_then(|_| with_word(words, &["u"]));
    let columns = [horizontal[0], horizontal[1], plain(2).or(height).or(up)?];
    Some((columns, Match::Survey))
}

/// The only triple whose words are unknown, unless they say that it is another vector.
fn unknown(words: &[Words]) -> Option<Found> {
    let mut triples = triples(words);
    triples.retain(|(stem, _)| !stem.iter().any(|word| OTHER_VECTORS.contains(word)));
    match triples.as_slice() {
        [(_, columns)] => Some((*columns, Match::Unknown)),
        _ => None,
    }
}

fn geographic(words: &[Words]) -> Option<Found> {
    let longitude = with_word(words, LONGITUDE_WORDS)?;
    let latitude = with_word(words, LATITUDE_WORDS)?;
    let height = with_word(words, HEIGHT_WORDS)?;
    Some(([longitude, latitude, height], Match::Geographic))
}

/// The roles of colours and normals among `names`, by column.
pub(in crate::io) fn colors_and_normals(names: &[&str]) -> Vec<(usize, &'static str)> {
    let words: Vec<Words> = names.iter().map(|name| Words::of(name)).collect();
    let plain: Vec<String> = names
        .iter()
        .map(|name| plain_name(name).to_lowercase().replace([' ', '.'], "_"))
        .collect();
    let find = |wanted: &str| plain.iter().position(|name| name == wanted);
    let all = |wanted: &[&str]| wanted.iter().map(|name| find(name)).collect::<Option<Vec<usize>>>();
    let mut roles = Vec::new();
    let color = COLORS
        .iter()
        .find_map(|names| Some((all(&names[..3])?, find(names[3]))));
    let color = color.or_else(|| {
        let alpha = words.iter().position(|words| words.index(COLOR_STEMS) == Some(3));
        Some((indexed(&words, COLOR_STEMS)?.to_vec(), alpha))
    });
    if let Some((channels, alpha)) = color {
        roles.extend(channels.into_iter().chain(alpha).zip(COLOR_ROLES));
    }
    let normal = NORMALS.iter().find_map(|names| all(names));
    let normal = normal.or_else(|| indexed(&words, NORMAL_STEMS).map(|columns| columns.to_vec()));
    roles.extend(normal.into_iter().flatten().zip(NORMAL_ROLES));
    roles
}

#[cfg(test)]
mod tests;
