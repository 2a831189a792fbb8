//! Export of images and videos from the window: start and end.

use super::Export;
use super::panel::{ExportRequest, export_ui};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group, needs_sequence};
use crate::app::features::export::job::{ExportJob, Shows, run};
use crate::app::features::export::{ExportEnded, ExportSubject, Exportable};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::open_panels::PanelId;
use crate::app::panel_row::PanelRow;
use crate::app::state::Dialog;
use crate::app::state::State;
use crate::app::work::files::picture_folder;
use crate::app::work::outcome::Outcome;
use crate::app::work::works::WorkKind;
use crate::composition::ComposeOptions;
use crate::convert::SourceFiles;
use crate::export::{ExportError, PictureSize, VideoFormat};
use crate::playback::Player;
use crate::scene::CameraPath;
use crate::sequence::LoaderOptions;
use egui::Key;
use egui::Ui;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// The program does not wait longer for an export that was cancelled.
const LAST_WAIT: Duration = Duration::from_secs(2);

impl State {
    /// Shows the choices, of `subject` if one is named, or closes them.
    pub(in crate::app) fn toggle_export(&mut self, subject: Option<ExportSubject>) {
        let is_open = subject.is_some() || !self.panels.has(PanelId::EXPORT);
        self.panels.set(PanelId::EXPORT, is_open);
        if is_open {
            let clock = self.player.as_ref().map(Player::clock);
            self.features.export.begin(subject, picture_folder, clock);
        }
    }

    /// Shows the choices of a video in this format.
    fn export_video(&mut self, subject: ExportSubject, format: VideoFormat) {
        self.toggle_export(Some(subject));
        self.features.export.format = format;
    }

    /// Chooses the subject of the export; the rate becomes its default.
    pub fn choose_export(&mut self, subject: ExportSubject) {
        let clock = self.player.as_ref().map(Player::clock);
        self.features.export.choose(subject, clock);
    }

    /// Returns the content available for export.
    pub(in crate::app) fn exportable(&self) -> Exportable {
        Exportable {
            clock: self.player.as_ref().map(Player::clock).cloned(),
            stem: self.sequence_stem(),
            path: Arc::clone(&self.features.path.draft),
            window_px: self.viewport.size_px,
            is_busy: self.shared.works.has(WorkKind::Export),
        }
    }

    /// Width and height of the export.
    pub fn export_size_px(&self) -> [u32; 2] {
        self.features.export.drawn_px(self.viewport.size_px)
    }

    /// The file, or with `{frame}` the files.
    pub fn export_output(&self) -> PathBuf {
        self.features.export.output(&self.sequence_stem())
    }

    /// Why it cannot be exported as it was chosen; `None` if it can.
    pub fn export_problem(&self) -> Option<String> {
        self.features.export.problem(&self.exportable())
    }

    /// Asks for the place of the file.
    pub(in crate::app) fn ask_for_place(&mut self) {
        let name = self.features.export.file_stem(&self.sequence_stem());
        let to_file = |extension: &'static str| {
            let take = |state: &mut Self, place: PathBuf| state.features.export.take_place(false, &place);
            let name = format!("{name}.{extension}");
            Dialog::new_file("Export to", name, take).filter(extension.to_uppercase(), [extension])
        };
        let dialog = match (self.features.export.subject, self.features.export.format) {
            (ExportSubject::Picture, _) => to_file("png"),
            (_, VideoFormat::PngFiles) => {
                let take = |state: &mut Self, place: PathBuf| state.features.export.take_place(true, &place);
                Dialog::folder("Folder of the images", take).named(name)
            }
            (_, VideoFormat::Gif) => to_file("gif"),
            (_, VideoFormat::Webp) => to_file("webp"),
            (_, VideoFormat::Mp4) => to_file("mp4"),
        };
        self.ask(dialog.without("Write folder and name into the fields"));
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
                .error(format!("{name} is a file of the open sequence: choose another name"));
        }
        let name = job.output.file_name().unwrap_or_default();
        let name = format!("Exporting {}", name.to_string_lossy());
        let progress = self.shared.works.begin(WorkKind::Export, name, self.shared.now);
        self.panels.set(PanelId::EXPORT, false);
        self.shared
            .tasks
            .start("export", move || ExportEnded(run(job, &progress)));
    }

    fn export_job(&self) -> Option<ExportJob> {
        let player = self.player.as_ref()?;
        let export = &self.features.export;
        Some(ExportJob {
            sequence: Arc::clone(player.sequence()),
            style: self.style_of_export(),
            renderer: self.main.renderer(self.style.drawing.renderer),
            options: self.compose_options(),
            labels: self.features.labels.shown(),
            shows: self.shown_by_export(player)?,
            per_second: export.per_second,
            size: PictureSize {
                is_transparent: export.has_alpha(),
                has_legend: export.has_legend,
                has_scale_bar: export.has_scale_bar,
                ..PictureSize::opaque(self.export_size_px())
            },
            output: self.export_output(),
            now: self.shared.now,
            budget_bytes: LoaderOptions::default().budget_bytes / 2,
        })
    }

    fn shown_by_export(&self, player: &Player) -> Option<Shows> {
        let (export, camera, turns) = (&self.features.export, self.camera, self.features.export.turns);
        let frame = player.waiting_for().unwrap_or(player.clock().frame());
        let clock = player.clock().clone();
        Some(match export.subject {
            ExportSubject::Picture => Shows::Picture { camera, frame },
            ExportSubject::Path => Shows::Path(Box::new(self.features.path.draft.path()?.clone())),
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

    /// Returns the compose options: derived frames that add to the image on the screen. Trails that are still being
    /// computed are not there yet.
    fn compose_options(&self) -> ComposeOptions {
        let trails = self.features.trails.found();
        ComposeOptions {
            trails: trails.map(|trails| (Arc::new(trails.clone()), self.features.trails.looks())),
            skipped_photos: self.features.photos.skipped(),
            ..self.features.temporal.options()
        }
    }

    /// Cancels exports and saving as the program ends, and waits briefly until partial files are removed.
    pub(in crate::app) fn end_exports(&mut self) {
        let begun = Instant::now();
        let kinds = [WorkKind::Export, WorkKind::Save];
        for kind in kinds {
            self.shared.works.cancel(kind);
        }
        while kinds.iter().any(|&kind| self.shared.works.has(kind)) && begun.elapsed() < LAST_WAIT {
            thread::sleep(Duration::from_millis(5));
            self.shared.works.look(self.shared.now, self.shared.now);
        }
    }

    /// Reports the result of an export.
    pub(in crate::app) fn export_has_ended(&mut self, ExportEnded(result): ExportEnded) {
        self.features.export.taken = None;
        match result {
            Ok(exported) => {
                let place = exported.output.display();
                self.notices.info(match exported.pictures {
                    1 => format!("Exported {place}"),
                    count => format!("Exported {count} images: {place}"),
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

const COMMANDS: &[Row] = &[
    Row::new(Command::TOGGLE_EXPORT, "Export…", |state| state.toggle_export(None))
        .what("Export an image or a video…")
        .hint("Images of any size, turntables, camera paths and the sequence as videos")
        .also(&[
            "render",
            "record screen",
            "screen recording",
            "make movie",
            "animation",
            "save video",
            "render image",
            "high resolution image",
            "poster",
            "4k",
            "png",
        ])
        .keys(group::FILE, "Shift+P", &[Chord::shift(Key::P)])
        .applies(needs_sequence),
    Row::new(Command::EXPORT_PATH, "Export the camera path", |state| {
        state.toggle_export(Some(ExportSubject::Path));
    })
    .what("Export the camera path as a video…")
    .also(&["fly-through", "animation", "flight", "movie"]),
    Row::new(Command::new("export mp4"), "Export as MP4…", |state| {
        state.export_video(ExportSubject::Sequence, VideoFormat::Mp4);
    })
    .what("Export video as MP4…")
    .also(&["movie", "record", "h264", "avi", "render animation"])
    .applies(needs_sequence),
    Row::new(Command::new("export gif"), "Export as GIF…", |state| {
        state.export_video(ExportSubject::Sequence, VideoFormat::Gif);
    })
    .what("Export video as GIF…")
    .also(&["animated image", "record"])
    .applies(needs_sequence),
    Row::new(Command::new("export webp"), "Export as WebP…", |state| {
        state.export_video(ExportSubject::Sequence, VideoFormat::Webp);
    })
    .what("Export video as WebP…")
    .applies(needs_sequence),
    Row::new(Command::new("export images"), "Export as numbered images…", |state| {
        state.export_video(ExportSubject::Sequence, VideoFormat::PngFiles);
    })
    .what("Export every frame as a PNG image…")
    .also(&["image sequence", "png files", "frames to images"])
    .applies(needs_sequence),
    Row::new(Command::new("export turntable"), "Export a turntable…", |state| {
        state.toggle_export(Some(ExportSubject::Turntable));
    })
    .what("Export a turntable video…")
    .also(&["spin video", "360", "orbit video", "rotating gif"])
    .applies(needs_sequence),
    Row::new(
        Command::new("export transparent"),
        "Export with transparent background…",
        |state| {
            state.toggle_export(Some(ExportSubject::Picture));
            state.features.export.is_transparent = true;
        },
    )
    .what("Background: transparent, in an exported image…")
    .also(&["alpha channel", "no background", "remove background", "cut out"])
    .applies(needs_sequence),
];

impl Feature<State> for FeatureOf<Export> {
    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|ended: ExportEnded| state.export_has_ended(ended))
    }

    fn loss(&self, state: &State) -> Option<&'static str> {
        let is_under_way = state.shared.works.has(WorkKind::Export);
        is_under_way.then_some("An export is under way: it would be cancelled.")
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::window(PanelId::EXPORT, export)];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn export(ui: &mut Ui, state: &mut State) {
    let of = state.exportable();
    let top = state.viewport.rect.center_top();
    let mut is_open = state.panels.has(PanelId::EXPORT);
    let request = export_ui(ui, &mut is_open, &mut state.features.export, &of, top);
    state.panels.set(PanelId::EXPORT, is_open);
    match request {
        Some(ExportRequest::ChoosePlace) => state.ask_for_place(),
        Some(ExportRequest::Start) => state.start_export(),
        None => {}
    }
}
