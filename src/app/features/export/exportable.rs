//! Exportable content under the present settings, and its availability.

use super::choices::{Export, ExportSubject, USUAL_RATE};
use crate::app::features::camera_path::Draft;
use crate::export::{ExportError, FRAME_PLACEHOLDER, VideoFormat, VideoStream, check_size, has_ffmpeg, numbered};
use crate::timeline::Clock;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Content available for export.
#[derive(Debug, Clone)]
pub(in crate::app) struct Exportable {
    /// Clock of the open sequence, if there is one.
    pub(in crate::app) clock: Option<Clock>,
    /// File stem of the open input, for names of files.
    pub(in crate::app) stem: String,
    /// The camera path.
    pub(in crate::app) path: Arc<Draft>,
    /// Width and height of the image in the window.
    pub(in crate::app) window_px: [u32; 2],
    /// Another export is under way.
    pub(in crate::app) is_busy: bool,
}

impl Export {
    /// Opens the export settings, for `subject` if one is named. Files are checked again.
    pub(in crate::app) fn begin(
        &mut self,
        subject: Option<ExportSubject>,
        folder: impl FnOnce() -> PathBuf,
        clock: Option<&Clock>,
    ) {
        self.has_ffmpeg = has_ffmpeg();
        self.taken = None;
        if self.folder.is_empty() {
            self.folder = folder().display().to_string();
        }
        self.choose(subject.unwrap_or(self.subject), clock);
    }

    /// Chooses the subject of the export; the rate becomes its default.
    pub(in crate::app) fn choose(&mut self, subject: ExportSubject, clock: Option<&Clock>) {
        let of_sequence = clock.map(|clock| clock.fps() * clock.speed().abs());
        self.subject = subject;
        self.per_second = match subject {
            ExportSubject::Sequence => of_sequence.unwrap_or(USUAL_RATE).clamp(0.1, 50.0),
            _ => USUAL_RATE,
        };
    }

    /// Width and height of the export from a window with an image of `window_px`.
    pub(in crate::app) fn drawn_px(&self, window_px: [u32; 2]) -> [u32; 2] {
        let max_edge_px = self.max_edge_px();
        let size_px = self.size_px.unwrap_or(window_px);
        let [width, height] = size_px.map(|edge| edge.clamp(1, max_edge_px));
        match (self.size_px, self.subject) {
            // H.264 requires even dimensions.
            (None, subject) if subject != ExportSubject::Picture => [width, height].map(|edge| (edge & !1).max(2)),
            _ => [width, height],
        }
    }

    /// The name of the file without extension, of a sequence that is known as `stem`.
    pub(in crate::app) fn file_stem(&self, stem: &str) -> String {
        self.name.clone().unwrap_or_else(|| {
            let word = self.subject.word();
            format!("pointreel-{stem}-{word}")
        })
    }

    /// The file, or with [`FRAME_PLACEHOLDER`] the files.
    pub(in crate::app) fn output(&self, stem: &str) -> PathBuf {
        Path::new(&self.folder).join(self.file_stem(stem) + self.suffix())
    }

    /// Returns the number of images to be exported, approximate where time stamps define how long frames last.
    pub(in crate::app) fn picture_count(&self, of: &Exportable) -> usize {
        match self.subject {
            ExportSubject::Picture => 1,
            ExportSubject::Turntable => self.pictures,
            ExportSubject::Path => {
                let path = of.path.path();
                path.map_or(0, |path| path.picture_count(self.per_second))
            }
            ExportSubject::Sequence => of.clock.as_ref().map_or(0, |clock| {
                let frames = clock.range().of(clock.frame_count()).len() as f64;
                let seconds = frames / (clock.fps() * clock.speed().abs());
                (seconds * self.per_second).round().max(1.0) as usize
            }),
        }
    }

    /// Why it cannot be exported as it was chosen; `None` if it can.
    pub(in crate::app) fn problem(&self, of: &Exportable) -> Option<String> {
        let name = self.file_stem(&of.stem);
        let has_frame = |text: &str| text.contains(FRAME_PLACEHOLDER);
        if of.clock.is_none() {
            Some("No sequence is open".to_owned())
        } else if of.is_busy {
            Some("Another export is under way".to_owned())
        } else if name.trim().is_empty() || name.contains(['/', '\\']) {
            Some("The name is empty or has a / or \\".to_owned())
        } else if has_frame(&name) || has_frame(&self.folder) {
            Some(format!(
                "{FRAME_PLACEHOLDER} is where the numbers go: choose another name"
            ))
        } else if self.subject == ExportSubject::Path && of.path.path().is_none() {
            Some("The camera path has no keyframes yet: K sets one".to_owned())
        } else {
            self.check(of).err().map(|error| error.to_string())
        }
    }

    fn check(&self, of: &Exportable) -> Result<(), ExportError> {
        let size_px = self.drawn_px(of.window_px);
        if self.subject == ExportSubject::Picture {
            return check_size(size_px);
        }
        if self.format == VideoFormat::Mp4 && !self.has_ffmpeg {
            return Err(ExportError::NoFfmpeg);
        }
        self.format.check(&VideoStream {
            size_px,
            per_second: self.per_second,
            count: self.picture_count(of),
            is_transparent: self.has_alpha(),
        })
    }

    /// Returns true if a file with the name exists already. Checked when the name changes.
    pub(in crate::app) fn replaces(&mut self, of: &Exportable) -> bool {
        let output = numbered(&self.output(&of.stem), 0, self.picture_count(of));
        match &self.taken {
            Some((known, is_taken)) if *known == output => *is_taken,
            _ => {
                let is_taken = output.exists();
                self.taken = Some((output, is_taken));
                is_taken
            }
        }
    }

    /// Takes the folder, or the file, that was chosen with a dialog.
    pub(in crate::app) fn take_place(&mut self, is_folder: bool, place: &Path) {
        let folder = if is_folder {
            place
        } else {
            let stem = place.file_stem().unwrap_or_default();
            self.name = Some(stem.to_string_lossy().into_owned());
            place.parent().unwrap_or(place)
        };
        self.folder = folder.display().to_string();
        self.taken = None;
    }
}
