//! Sessions on the command line: their files are inputs of every subcommand; `render` and `view` take the rest as well.

use crate::cli::terminal::stream::tell_of_connection;
use crate::cli::terminal::warnings;
use crate::document::{DocumentFolder, ReadSession, session_of};
use crate::messages::frame_by_index;
use crate::scene::{Clip, Settings, UpAxis};
use crate::sequence::{OpenOptions, Sequence};
use crate::source::DEMO_INPUT;
use crate::timeline::PlayRange;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Opened inputs, as named by the user.
pub(super) struct OpenedInputs {
    pub(super) sequence: Sequence,
    /// The session that it is of.
    pub(super) session: Option<ReadSession>,
}

/// Opens the inputs named by the user; without inputs it is the built-in sequence. Given options override the contents
/// of a session. Unsaved changes of a session are taken from `documents`.
pub(super) fn open_inputs(
    inputs: &[PathBuf],
    options: &OpenOptions,
    documents: Option<&DocumentFolder>,
) -> anyhow::Result<OpenedInputs> {
    let mut session = session_of(inputs)?;
    if let Some(read) = &mut session {
        read.check_reach(options.session_reach)?;
        if let Some(documents) = documents {
            documents.restore(read);
        }
    }
    let sequence = match (&session, inputs) {
        (Some(read), _) => Sequence::open(&read.document.inputs, &read.document.reading.over(options))?,
        (None, []) => Sequence::open(&[DEMO_INPUT.into()], options)?,
        (None, inputs) => Sequence::open(inputs, options)?,
    };
    Ok(OpenedInputs { sequence, session })
}

/// Calls [`open_inputs`] and warns of skipped files. A window reports that itself.
pub(super) fn open_inputs_and_tell(inputs: &[PathBuf], options: &OpenOptions) -> anyhow::Result<OpenedInputs> {
    let opened = open_inputs(inputs, options, None)?;
    let of_session = opened.session.iter().flat_map(|read| &read.warnings);
    for note in opened.sequence.source().notes().iter().chain(of_session) {
        warnings::warn(note);
    }
    tell_of_connection(&opened.sequence);
    Ok(opened)
}

/// Contents of a session, for `info`.
#[derive(Debug, Serialize)]
pub(super) struct SessionInfo {
    file: String,
    files: Vec<String>,
    /// Inputs to compare with, shown next to them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    compare: Vec<String>,
    /// Counted from 0.
    frame: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<String>,
    /// The axis that was chosen to be up.
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<&'static str>,
    /// In and out point, as far as they are set; counted from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<PlayRange>,
    /// Read options of the files, as far as they were chosen.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    reading: BTreeMap<String, Value>,
    /// The settings that are not as by default.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    settings: BTreeMap<String, Value>,
    clips: bool,
    markers: usize,
    measurements: usize,
    labels: Vec<String>,
    trails: TrailsInfo,
    /// Number of keyframes of the camera path.
    keyframes: usize,
    #[serde(skip_serializing_if = "String::is_empty")]
    notes: String,
}

/// Trails that are shown.
#[derive(Debug, Serialize)]
struct TrailsInfo {
    of_picked: bool,
    /// Points whose trails stay.
    #[serde(rename = "kept")]
    pinned: usize,
    /// Points that are spread over the frame.
    spread: usize,
}

impl SessionInfo {
    pub(super) fn of(read: &ReadSession) -> Self {
        let session = &read.document;
        Self {
            file: read.file.display().to_string(),
            files: session.inputs.iter().map(|input| input.display().to_string()).collect(),
            compare: session.compare.as_ref().map_or_else(Vec::new, |compared| {
                let inputs = compared.inputs.iter();
                inputs.map(|input| input.display().to_string()).collect()
            }),
            frame: session.frame,
            view: session.view.map(|view| view.to_string()),
            up: session.up.map(UpAxis::name),
            range: Some(session.range).filter(|range| *range != PlayRange::default()),
            reading: fields_of(&session.reading),
            settings: chosen_settings(&session.settings),
            clips: session.clip.as_ref().is_some_and(|clip: &Clip| clip.is_on),
            markers: session.markers.len(),
            measurements: session.measurements.len(),
            labels: session.labels.iter().map(|label| label.text.clone()).collect(),
            trails: TrailsInfo {
                of_picked: session.trails.of_picked,
                pinned: session.trails.pinned.len(),
                spread: session.trails.spread.map_or(0, |spread| spread.points),
            },
            keyframes: session.path.keyframes().len(),
            notes: session.notes.clone(),
        }
    }

    /// Lines above the table of frames.
    pub(super) fn lines(&self) -> String {
        let mut text = format!("session {} of {}", self.file, self.files.join(", "));
        if !self.compare.is_empty() {
            text.push_str(" compared with ");
            text.push_str(&self.compare.join(", "));
        }
        text.push('\n');
        let counted = |count: usize, one: &str| match count {
            1 => format!("1 {one}"),
            count => format!("{count} {one}s"),
        };
        let clip = if self.clips { ", clipped" } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "  {}{clip}, {}, {}, {}, {}",
            frame_by_index(self.frame),
            counted(self.labels.len(), "label"),
            counted(self.measurements, "measurement"),
            counted(self.markers, "marker"),
            counted(self.keyframes, "keyframe")
        );
        for (name, told) in self.parts() {
            if !told.is_empty() {
                let _ = writeln!(text, "  {name}: {}", told.join(", "));
            }
        }
        text.push('\n');
        text
    }

    /// Returns the parts that have a line of their own, where there are any.
    fn parts(&self) -> [(&'static str, Vec<String>); 7] {
        let counted_from_1 = |frame: Option<usize>, name: &str| frame.map(|frame| format!("{name} {}", frame + 1));
        let range = self.range.unwrap_or_default();
        let trails = &self.trails;
        let counted = |count: usize, what: &str| (count > 0).then(|| format!("{count} {what}"));
        [
            ("up axis", self.up.iter().map(|up| (*up).to_owned()).collect()),
            (
                "plays",
                [
                    counted_from_1(range.first(), "from frame"),
                    counted_from_1(range.last(), "to frame"),
                ]
                .into_iter()
                .flatten()
                .collect(),
            ),
            ("reading", told(&self.reading)),
            ("settings", told(&self.settings)),
            (
                "labels",
                self.labels.iter().map(|label| format!("\"{label}\"")).collect(),
            ),
            (
                "trails",
                [
                    trails.of_picked.then(|| "of picked points".to_owned()),
                    counted(trails.pinned, "kept"),
                    counted(trails.spread, "spread over the frame"),
                ]
                .into_iter()
                .flatten()
                .collect(),
            ),
            ("notes", self.notes.lines().map(str::to_owned).collect()),
        ]
    }
}

/// The fields of a value that serialises as an object.
fn fields_of(value: &impl Serialize) -> BTreeMap<String, Value> {
    // Via text, as in files: single-precision numbers have only the digits that they need.
    let text = serde_json::to_string(value).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The settings that are not as by default.
fn chosen_settings(settings: &Settings) -> BTreeMap<String, Value> {
    let default = fields_of(&Settings::default());
    let mut chosen = fields_of(settings);
    chosen.retain(|name, value| default.get(name) != Some(value));
    chosen
}

/// Fields as texts: `lighting lambert`.
fn told(fields: &BTreeMap<String, Value>) -> Vec<String> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    fields
        .iter()
        .map(|(name, value)| format!("{name} {}", text(value)))
        .collect()
}
