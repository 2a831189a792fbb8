//! Documents as session files.

use super::draft::Draft;
use super::error::SessionError;
use super::model::{Document, Unknown};
use super::paths::{as_text, joined};
use super::text;
use super::text_hash::TextHash;
use super::written::{
    self, VERSION, Version, Written, clip_fields, compare_fields, label_fields, measured_fields, trail_fields,
};
use crate::persist::{self, Fields};
use crate::regular_file;
use crate::scene::{Settings, UpAxis};
use crate::timeline::PlayRange;
use serde::Serialize;
use serde_json::Value;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// File name extension of session files.
pub const EXTENSION: &str = "pointreel";

/// Any realistic number of labels and keyframes, with all digits, takes less.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Most labels, and most measurements.
const MAX_MARKS: usize = 1000;

/// Largest frame index that can be named: no sequence reaches it.
const LAST_FRAME: usize = u32::MAX as usize;

/// Max names of values in a warning.
const MAX_REASONS: usize = 20;

/// A session that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadSession {
    /// Its file.
    pub file: PathBuf,
    /// Document stored in the session.
    pub document: Document,
    /// Warnings about parts of the session that could not be read, one sentence each.
    pub warnings: Vec<String>,
    /// Hash of the session's text.
    pub text_hash: TextHash,
    /// Unsaved changes of the session, once they have been looked for ([`DocumentFolder::restore`]).
    ///
    /// [`DocumentFolder::restore`]: super::DocumentFolder::restore
    pub unsaved: Unsaved,
}

/// Outcome of restoring the unsaved changes of a session that is opened.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Unsaved {
    /// There are none.
    #[default]
    None,
    /// They are in the document. The session has this one.
    Restored(Box<Document>),
    /// Another program has written the session since: they are in a separate session file.
    Outdated(PathBuf),
}

/// Returns true if a file is a session, by its name.
pub fn is_session(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// The session that `inputs` name; `None` where they are other files. A folder may have such a name as well.
///
/// # Errors
/// As [`ReadSession::read`].
pub fn session_of(inputs: &[PathBuf]) -> Result<Option<ReadSession>, SessionError> {
    match inputs {
        [input] if is_session(input) && !input.is_dir() => ReadSession::read(input).map(Some),
        _ => Ok(None),
    }
}

impl ReadSession {
    /// Reads the session in `file`.
    ///
    /// # Errors
    /// Failures to read, and invalid content with its line.
    pub fn read(file: &Path) -> Result<Self, SessionError> {
        let failed = |reason| SessionError::Read {
            file: file.to_owned(),
            reason,
        };
        let mut bytes = Vec::new();
        regular_file::open(file)
            .and_then(|opened| opened.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes))
            .map_err(failed)?;
        if bytes.len() as u64 > MAX_FILE_BYTES {
            return Err(SessionError::TooLarge {
                file: file.to_owned(),
                max_bytes: MAX_FILE_BYTES,
            });
        }
        Self::of_text(&bytes, file)
    }

    /// Reads a session from the text of `file`; paths in it are relative to its folder.
    ///
    /// # Errors
    /// Invalid content with its line.
    pub fn of_text(text: &[u8], file: &Path) -> Result<Self, SessionError> {
        let json = |reason| SessionError::Json {
            file: file.to_owned(),
            reason,
        };
        // A later version may have other fields: it is checked separately.
        let Version {
            pointreel_session: version,
        } = serde_json::from_slice(text).map_err(json)?;
        if version > VERSION {
            return Err(SessionError::Later {
                file: file.to_owned(),
                version,
                known: VERSION,
            });
        }
        let written: Written = serde_json::from_slice(text).map_err(json)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let inputs: Vec<PathBuf> = written.files.iter().map(|text| joined(folder, text)).collect();
        if inputs.is_empty() {
            return Err(SessionError::NoFiles { file: file.to_owned() });
        }
        if let Some(input) = inputs.iter().find(|input| is_session(input) && !input.is_dir()) {
            return Err(SessionError::OfSession {
                file: file.to_owned(),
                input: input.clone(),
            });
        }
        check_counts(file, &written)?;
        check_frames(file, &written)?;
        let mut notes = Notes::default();
        let (settings, unknown_settings) = settings_of(&written.settings, &mut notes);
        let labels = written.labels.into_iter().map(|written::WrittenLabel(label, unknown)| {
            notes.unknown("a label", &unknown);
            label
        });
        let labels = Arc::new(labels.collect());
        let measured = written.measurements.into_iter();
        let measurements = measured.map(|written::WrittenMeasured(measured, unknown)| {
            notes.unknown("a measurement", &unknown);
            measured
        });
        let measurements = measurements.collect();
        let mut markers = written.markers;
        markers.sort_by_key(|marker| marker.frame);
        let document = Document {
            inputs,
            reading: written.reading.read_in(folder),
            up: written.up,
            frame: written.frame,
            view: written.view,
            settings,
            clip: written.clip.map(|clip| clip.0),
            range: written.range,
            markers,
            measurements,
            labels,
            trails: written.trails.0,
            path: Arc::new(written.camera_path.map(Draft::of).unwrap_or_default()),
            compare: written.compare.map(|compared| compared.read_in(folder)),
            notes: written.notes,
            unknown: Unknown {
                session: written.unknown,
                settings: unknown_settings,
            },
        };
        Ok(Self {
            file: file.to_owned(),
            document,
            warnings: notes.warnings(file),
            text_hash: TextHash::of(text),
            unsaved: Unsaved::None,
        })
    }
}

/// Each frame looks for the points of all of them.
fn check_counts(file: &Path, written: &Written) -> Result<(), SessionError> {
    let counts = [
        ("labels", written.labels.len()),
        ("measurements", written.measurements.len()),
        ("trails", written.trails.0.pinned.len()),
    ];
    match counts.into_iter().find(|(_, count)| *count > MAX_MARKS) {
        Some((what, count)) => Err(SessionError::TooMany {
            file: file.to_owned(),
            what,
            count,
            max: MAX_MARKS,
        }),
        None => Ok(()),
    }
}

/// Frames are counted on from, and shown counted from 1.
fn check_frames(file: &Path, written: &Written) -> Result<(), SessionError> {
    let of_range = |range: PlayRange| [range.first(), range.last()];
    let named = [Some(written.frame)].into_iter().chain(of_range(written.range));
    let markers = written.markers.iter().map(|marker| Some(marker.frame));
    let labels = written.labels.iter().map(|written::WrittenLabel(label, _)| label);
    let labels = labels.flat_map(|label| of_range(label.frames).into_iter().chain([Some(label.frame)]));
    let measured = written.measurements.iter();
    let measured = measured.flat_map(|written::WrittenMeasured(measured, _)| &measured.points);
    let measured = measured.chain(&written.trails.0.pinned).map(|point| Some(point.frame));
    let mut frames = named.chain(markers).chain(labels).chain(measured).flatten();
    match frames.find(|&frame| frame > LAST_FRAME) {
        Some(frame) => Err(SessionError::Frame {
            file: file.to_owned(),
            frame,
            max: LAST_FRAME,
        }),
        None => Ok(()),
    }
}

/// Warnings about parts that could not be read.
#[derive(Debug, Default)]
struct Notes(Vec<String>);

impl Notes {
    fn unknown(&mut self, of: &str, names: &[String]) {
        for name in names {
            let text = format!("`{name}` of {of} is not known");
            if !self.0.contains(&text) {
                self.0.push(text);
            }
        }
    }

    fn warnings(self, file: &Path) -> Vec<String> {
        let (file, count) = (file.display(), self.0.len());
        let shown = self.0.into_iter().take(MAX_REASONS);
        let mut warnings: Vec<String> = shown
            .map(|text| format!("not all of {file} was read: {text}"))
            .collect();
        if count > MAX_REASONS {
            warnings.push(format!("{} more of {file} were not read", count - MAX_REASONS));
        }
        warnings
    }
}

/// The settings, parsed one by one, and the unknown ones.
fn settings_of(written: &Fields, notes: &mut Notes) -> (Settings, Fields) {
    let mut unread = Vec::new();
    let settings = persist::fields::<Settings>(written, &mut unread).nearest();
    notes
        .0
        .extend(unread.iter().map(|reason| format!("the setting {reason}")));
    let known = settings_value(&Settings::default());
    let unknown = written.iter().filter(|(name, _)| !known.contains_key(*name));
    let unknown = unknown.map(|(name, value)| (name.clone(), value.clone())).collect();
    (settings, unknown)
}

/// By the names that files have for them. Single numbers have the few digits that they need.
fn settings_value(settings: &Settings) -> Fields {
    // Strings and numbers only: this cannot fail.
    let text = serde_json::to_string(settings).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

fn value_of(fields: impl Serialize) -> Value {
    // Numbers and strings only: this cannot fail.
    serde_json::to_value(fields).unwrap_or_default()
}

impl Document {
    /// The text of a session in `file`: JSON with paths relative to the folder of the file.
    ///
    /// # Errors
    /// Inputs whose names are not text.
    pub fn to_text(&self, file: &Path) -> Result<String, SessionError> {
        let fields = self.fields(Some(file.parent().unwrap_or(Path::new(""))))?;
        Ok(text::of_fields(fields.iter().map(|(name, value)| (*name, value))))
    }

    /// Its fields in the order of files, without those that have nothing. Paths are from `folder`, or absolute without
    /// one.
    pub(super) fn fields(&self, folder: Option<&Path>) -> Result<Vec<(&str, Value)>, SessionError> {
        let files = self.inputs.iter().map(|input| as_text(input, folder));
        let files = files.collect::<Result<Vec<String>, _>>()?;
        let mut settings = self.unknown.settings.clone();
        settings.append(&mut settings_value(&self.settings));
        let labels: Vec<Value> = self.labels.iter().map(|label| value_of(label_fields(label))).collect();
        let measured = self.measurements.iter();
        let measured: Vec<Value> = measured.map(|measured| value_of(measured_fields(measured))).collect();
        let view = self.view.map(|view| view.to_string());
        let clip = self.clip.as_ref().map(|clip| value_of(clip_fields(clip)));
        let compared = self.compare.as_ref().map(|compared| compare_fields(compared, folder));
        let compared = compared.transpose()?;
        let fields = [
            ("pointreel_session", Value::from(VERSION)),
            ("files", value_of(files)),
            ("reading", value_of(self.reading.written_in(folder)?)),
            ("up", value_of(self.up.map(UpAxis::name))),
            ("frame", self.frame.into()),
            ("view", value_of(view)),
            (
                "range",
                value_of(Some(self.range).filter(|range| *range != PlayRange::default())),
            ),
            ("markers", value_of(&self.markers)),
            ("labels", labels.into()),
            ("measurements", measured.into()),
            ("trails", value_of(trail_fields(&self.trails))),
            ("clip", value_of(clip)),
            ("camera_path", value_of(self.path.path())),
            ("compare", value_of(compared)),
            ("notes", value_of(Some(&self.notes).filter(|notes| !notes.is_empty()))),
            ("settings", settings.into()),
        ];
        // Absent values need no line.
        let is_there = |value: &Value| match value {
            Value::Null => false,
            Value::Array(list) => !list.is_empty(),
            Value::Object(fields) => !fields.is_empty(),
            _ => true,
        };
        let fields = fields.into_iter().filter(|(_, value)| is_there(value));
        let unknown = self.unknown.session.iter();
        let unknown = unknown.map(|(name, value)| (name.as_str(), value.clone()));
        Ok(fields.chain(unknown).collect())
    }

    /// Writes the session to `file`, which is replaced as a whole; the hash of its text.
    ///
    /// # Errors
    /// As [`Document::to_text`], and the system's.
    pub fn write(&self, file: &Path) -> Result<TextHash, SessionError> {
        let text = self.to_text(file)?;
        persist::write_whole(file, text.as_bytes()).map_err(|reason| SessionError::Write {
            file: file.to_owned(),
            reason,
        })?;
        Ok(TextHash::of(text.as_bytes()))
    }
}
