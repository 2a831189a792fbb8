//! Pictures and videos out of the window: whether what a person chose can be done, and the beginning and the end of it.

mod choices;
mod job;
mod plan;

pub use choices::{Export, Subject};
pub use job::Exported;

use super::State;
use super::progress::WorkKind;
use super::state::picture_folder;
use super::tasks::{DialogKind, Outcome};
use crate::export::{
    ChangeColors, ExportError, FRAME_PLACEHOLDER, PictureSize, Poses, VideoFormat, VideoStream,
    check_size, has_ffmpeg, numbered,
};
use crate::playback::Player;
use crate::scene::CameraPath;
use crate::sequence::LoaderOptions;
use choices::USUAL_RATE;
use job::{Job, Shows};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// The program does not wait longer for an export that was cancelled.
const LAST_WAIT: Duration = Duration::from_secs(2);

impl State {
    /// Shows the choices, of `subject` if one is named, or closes them.
    pub(super) fn toggle_export(&mut self, subject: Option<Subject>) {
        self.panels.export = subject.is_some() || !self.panels.export;
        if self.panels.export {
            self.export.has_ffmpeg = has_ffmpeg();
            self.export.taken = None;
            if self.export.folder.is_empty() {
                self.export.folder = picture_folder().display().to_string();
            }
            self.choose_export(subject.unwrap_or(self.export.subject));
        }
    }

    /// Chooses what is exported; the rate becomes the usual one of that.
    pub fn choose_export(&mut self, subject: Subject) {
        let clock = self.player.as_ref().map(Player::clock);
        let of_sequence = clock.map(|clock| clock.fps() * clock.speed().abs());
        self.export.subject = subject;
        self.export.per_second = match subject {
            Subject::Sequence => of_sequence.unwrap_or(USUAL_RATE).clamp(0.1, 50.0),
            _ => USUAL_RATE,
        };
    }

    /// Width and height of what is exported.
    pub fn export_size_px(&self) -> [u32; 2] {
        let max_edge_px = self.export.max_edge_px();
        let size_px = self.export.size_px.unwrap_or(self.viewport.size_px);
        let [width, height] = size_px.map(|edge| edge.clamp(1, max_edge_px));
        match (self.export.size_px, self.export.subject) {
            // H.264 has even edges.
            (None, subject) if subject != Subject::Picture => {
                [width, height].map(|edge| (edge & !1).max(2))
            }
            _ => [width, height],
        }
    }

    /// The name of the file without extension.
    pub fn export_name(&self) -> String {
        self.export.name.clone().unwrap_or_else(|| {
            let word = self.export.subject.word();
            format!("pointreel-{}-{word}", self.sequence_stem())
        })
    }

    /// The file, or with [`FRAME_PLACEHOLDER`] the files.
    pub fn export_output(&self) -> PathBuf {
        let name = self.export_name() + self.export.suffix();
        Path::new(&self.export.folder).join(name)
    }

    /// How many pictures there will be, nearly where time stamps say how long frames last.
    pub(super) fn export_picture_count(&self) -> usize {
        let export = &self.export;
        match export.subject {
            Subject::Picture => 1,
            Subject::Turntable => export.pictures,
            Subject::Path => {
                let path = self.path.draft.path();
                path.map_or(0, |path| path.picture_count(export.per_second))
            }
            Subject::Sequence => self.player.as_ref().map_or(0, |player| {
                let clock = player.clock();
                let frames = clock.range().of(clock.frame_count()).len() as f64;
                let seconds = frames / (clock.fps() * clock.speed().abs());
                (seconds * export.per_second).round().max(1.0) as usize
            }),
        }
    }

    /// Why it cannot be exported as it was chosen; `None` if it can.
    pub fn export_problem(&self) -> Option<String> {
        let export = &self.export;
        let name = self.export_name();
        let has_frame = |text: &str| text.contains(FRAME_PLACEHOLDER);
        if self.player.is_none() {
            Some("No sequence is open".to_owned())
        } else if self.works.has(WorkKind::Export) {
            Some("Another export is under way".to_owned())
        } else if name.trim().is_empty() || name.contains(['/', '\\']) {
            Some("The name is empty or has a / or \\".to_owned())
        } else if has_frame(&name) || has_frame(&export.folder) {
            Some(format!(
                "{FRAME_PLACEHOLDER} is where the numbers go: choose another name"
            ))
        } else if export.subject == Subject::Path && self.path.draft.path().is_none() {
            Some("The camera path has no keyframes yet: K sets one".to_owned())
        } else {
            self.check_export().err().map(|error| error.to_string())
        }
    }

    fn check_export(&self) -> Result<(), ExportError> {
        let export = &self.export;
        let size_px = self.export_size_px();
        if export.subject == Subject::Picture {
            return check_size(size_px);
        }
        if export.format == VideoFormat::Mp4 && !export.has_ffmpeg {
            return Err(ExportError::NoFfmpeg);
        }
        export.format.check(&VideoStream {
            size_px,
            per_second: export.per_second,
            count: self.export_picture_count(),
            is_transparent: export.has_alpha(),
        })
    }

    /// Whether a file has the name already. Looked for when the name changes.
    pub(super) fn export_replaces(&mut self) -> bool {
        let output = numbered(&self.export_output(), 0, self.export_picture_count());
        match &self.export.taken {
            Some((known, is_taken)) if *known == output => *is_taken,
            _ => {
                let is_taken = output.exists();
                self.export.taken = Some((output, is_taken));
                is_taken
            }
        }
    }

    /// Asks for the place of the file.
    pub(super) fn ask_for_place(&mut self) {
        let name = self.export_name();
        let (dialog, name) = match (self.export.subject, self.export.format) {
            (Subject::Picture, _) => (DialogKind::ExportTo("png"), name + ".png"),
            (_, VideoFormat::PngFiles) => (DialogKind::ExportFolder, name),
            (_, VideoFormat::Gif) => (DialogKind::ExportTo("gif"), name + ".gif"),
            (_, VideoFormat::Webp) => (DialogKind::ExportTo("webp"), name + ".webp"),
            (_, VideoFormat::Mp4) => (DialogKind::ExportTo("mp4"), name + ".mp4"),
        };
        self.tasks.ask(dialog, Some(name));
    }

    /// Takes the place that was chosen with a dialog.
    pub(super) fn take_place(&mut self, dialog: DialogKind, place: &Path) {
        let folder = if dialog == DialogKind::ExportFolder {
            place
        } else {
            let stem = place.file_stem().unwrap_or_default();
            self.export.name = Some(stem.to_string_lossy().into_owned());
            place.parent().unwrap_or(place)
        };
        self.export.folder = folder.display().to_string();
        self.export.taken = None;
    }

    /// Begins the export on a thread, with everything as it is now.
    pub fn start_export(&mut self) {
        if let Some(problem) = self.export_problem() {
            return self.notices.error(problem);
        }
        let Some(job) = self.export_job() else { return };
        let name = job.output.file_name().unwrap_or_default();
        let name = format!("Exporting {}", name.to_string_lossy());
        let progress = self.works.begin(WorkKind::Export, name, self.now());
        self.panels.export = false;
        self.tasks.start("export", move || {
            Outcome::Exported(job::run(job, &progress))
        });
    }

    fn export_job(&self) -> Option<Job> {
        let player = self.player.as_ref()?;
        let export = &self.export;
        let camera = self.camera;
        let frame = player.waiting_for().unwrap_or(player.clock().frame());
        let clock = player.clock().clone();
        let shows = match export.subject {
            Subject::Picture => Shows::Picture { camera, frame },
            Subject::Path => Shows::Path(self.path.draft.path()?.clone()),
            Subject::Turntable if export.holds_frame => {
                let pictures = [export.pictures as f64, export.per_second];
                let path =
                    CameraPath::turntable(camera, export.turns, pictures, [frame as f64, 0.0]);
                Shows::Path(path.ok()?)
            }
            Subject::Turntable => Shows::Turntable {
                camera,
                turns: export.turns,
                pictures: export.pictures,
                clock,
            },
            Subject::Sequence => Shows::Sequence { camera, clock },
        };
        Some(Job {
            sequence: Arc::clone(player.sequence()),
            settings: self.settings_of_export(),
            poses: self.poses_of_export(),
            shows,
            per_second: export.per_second,
            size: PictureSize {
                is_transparent: export.has_alpha(),
                has_legend: export.has_legend,
                has_scale_bar: export.has_scale_bar,
                ..PictureSize::opaque(self.export_size_px())
            },
            output: self.export_output(),
            now: self.now(),
            budget_bytes: LoaderOptions::default().budget_bytes / 2,
        })
    }

    /// What other poses add to the picture on the screen. Trails that are still being found are not there yet.
    fn poses_of_export(&self) -> Poses {
        let change = Some(self.temporal.change).filter(|change| change.is_on);
        Poses {
            change: change.map(|change| ChangeColors {
                step: change.step,
                range: change.range,
            }),
            onion: Some(self.temporal.onion).filter(|onion| onion.is_on),
            trails: self
                .trails
                .found()
                .map(|trails| (trails.clone(), self.trails.looks())),
        }
    }

    /// Cancels exports as the program ends, and waits a moment until what is not whole is removed.
    pub(super) fn end_exports(&mut self) {
        let begun = Instant::now();
        self.works.cancel(WorkKind::Export);
        while self.works.has(WorkKind::Export) && begun.elapsed() < LAST_WAIT {
            thread::sleep(Duration::from_millis(5));
            self.works.look(self.now(), self.now());
        }
    }

    /// Says what came of an export.
    pub(super) fn export_has_ended(&mut self, result: Result<Exported, ExportError>) {
        self.export.taken = None;
        match result {
            Ok(exported) => {
                let place = exported.output.display();
                self.notices.info(match exported.pictures {
                    1 => format!("Exported {place}"),
                    count => format!("Exported {count} pictures: {place}"),
                });
                for failure in exported.failed.into_iter().take(3) {
                    self.notices.warn(failure);
                }
            }
            Err(ExportError::Cancelled) => self
                .notices
                .info("The export was cancelled, nothing was written"),
            Err(error) => self.notices.error(format!("Nothing was exported: {error}")),
        }
    }
}
