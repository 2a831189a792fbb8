//! What tasks come to: here the features meet.

use super::dialogs::DialogAnswer;
use super::opened::SavedSession;
use crate::app::drawing::in_view::InView;
use crate::app::drawing::levels::FrameWithLevels;
use crate::app::features::assumptions::ReadChange;
use crate::app::features::benchmark::BenchmarkEnded;
use crate::app::features::beside::FrameDistances;
use crate::app::features::camera_path::PathFile;
use crate::app::features::comparison::PictureDifference;
use crate::app::features::export::ExportEnded;
use crate::app::features::photos::{PhotographedFrame, PhotosLoaded};
use crate::app::features::save::{Estimated, SaveEnded};
use crate::app::features::temporal::ComposedFrame;
use crate::app::features::thumbnails::Delivery;
use crate::app::features::trails::Traced;
use crate::app::first_look::RefinedLook;
use crate::app::side::Side;
use crate::app::work::files::SavedFile;
use crate::app::work::tasks::TaskFailed;
use crate::document::{Beyond, ReadSession};
use crate::sequence::{OpenOptions, Sequence, SequenceError};
use crate::source::OpeningChoice;
use std::path::PathBuf;
use std::sync::Arc;

/// A sequence was found, or not.
#[derive(Debug)]
pub struct FoundSequence {
    /// What was asked for; empty for the demo.
    pub(super) inputs: Vec<PathBuf>,
    /// How it was opened.
    pub(super) open: OpenOptions,
    /// The session that the frames are of, if one was asked for.
    pub(super) session: Option<Box<ReadSession>>,
    /// The frames.
    pub(super) sequence: Result<Arc<Sequence>, NotFound>,
    /// Whether it is to be opened, or beside what is open.
    pub(super) side: Side,
    /// It is the open sequence read with these changes; empty if it is another one.
    pub(super) changes: Vec<ReadChange>,
    /// Why a choice that was made for the inputs before was not taken: a text for a notice.
    pub(super) problem: Option<String>,
}

/// Why no frames were found.
#[derive(Debug)]
pub(super) enum NotFound {
    /// Nobody wants them any more.
    Cancelled,
    /// There are none, and why; and the sequences of which one has to be chosen.
    Because(String, Vec<OpeningChoice>),
    /// The session opens more than is allowed: a person is asked.
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

/// Declares what tasks come to, and makes it of what each task gives.
macro_rules! outcomes {
    ($($(#[$doc:meta])* $variant:ident($of:ty),)*) => {
        /// What a task came to.
        #[derive(Debug)]
        pub enum Outcome {
            $($(#[$doc])* $variant($of),)*
        }

        $(impl From<$of> for Outcome {
            fn from(of: $of) -> Self {
                Self::$variant(of)
            }
        })*
    };
}

outcomes! {
    /// The frames of inputs were looked for.
    Found(FoundSequence),
    /// A dialog was closed.
    Answered(DialogAnswer),
    /// A file was written.
    Saved(SavedFile),
    /// A camera path was read or written.
    Path(PathFile),
    /// A session was written.
    SessionSaved(SavedSession),
    /// An export ended.
    Exported(ExportEnded),
    /// A sequence was saved, or not.
    SequenceSaved(SaveEnded),
    /// A frame was judged as it would be saved.
    Estimated(Box<Estimated>),
    /// Two pictures were compared.
    Compared(PictureDifference),
    /// The points of two frames were compared; `None` if one has none, or nobody waits for it any more.
    Distances(Option<FrameDistances>),
    /// A frame was made of several poses; `None` if nobody waits for it any more.
    Composed(Option<Box<ComposedFrame>>),
    /// A frame has got levels of detail.
    Levels(FrameWithLevels),
    /// Surfels of what a view shows were estimated.
    InView(Arc<InView>),
    /// Several frames of a sequence were looked at.
    Looked(Box<RefinedLook>),
    /// A small picture of a frame was made.
    Thumbnail(Box<Delivery>),
    /// Photographs were loaded.
    Photos(PhotosLoaded),
    /// Photographs were put on a frame.
    Photographed(PhotographedFrame),
    /// Points were followed through the frames.
    Traced(Traced),
    /// A benchmark ended.
    Benchmark(BenchmarkEnded),
    /// A task failed.
    Failed(TaskFailed),
}
