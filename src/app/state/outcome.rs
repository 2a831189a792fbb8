//! Outcomes of tasks that belong to no feature.

use super::opened::SavedSession;
use crate::app::drawing::in_view::InView;
use crate::app::drawing::levels::FrameWithLevels;
use crate::app::first_look::RefinedLook;
use crate::app::side::Side;
use crate::app::work::files::SavedFile;
use crate::app::work::outcome::Message;
use crate::document::{Beyond, ReadSession};
use crate::sequence::{OpenOptions, Sequence, SequenceError};
use crate::source::OpeningChoice;
use std::path::PathBuf;
use std::sync::Arc;

/// A sequence was found, or not.
#[derive(Debug)]
pub struct FoundSequence {
    /// Requested inputs; empty for the demo.
    pub(in crate::app) inputs: Vec<PathBuf>,
    /// Options it was opened with.
    pub(in crate::app) open: OpenOptions,
    /// The session of the frames, if one was requested.
    pub(in crate::app) session: Option<Box<ReadSession>>,
    /// The frames.
    pub(in crate::app) sequence: Result<Arc<Sequence>, NotFound>,
    /// Target side: open as the main sequence, or next to the open one.
    pub(in crate::app) side: Side,
    /// Why a choice that was made for the inputs before was not taken: a text for a notice.
    pub(in crate::app) problem: Option<String>,
}

/// Why no frames were found.
#[derive(Debug)]
pub(in crate::app) enum NotFound {
    /// The request was cancelled.
    Cancelled,
    /// There are none, with the reason; and the sequences from which one has to be chosen.
    Because(String, Vec<OpeningChoice>),
    /// The session opens more than is allowed: the user is asked.
    Beyond(Beyond),
}

impl From<SequenceError> for NotFound {
    fn from(error: SequenceError) -> Self {
        match error {
            SequenceError::Cancelled => Self::Cancelled,
            error => {
                let reason = error.to_string();
                match error {
                    SequenceError::Several { choices, .. } => Self::Because(reason, choices),
                    _ => Self::Because(reason, Vec::new()),
                }
            }
        }
    }
}

impl Message for FoundSequence {}
impl Message for SavedSession {}
impl Message for SavedFile {}
impl Message for FrameWithLevels {}
impl Message for Arc<InView> {}
impl Message for Box<RefinedLook> {}
