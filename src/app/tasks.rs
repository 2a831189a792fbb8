//! What must not hold the window up, on threads with names: dialogs, finding files, writing files.
//!
//! Each task sends one [`Outcome`] through a bounded channel and wakes the event loop. A dialog is one at a time.

use super::benchmark::BenchmarkTable;
use super::beside::FrameDistances;
use super::camera_path::Draft;
use super::comparison::{PictureDifference, Side};
use super::export::Exported;
use super::in_view::InView;
use super::progress::Progress;
use super::state::LookedAtMore;
use super::temporal::Made;
use super::thumbnails::Delivery;
use super::trails::Traced;
use crate::export::ExportError;
use crate::io;
use crate::sequence::{OpenOptions, PreparedFrame, Sequence, SequenceError};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Wakes the event loop from any thread. Must not block.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A dialog that gives no answer sooner than a person can press a key was never seen.
const SEEN_DIALOG: Duration = Duration::from_millis(400);

/// Outcomes that wait for the window; a task that finds it full waits in its own thread.
const CHANNEL_LENGTH: usize = 64;

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
    /// A camera path to open.
    OpenPath,
    /// Where to write the camera path.
    SavePath,
    /// The file of an export, with this extension.
    ExportTo(&'static str),
    /// The folder of an export of many files.
    ExportFolder,
    /// Where to write the benchmark.
    SaveReport(ReportFormat),
}

/// As what a benchmark is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReportFormat {
    /// For programs.
    Json,
    /// For spreadsheets.
    Csv,
    /// For browsers.
    Html,
}

impl ReportFormat {
    /// Its name for people.
    fn name(self) -> &'static str {
        match self {
            Self::Json => "JSON",
            Self::Csv => "CSV",
            Self::Html => "HTML page",
        }
    }

    /// What its files end in.
    pub(super) fn extension(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Csv => "csv",
            Self::Html => "html",
        }
    }
}

/// What a task came to.
#[derive(Debug)]
pub enum Outcome {
    /// A sequence was found, or not.
    Found {
        /// What was asked for; empty for the demo.
        inputs: Vec<PathBuf>,
        /// The frames.
        sequence: Result<Arc<Sequence>, SequenceError>,
        /// Whether it is to be opened, or beside what is open.
        side: Side,
    },
    /// A dialog was closed with an answer.
    Chosen {
        /// Which dialog.
        dialog: DialogKind,
        /// At least one path.
        paths: Vec<PathBuf>,
    },
    /// A dialog was closed without an answer.
    Cancelled,
    /// The system has no dialogs.
    NoDialog,
    /// A file was written.
    Saved(PathBuf),
    /// A camera path was read.
    PathRead {
        /// Its file.
        file: PathBuf,
        /// The path.
        draft: Arc<Draft>,
    },
    /// A camera path was written.
    PathSaved {
        /// Its file.
        file: PathBuf,
        /// What is in it.
        draft: Arc<Draft>,
    },
    /// An export ended.
    Exported(Result<Exported, ExportError>),
    /// Two pictures were compared.
    Compared(PictureDifference),
    /// The points of two frames were compared; `None` if one has none, or nobody waits for it any more.
    Distances(Option<FrameDistances>),
    /// A frame was made of several poses; `None` if nobody waits for it any more.
    MadeFrame(Option<Box<Made>>),
    /// A frame has got levels of detail.
    Levels(Arc<PreparedFrame>),
    /// Surfels of what a view shows were estimated.
    InView(Arc<InView>),
    /// Several frames of a sequence were looked at.
    Looked(Box<LookedAtMore>),
    /// A small picture of a frame was made.
    Thumbnail(Box<Delivery>),
    /// Points were followed through the frames.
    Traced(Traced),
    /// A benchmark ended; `Err` is a text for the person.
    Benchmark(Result<BenchmarkTable, String>),
    /// A task failed; the text says which and why.
    Failed(String),
}

/// Starts tasks and collects their outcomes.
pub struct Tasks {
    sender: SyncSender<Outcome>,
    receiver: Receiver<Outcome>,
    wake: Wake,
    dialog_is_open: bool,
}

impl std::fmt::Debug for Tasks {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Tasks")
            .field("dialog_is_open", &self.dialog_is_open)
            .finish_non_exhaustive()
    }
}

impl Tasks {
    /// No tasks yet; `wake` is called after each one.
    pub fn new(wake: Wake) -> Self {
        let (sender, receiver) = sync_channel(CHANNEL_LENGTH);
        Self {
            sender,
            receiver,
            wake,
            dialog_is_open: false,
        }
    }

    /// What wakes the window, for a task that has news before it ends.
    pub(super) fn wake(&self) -> Wake {
        Arc::clone(&self.wake)
    }

    /// Runs `task` on a thread called `name`.
    pub fn start(&self, name: &str, task: impl FnOnce() -> Outcome + Send + 'static) {
        let sender = self.sender.clone();
        let wake = Arc::clone(&self.wake);
        let started = thread::Builder::new().name(name.to_owned()).spawn(move || {
            // Nobody listens any more when the window was closed meanwhile.
            if sender.send(task()).is_ok() {
                wake();
            }
        });
        if let Err(reason) = started {
            let text =
                format!("no thread could be started for {name} ({reason}): close other programs");
            if self.sender.try_send(Outcome::Failed(text)).is_ok() {
                (self.wake)();
            }
        }
    }

    /// Runs `task` on a thread of `pool`, where what it shares out stays.
    pub(super) fn start_in(
        &self,
        pool: &rayon::ThreadPool,
        task: impl FnOnce() -> Outcome + Send + 'static,
    ) {
        let sender = self.sender.clone();
        let wake = Arc::clone(&self.wake);
        pool.spawn(move || {
            if sender.send(task()).is_ok() {
                wake();
            }
        });
    }

    /// What came in since the last call.
    pub(super) fn take(&mut self) -> Vec<Outcome> {
        let outcomes: Vec<Outcome> = self.receiver.try_iter().collect();
        if outcomes.iter().any(|outcome| {
            matches!(
                outcome,
                Outcome::Chosen { .. } | Outcome::Cancelled | Outcome::NoDialog
            )
        }) {
            self.dialog_is_open = false;
        }
        outcomes
    }

    /// Finds the frames of `inputs`, to be opened as A or as B, as far as `progress` is not cancelled.
    pub(super) fn find(
        &self,
        inputs: Vec<PathBuf>,
        options: OpenOptions,
        side: Side,
        progress: Progress,
    ) {
        self.start("find frames", move || {
            let sequence = Sequence::open_observed(&inputs, &options, &progress);
            // What was cancelled during the last file is not wanted either.
            let sequence = match sequence {
                Ok(_) if progress.is_cancelled() => Err(SequenceError::Cancelled),
                found => found.map(Arc::new),
            };
            Outcome::Found {
                inputs,
                sequence,
                side,
            }
        });
    }

    /// Asks the person. Nothing happens while another dialog is open.
    pub(super) fn ask(&mut self, dialog: DialogKind, file_name: Option<String>) {
        if self.dialog_is_open {
            return;
        }
        self.dialog_is_open = true;
        self.start("file dialog", move || {
            let opened = Instant::now();
            match show_dialog(dialog, file_name) {
                Some(paths) if !paths.is_empty() => Outcome::Chosen { dialog, paths },
                _ if opened.elapsed() < SEEN_DIALOG => Outcome::NoDialog,
                _ => Outcome::Cancelled,
            }
        });
    }

    /// Writes `bytes` to `path`.
    pub(super) fn save(&self, path: PathBuf, bytes: Vec<u8>) {
        self.start("save file", move || match fs::write(&path, &bytes) {
            Ok(()) => Outcome::Saved(path),
            Err(reason) => Outcome::Failed(cannot_write(&path, &reason)),
        });
    }

    /// Writes `image` to `path`, or under a name made from `stem` that no file has yet.
    pub(super) fn save_picture(&self, image: image::RgbaImage, place: PicturePlace) {
        self.start("save picture", move || {
            let saved = match place {
                PicturePlace::File(path) => save_png(&image, &path).map(|()| path),
                PicturePlace::New { folder, stem } => save_new_png(&image, &folder, &stem),
            };
            saved.map_or_else(Outcome::Failed, Outcome::Saved)
        });
    }
}

/// Where a picture goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum PicturePlace {
    /// This file, which is replaced if it is there: the person was asked.
    File(PathBuf),
    /// A new file.
    New {
        /// Its folder.
        folder: PathBuf,
        /// The beginning of its name.
        stem: String,
    },
}

/// Drops `value` on a thread: what it waits for in dropping does not hold the window up.
pub(super) fn close(value: impl Send + 'static) {
    let started = thread::Builder::new()
        .name("close sequence".to_owned())
        .spawn(move || drop(value));
    if let Err(reason) = started {
        log::warn!("no thread for closing a sequence: {reason}");
    }
}

fn cannot_write(path: &Path, reason: &dyn std::fmt::Display) -> String {
    format!(
        "{} could not be written ({reason}): choose another folder or make room",
        path.display()
    )
}

/// Writes a PNG, replacing the file.
pub(super) fn save_png(image: &image::RgbaImage, path: &Path) -> Result<(), String> {
    image
        .save_with_format(path, image::ImageFormat::Png)
        .map_err(|reason| cannot_write(path, &reason))
}

/// Writes a PNG to `folder/stem.png`, or `folder/stem-2.png` and so on; never replaces a file.
fn save_new_png(image: &image::RgbaImage, folder: &Path, stem: &str) -> Result<PathBuf, String> {
    let mut encoded = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut encoded, image::ImageFormat::Png)
        .map_err(|reason| cannot_write(folder, &reason))?;
    for number in 1..10_000 {
        let path = folder.join(match number {
            1 => format!("{stem}.png"),
            _ => format!("{stem}-{number}.png"),
        });
        match fs::File::create_new(&path) {
            Ok(mut file) => {
                return file
                    .write_all(encoded.get_ref())
                    .map(|()| path.clone())
                    .map_err(|reason| cannot_write(&path, &reason));
            }
            Err(reason) if reason.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(reason) => return Err(cannot_write(&path, &reason)),
        }
    }
    Err(cannot_write(folder, &"every name is taken"))
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
        DialogKind::OpenPath => "Open a camera path",
        DialogKind::SavePath => "Save the camera path",
        DialogKind::ExportTo(_) => "Export to",
        DialogKind::ExportFolder => "Folder of the pictures",
        DialogKind::SaveReport(_) => "Save the benchmark",
    };
    dialog = dialog.set_title(title);
    match kind {
        DialogKind::OpenFiles | DialogKind::CompareFiles => dialog
            .add_filter(
                "Point clouds",
                &io::supported_extensions().collect::<Vec<_>>(),
            )
            .add_filter("All files", &["*"])
            .pick_files(),
        DialogKind::OpenFolder | DialogKind::CompareFolder | DialogKind::ExportFolder => {
            one(dialog.pick_folder())
        }
        DialogKind::SavePicture => one(dialog.add_filter("PNG image", &["png"]).save_file()),
        DialogKind::OpenPath => one(dialog.add_filter("Camera path", &["json"]).pick_file()),
        DialogKind::SavePath => one(dialog.add_filter("Camera path", &["json"]).save_file()),
        DialogKind::ExportTo(extension) => one(dialog
            .add_filter(extension.to_uppercase(), &[extension])
            .save_file()),
        DialogKind::SaveReport(format) => one(dialog
            .add_filter(format.name(), &[format.extension()])
            .save_file()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_picture_replaces_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let image = image::RgbaImage::from_pixel(3, 2, image::Rgba([1, 2, 3, 255]));
        let first = save_new_png(&image, folder.path(), "frame 7").unwrap();
        let second = save_new_png(&image, folder.path(), "frame 7").unwrap();
        assert_eq!(first, folder.path().join("frame 7.png"));
        assert_eq!(second, folder.path().join("frame 7-2.png"));
        assert_eq!(image::open(&second).unwrap().to_rgba8(), image);
    }

    #[test]
    fn a_folder_that_is_not_there_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let image = image::RgbaImage::new(1, 1);
        let path = folder.path().join("missing/picture.png");
        let error = save_png(&image, &path).unwrap_err();
        assert!(error.contains("picture.png"), "{error}");
        assert!(save_new_png(&image, &folder.path().join("missing"), "a").is_err());
    }

    #[test]
    fn outcomes_come_back_with_a_wake() {
        let (woken, wakes) = sync_channel(1);
        let mut tasks = Tasks::new(Arc::new(move || woken.send(()).unwrap()));
        let inputs = vec!["/nowhere/at/all.ply".into()];
        tasks.find(inputs, OpenOptions::default(), Side::A, Progress::default());
        wakes.recv().unwrap();
        let outcomes = tasks.take();
        assert!(
            matches!(&outcomes[..], [Outcome::Found { sequence: Err(_), inputs, side: Side::A }] if inputs.len() == 1),
            "{outcomes:?}"
        );
    }
}
