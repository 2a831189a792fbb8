//! File dialogs of the system, one at a time.

use crate::app::features::benchmark::ReportFormat;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::document::EXTENSION;
use crate::export::PictureFormat;
use crate::source;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A dialog that gives no answer sooner than a person can press a key was never seen.
const SEEN_DIALOG: Duration = Duration::from_millis(400);

/// What a dialog asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogKind {
    /// Files to open as a sequence.
    OpenFiles,
    /// A folder to open as a sequence.
    OpenFolder,
    /// Files to open as a second sequence.
    CompareFiles,
    /// A folder to open as a second sequence.
    CompareFolder,
    /// Where to write the picture.
    SavePicture,
    /// Where to record a live stream.
    RecordTo,
    /// A camera path to open.
    OpenPath,
    /// Where to write the camera path.
    SavePath,
    /// Where to write the session.
    SaveSession,
    /// The file of an export, with this extension.
    ExportTo(&'static str),
    /// The folder of an export of many files.
    ExportFolder,
    /// The sequence file to save to.
    SaveReel,
    /// The folder to save frames to.
    SaveFolder,
    /// Where to write the benchmark.
    SaveReport(ReportFormat),
}

impl DialogKind {
    /// Whether it asks where to write what a person has made, which must not be lost for want of a dialog.
    pub(in crate::app) fn writes_own_work(self) -> bool {
        matches!(self, Self::SavePath | Self::SaveSession | Self::SaveReport(_))
    }

    /// What to do where the system has no dialogs.
    pub(in crate::app) fn without_dialogs(self) -> &'static str {
        match self {
            Self::OpenFiles | Self::OpenFolder | Self::CompareFiles | Self::CompareFolder => {
                "Drop files or a folder on the window, or name them on the command line: pointreel view FOLDER"
            }
            Self::OpenPath => "Name a session with the camera path on the command line: pointreel view FILE.pointreel",
            Self::SavePicture => "Save picture (P) asks for no name, and Export… has a field for it",
            Self::ExportTo(_) | Self::ExportFolder | Self::SaveReel | Self::SaveFolder => {
                "Write folder and name into the fields"
            }
            Self::RecordTo => "Name the file on the command line: pointreel view tcp://… --record FILE",
            Self::SavePath | Self::SaveSession | Self::SaveReport(_) => "Install one of these for other places",
        }
    }
}

/// How a dialog was closed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DialogAnswer {
    /// With at least one path.
    Chosen {
        /// Which dialog.
        dialog: DialogKind,
        /// What was chosen.
        paths: Vec<PathBuf>,
    },
    /// Without any.
    Cancelled,
    /// The system has no dialogs.
    NoDialog {
        /// Which one was wanted.
        dialog: DialogKind,
        /// The name of a file that was proposed.
        file_name: Option<String>,
    },
}

/// The dialog that is open, or none.
#[derive(Debug, Default)]
pub(in crate::app) struct Dialogs {
    is_open: bool,
}

impl Dialogs {
    /// Asks the person. Nothing happens while another dialog is open.
    pub(in crate::app) fn ask<T: TaskOutcome + From<DialogAnswer>>(
        &mut self,
        dialog: DialogKind,
        file_name: Option<String>,
        tasks: &Tasks<T>,
    ) {
        if std::mem::replace(&mut self.is_open, true) {
            return;
        }
        tasks.start("file dialog", move || {
            let opened = Instant::now();
            match show_dialog(dialog, file_name.clone()) {
                Some(paths) if !paths.is_empty() => DialogAnswer::Chosen { dialog, paths },
                _ if opened.elapsed() < SEEN_DIALOG => DialogAnswer::NoDialog { dialog, file_name },
                _ => DialogAnswer::Cancelled,
            }
        });
    }

    /// Takes notice that it was closed.
    pub(in crate::app) fn note_answer(&mut self) {
        self.is_open = false;
    }
}

fn show_dialog(kind: DialogKind, file_name: Option<String>) -> Option<Vec<PathBuf>> {
    let mut dialog = rfd::FileDialog::new();
    if let Some(file_name) = file_name {
        dialog = dialog.set_file_name(file_name);
    }
    let one = |path: Option<PathBuf>| path.map(|path| vec![path]);
    let title = match kind {
        DialogKind::OpenFiles => "Open point clouds",
        DialogKind::OpenFolder => "Open a folder of frames",
        DialogKind::CompareFiles => "Compare with point clouds",
        DialogKind::CompareFolder => "Compare with a folder of frames",
        DialogKind::SavePicture => "Save the picture",
        DialogKind::RecordTo => "Record the live stream",
        DialogKind::OpenPath => "Open a camera path",
        DialogKind::SavePath => "Save the camera path",
        DialogKind::SaveSession => "Save the session",
        DialogKind::ExportTo(_) => "Export to",
        DialogKind::ExportFolder => "Folder of the pictures",
        DialogKind::SaveReel => "Save the sequence",
        DialogKind::SaveFolder => "Folder of the frames",
        DialogKind::SaveReport(_) => "Save the benchmark",
    };
    dialog = dialog.set_title(title);
    match kind {
        DialogKind::OpenFiles | DialogKind::CompareFiles => dialog
            .add_filter(
                "Point clouds and sessions",
                &source::supported_extensions().chain([EXTENSION]).collect::<Vec<_>>(),
            )
            .add_filter("All files", &["*"])
            .pick_files(),
        DialogKind::OpenFolder | DialogKind::CompareFolder | DialogKind::ExportFolder | DialogKind::SaveFolder => {
            one(dialog.pick_folder())
        }
        DialogKind::SaveSession => one(dialog.add_filter("Session", &[EXTENSION]).save_file()),
        DialogKind::SaveReel => one(dialog.add_filter("Sequence file", &["reel"]).save_file()),
        DialogKind::SavePicture => one(PictureFormat::filters()
            .fold(dialog, |dialog, (name, extensions)| {
                dialog.add_filter(format!("{name} image"), extensions)
            })
            .save_file()),
        DialogKind::RecordTo => one(dialog
            .add_filter("Recording of a stream", &["pointreel-stream"])
            .save_file()),
        DialogKind::OpenPath => one(dialog.add_filter("Camera path", &["json"]).pick_file()),
        DialogKind::SavePath => one(dialog.add_filter("Camera path", &["json"]).save_file()),
        DialogKind::ExportTo(extension) => one(dialog.add_filter(extension.to_uppercase(), &[extension]).save_file()),
        DialogKind::SaveReport(format) => one(dialog.add_filter(format.name(), &[format.extension()]).save_file()),
    }
}
