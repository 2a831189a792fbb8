//! Pictures and videos out of the window: the beginning and the end of an export.

use super::State;
use super::dialogs::DialogKind;
use crate::app::features::export::job::{ExportJob, Shows, run};
use crate::app::features::export::{ExportEnded, ExportSubject, Exportable};
use crate::app::open_panels::PanelId;
use crate::app::work::files::picture_folder;
use crate::app::work::works::WorkKind;
use crate::composition::ComposeOptions;
use crate::convert::SourceFiles;
use crate::export::{ExportError, PictureSize, VideoFormat};
use crate::playback::Player;
use crate::scene::CameraPath;
use crate::sequence::LoaderOptions;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// The program does not wait longer for an export that was cancelled.
const LAST_WAIT: Duration = Duration::from_secs(2);

impl State {
    /// Shows the choices, of `subject` if one is named, or closes them.
    pub(super) fn toggle_export(&mut self, subject: Option<ExportSubject>) {
        let is_open = subject.is_some() || !self.panels.has(PanelId::EXPORT);
        self.panels.set(PanelId::EXPORT, is_open);
        if is_open {
            let clock = self.player.as_ref().map(Player::clock);
            self.export.begin(subject, picture_folder, clock);
        }
    }

    /// Chooses what is exported; the rate becomes the usual one of that.
    pub fn choose_export(&mut self, subject: ExportSubject) {
        let clock = self.player.as_ref().map(Player::clock);
        self.export.choose(subject, clock);
    }

    /// What there is to export.
    pub(in crate::app) fn exportable(&self) -> Exportable {
        Exportable {
            clock: self.player.as_ref().map(Player::clock).cloned(),
            stem: self.sequence_stem(),
            path: Arc::clone(&self.path.draft),
            window_px: self.viewport.size_px,
            is_busy: self.works.has(WorkKind::Export),
        }
    }

    /// Width and height of what is exported.
    pub fn export_size_px(&self) -> [u32; 2] {
        self.export.drawn_px(self.viewport.size_px)
    }

    /// The file, or with `{frame}` the files.
    pub fn export_output(&self) -> PathBuf {
        self.export.output(&self.sequence_stem())
    }

    /// Why it cannot be exported as it was chosen; `None` if it can.
    pub fn export_problem(&self) -> Option<String> {
        self.export.problem(&self.exportable())
    }

    /// Asks for the place of the file.
    pub(in crate::app) fn ask_for_place(&mut self) {
        let name = self.export.file_stem(&self.sequence_stem());
        let (dialog, name) = match (self.export.subject, self.export.format) {
            (ExportSubject::Picture, _) => (DialogKind::ExportTo("png"), name + ".png"),
            (_, VideoFormat::PngFiles) => (DialogKind::ExportFolder, name),
            (_, VideoFormat::Gif) => (DialogKind::ExportTo("gif"), name + ".gif"),
            (_, VideoFormat::Webp) => (DialogKind::ExportTo("webp"), name + ".webp"),
            (_, VideoFormat::Mp4) => (DialogKind::ExportTo("mp4"), name + ".mp4"),
        };
        self.ask(dialog, Some(name));
    }

    /// Begins the export on a thread, with everything as it is now.
    pub fn start_export(&mut self) {
        if let Some(problem) = self.export_problem() {
            return self.notices.error(problem);
        }
        let Some(job) = self.export_job() else { return };
        if SourceFiles::of(&job.sequence).has(&job.output) {
            let name = job.output.display();
            return self
                .notices
                .error(format!("{name} is a file of what is open: choose another name"));
        }
        let name = job.output.file_name().unwrap_or_default();
        let name = format!("Exporting {}", name.to_string_lossy());
        let progress = self.works.begin(WorkKind::Export, name, self.now);
        self.panels.set(PanelId::EXPORT, false);
        self.tasks.start("export", move || ExportEnded(run(job, &progress)));
    }

    fn export_job(&self) -> Option<ExportJob> {
        let player = self.player.as_ref()?;
        let export = &self.export;
        Some(ExportJob {
            sequence: Arc::clone(player.sequence()),
            style: self.style_of_export(),
            renderer: self.main.renderer(self.style.drawing.renderer),
            options: self.compose_options(),
            labels: self.labels.shown(),
            shows: self.shown_by_export(player)?,
            per_second: export.per_second,
            size: PictureSize {
                is_transparent: export.has_alpha(),
                has_legend: export.has_legend,
                has_scale_bar: export.has_scale_bar,
                ..PictureSize::opaque(self.export_size_px())
            },
            output: self.export_output(),
            now: self.now,
            budget_bytes: LoaderOptions::default().budget_bytes / 2,
        })
    }

    fn shown_by_export(&self, player: &Player) -> Option<Shows> {
        let (export, camera, turns) = (&self.export, self.camera, self.export.turns);
        let frame = player.waiting_for().unwrap_or(player.clock().frame());
        let clock = player.clock().clone();
        Some(match export.subject {
            ExportSubject::Picture => Shows::Picture { camera, frame },
            ExportSubject::Path => Shows::Path(Box::new(self.path.draft.path()?.clone())),
            ExportSubject::Turntable if export.holds_frame => {
                let pictures = [export.pictures as f64, export.per_second];
                let path = CameraPath::turntable(camera, turns, pictures, [frame as f64, 0.0]);
                Shows::Path(Box::new(path.ok()?))
            }
            ExportSubject::Turntable => Shows::Turntable {
                camera,
                turns,
                pictures: export.pictures,
                clock,
            },
            ExportSubject::Sequence => Shows::Sequence { camera, clock },
        })
    }

    /// What other poses add to the picture on the screen. Trails that are still being found are not there yet.
    fn compose_options(&self) -> ComposeOptions {
        let trails = self.trails.found();
        ComposeOptions {
            trails: trails.map(|trails| (Arc::new(trails.clone()), self.trails.looks())),
            left_out_photos: self.photos.left_out(),
            ..self.temporal.options()
        }
    }

    /// Cancels exports and saving as the program ends, and waits a moment until what is not whole is removed.
    pub(in crate::app) fn end_exports(&mut self) {
        let begun = Instant::now();
        let kinds = [WorkKind::Export, WorkKind::Save];
        for kind in kinds {
            self.works.cancel(kind);
        }
        while kinds.iter().any(|&kind| self.works.has(kind)) && begun.elapsed() < LAST_WAIT {
            thread::sleep(Duration::from_millis(5));
            self.works.look(self.now, self.now);
        }
    }

    /// Says what came of an export.
    pub(super) fn export_has_ended(&mut self, ExportEnded(result): ExportEnded) {
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
            Err(ExportError::Cancelled) => self.notices.info("The export was cancelled, nothing was written"),
            Err(error) => self.notices.error(format!("Nothing was exported: {error}")),
        }
    }
}
