//! Assumptions: everything the program decides for the user, with its evidence and how to change it.
//!
//! **How it works.** Code that decides something not given by a file (the x column in a reader, the up axis in the
//! initial view) makes an [`Assumption`]. Readers put theirs into `RawCloud::assumptions`, sources into
//! `Source::assumptions`; [`Assumptions`] merges equal ones of many frames. `info` lists all of them, the window shows
//! them as a list, and the other commands print those by [`Evidence::Statistics`] or [`Evidence::Fallback`] on stderr.
//! A new kind of assumption is a row of `SUBJECTS`.

use serde::{Serialize, Serializer};
use std::fmt;

/// Evidence for an assumption, strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// Stated by the file or a sidecar file.
    File,
    /// Files of the format are made so.
    Convention,
    /// The values of the data speak for it.
    Statistics,
    /// No evidence: most files are like that.
    Fallback,
}

impl Evidence {
    /// True if it may be wrong although the file is right: such assumptions are printed.
    pub fn is_guess(self) -> bool {
        self >= Self::Statistics
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Convention => "convention",
            Self::Statistics => "statistics",
            Self::Fallback => "fallback",
        }
    }
}

/// The subject of an assumption.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subject {
    /// The up axis.
    UpAxis,
    /// The unit of lengths.
    Unit,
    /// Depth values per metre.
    DepthScale,
    /// Intrinsics of a depth camera.
    Camera,
    /// Poses of cameras or sensors.
    Poses,
    /// The meaning of columns or arrays.
    Columns,
    /// The range of colour values: 8 or 16 bits.
    ColorDepth,
    /// The files, blocks or layers that are frames.
    Frames,
    /// Values of a missing point.
    NoData,
    /// The times of frames.
    FrameTimes,
    /// Points, surfels, a mesh.
    Primitive,
    /// Colour source of points.
    Colors,
    /// Points that a filter removed.
    FilteredPoints,
    /// Points that were merged.
    MergedPoints,
    /// Projection of geographic coordinates.
    Projection,
}

/// Name of a subject, and the option that changes it.
#[derive(Debug)]
struct Row {
    subject: Subject,
    key: &'static str,
    title: &'static str,
    /// The command-line option that changes it.
    option: Option<&'static str>,
    /// The control of the window that changes it.
    place: Option<&'static str>,
}

/// The list of the window that offers alternatives.
const IN_LIST: Option<&str> = Some("View > Assumptions");

/// One row per subject.
const SUBJECTS: [Row; 15] = [
    row(Subject::UpAxis, "up-axis", "up axis", Some("--up"), IN_LIST),
    row(Subject::Unit, "unit", "unit", None, None),
    row(
        Subject::DepthScale,
        "depth-scale",
        "depth scale",
        Some("--depth-scale"),
        IN_LIST,
    ),
    row(Subject::Camera, "camera", "camera", Some("--intrinsics"), IN_LIST),
    row(Subject::Poses, "poses", "poses", Some("--poses"), IN_LIST),
    row(Subject::Columns, "columns", "columns", Some("--columns"), IN_LIST),
    row(
        Subject::ColorDepth,
        "color-depth",
        "colour depth",
        Some("--color-depth"),
        IN_LIST,
    ),
    row(Subject::Frames, "frames", "frames", Some("--only"), IN_LIST),
    row(Subject::NoData, "no-data", "no-data values", Some("--no-data"), IN_LIST),
    row(
        Subject::FrameTimes,
        "frame-times",
        "frame times",
        Some("--fps"),
        IN_LIST,
    ),
    row(
        Subject::Primitive,
        "primitive",
        "primitive",
        Some("--primitive"),
        IN_LIST,
    ),
    row(Subject::Colors, "colors", "colours", Some("--colors"), IN_LIST),
    row(
        Subject::FilteredPoints,
        "filtered-points",
        "filtered points",
        Some("--rgbd-filters"),
        IN_LIST,
    ),
    row(
        Subject::MergedPoints,
        "merged-points",
        "merged points",
        Some("--merge-cells"),
        IN_LIST,
    ),
    row(
        Subject::Projection,
        "projection",
        "projection",
        Some("--columns"),
        IN_LIST,
    ),
];

const fn row(
    subject: Subject,
    key: &'static str,
    title: &'static str,
    option: Option<&'static str>,
    place: Option<&'static str>,
) -> Row {
    Row {
        subject,
        key,
        title,
        option,
        place,
    }
}

impl Subject {
    fn row(self) -> &'static Row {
        let row = SUBJECTS.iter().find(|row| row.subject == self);
        // A test ensures that every subject has a row.
        row.unwrap_or(&SUBJECTS[0])
    }

    /// Every subject.
    pub fn all() -> impl Iterator<Item = Self> {
        SUBJECTS.iter().map(|row| row.subject)
    }

    /// The command-line option that changes assumptions about it.
    pub fn option(self) -> Option<&'static str> {
        self.row().option
    }

    /// In JSON.
    pub fn key(self) -> &'static str {
        self.row().key
    }

    /// For people.
    pub fn title(self) -> &'static str {
        self.row().title
    }
}

impl Serialize for Subject {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

/// Something the program decided in a user's place.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Assumption {
    /// Its subject.
    #[serde(rename = "what")]
    pub subject: Subject,
    /// The decision, such as `+Z` or `x y z intensity`.
    pub value: String,
    /// The reason, a clause without a full stop.
    pub why: String,
    /// Strength of the evidence.
    pub evidence: Evidence,
    /// The command-line option that changes it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub option: Option<&'static str>,
    /// The control of the window that changes it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<&'static str>,
}

impl Assumption {
    /// With the option and the place in the window that change assumptions about `subject`.
    pub fn new(subject: Subject, value: impl Into<String>, why: impl Into<String>, evidence: Evidence) -> Self {
        let row = subject.row();
        Self {
            subject,
            value: value.into(),
            why: why.into(),
            evidence,
            option: row.option,
            window: row.place,
        }
    }

    /// Sets the option that changes this assumption; `None` where none changes it.
    #[must_use]
    pub fn with_option(self, option: Option<&'static str>) -> Self {
        let window = option.and(self.window);
        Self { option, window, ..self }
    }
}

impl Assumption {
    /// Returns true if one entry covers both assumptions: frames with the same no-data value have it a different number
    /// of times.
    fn is_of_same(&self, other: &Self) -> bool {
        let is_no_data = self.subject == Subject::NoData && other.subject == Subject::NoData;
        self == other || (is_no_data && self.value == other.value)
    }

    /// Returns true if the reason is the longer one, which among reasons with a count is that with the larger count: it
    /// has more digits, or larger ones.
    fn has_longer_why_than(&self, other: &Self) -> bool {
        (self.why.len(), &self.why) > (other.why.len(), &other.why)
    }
}

/// `up axis: +Z (the ground is a plane; statistics; change with --up)`.
impl fmt::Display for Assumption {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{}: {} ({}; {}",
            self.subject.title(),
            self.value,
            self.why,
            self.evidence.name()
        )?;
        match self.option {
            Some(option) => write!(formatter, "; change with {option})"),
            None => formatter.write_str(")"),
        }
    }
}

/// Distinct assumptions in the order in which they came up.
#[derive(Debug, Clone, Default)]
pub struct Assumptions {
    entries: Vec<Assumption>,
}

impl Assumptions {
    /// Max number of distinct ones; further ones are dropped.
    const MAX: usize = 256;

    /// Adds one frame's or source's assumption, if it is not there.
    pub fn add(&mut self, assumption: &Assumption) {
        let place = self.entries.iter().position(|entry| entry.is_of_same(assumption));
        match place {
            // The larger count, regardless of which frame was read first.
            Some(place) if assumption.has_longer_why_than(&self.entries[place]) => {
                self.entries[place] = assumption.clone();
            }
            None if self.entries.len() < Self::MAX => self.entries.push(assumption.clone()),
            _ => {}
        }
    }

    /// The distinct ones, by subject.
    pub fn sorted(&self) -> Vec<Assumption> {
        let mut sorted = self.entries.clone();
        sorted.sort_by_key(|assumption| assumption.subject);
        sorted
    }
}

impl<'a> Extend<&'a Assumption> for Assumptions {
    fn extend<I: IntoIterator<Item = &'a Assumption>>(&mut self, assumptions: I) {
        for assumption in assumptions {
            self.add(assumption);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subjects_match_table_rows_in_order() {
        for (place, row) in SUBJECTS.iter().enumerate() {
            assert_eq!(row.subject as usize, place, "{}", row.key);
            assert_eq!(row.subject.key(), row.key);
        }
        assert_eq!(SUBJECTS.len(), Subject::Projection as usize + 1);
    }

    #[test]
    fn equal_assumptions_of_many_frames_are_merged() {
        let of = |value: &str| Assumption::new(Subject::Columns, value, "by statistics", Evidence::Statistics);
        let up = Assumption::new(Subject::UpAxis, "+Z", "the format says so", Evidence::Convention);
        let mut all = Assumptions::default();
        all.extend([&of("x y z"), &of("x y z"), &up, &of("x y z i")]);
        assert_eq!(all.sorted(), [up, of("x y z"), of("x y z i")]);
    }

    #[test]
    fn the_largest_count_of_a_no_data_value_is_reported() {
        let of = |value: &str, count: usize| {
            Assumption::new(Subject::NoData, value, format!("{count} points"), Evidence::Statistics)
        };
        let mut all = Assumptions::default();
        all.extend([
            &of("0 0 0", 99),
            &of("-1 -1 -1", 5),
            &of("0 0 0", 100),
            &of("0 0 0", 98),
        ]);
        assert_eq!(all.sorted(), [of("0 0 0", 100), of("-1 -1 -1", 5)]);
    }

    #[test]
    fn an_assumption_is_one_line() {
        let columns = Assumption::new(Subject::Columns, "x y z", "there is no header", Evidence::Statistics);
        let line = "columns: x y z (there is no header; statistics; change with --columns)";
        assert_eq!(columns.to_string(), line);
        let unchangeable = columns.with_option(None);
        assert_eq!(
            unchangeable.to_string(),
            "columns: x y z (there is no header; statistics)"
        );
        assert!(Evidence::Fallback.is_guess() && !Evidence::Convention.is_guess());
    }
}
