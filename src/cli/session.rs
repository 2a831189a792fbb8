//! Sessions on the command line: their files are inputs of every verb; `render` and `view` take the rest as well.

use crate::cli::terminal::stream::tell_of_connection;
use crate::cli::terminal::warnings;
use crate::document::{ReadSession, session_of};
use crate::messages::frame_by_index;
use crate::scene::Clip;
use crate::sequence::{OpenOptions, Sequence};
use crate::source::DEMO_INPUT;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// What a person named, opened.
pub(super) struct OpenedInputs {
    pub(super) sequence: Sequence,
    /// The session that it is of.
    pub(super) session: Option<ReadSession>,
}

/// Opens what a person named; nothing is the built-in sequence. What is given goes before what a session says.
pub(super) fn open_inputs(inputs: &[PathBuf], options: &OpenOptions) -> anyhow::Result<OpenedInputs> {
    let session = session_of(inputs)?;
    if let Some(read) = &session {
        read.check_reach(options.session_reach)?;
    }
    let sequence = match (&session, inputs) {
        (Some(read), _) => Sequence::open(&read.document.inputs, &read.document.reading.over(options))?,
        (None, []) => Sequence::open(&[DEMO_INPUT.into()], options)?,
        (None, inputs) => Sequence::open(inputs, options)?,
    };
    Ok(OpenedInputs { sequence, session })
}

/// [`open_inputs`], which warns of what is left out. A window says that itself.
pub(super) fn open_inputs_and_tell(inputs: &[PathBuf], options: &OpenOptions) -> anyhow::Result<OpenedInputs> {
    let opened = open_inputs(inputs, options)?;
    let of_session = opened.session.iter().flat_map(|read| &read.warnings);
    for note in opened.sequence.source().notes().iter().chain(of_session) {
        warnings::warn(note);
    }
    tell_of_connection(&opened.sequence);
    Ok(opened)
}

/// What is in a session, for `info`.
#[derive(Debug, Serialize)]
pub(super) struct SessionInfo {
    file: String,
    files: Vec<String>,
    /// What is beside them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    compare: Vec<String>,
    /// Counted from 0.
    frame: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<String>,
    clips: bool,
    markers: usize,
    measurements: usize,
    labels: Vec<String>,
    /// Of the camera path.
    keyframes: usize,
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
            clips: session.clip.as_ref().is_some_and(|clip: &Clip| clip.is_on),
            markers: session.markers.len(),
            measurements: session.measurements.len(),
            labels: session.labels.iter().map(|label| label.text.clone()).collect(),
            keyframes: session.path.as_ref().map_or(0, |path| path.keyframes().len()),
        }
    }

    /// Lines above the table of frames.
    pub(super) fn lines(&self) -> String {
        let mut text = format!("session {} of {}", self.file, self.files.join(", "));
        if !self.compare.is_empty() {
            text.push_str(" beside ");
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
        if !self.labels.is_empty() {
            let quoted: Vec<String> = self.labels.iter().map(|label| format!("\"{label}\"")).collect();
            let _ = writeln!(text, "  labels: {}", quoted.join(", "));
        }
        text.push('\n');
        text
    }
}
