//! What keys, menus, dialogs and tasks do to the state.

use super::{State, WindowRequest};
use crate::app::benchmark::{Benchmark, BenchmarkJob, benchmark_job};
use crate::app::camera_path::Question;
use crate::app::command::{self, Command};
use crate::app::comparison::{Comparison, Side};
use crate::app::export::Subject;
use crate::app::history::Edited;
use crate::app::palette::Palette;
use crate::app::tasks::{DialogKind, Outcome, PicturePlace, ReportFormat};
use crate::bench::{LabPoint, Quality, QualityKey, Suite};
use crate::playback::Player;
use crate::scene::{Primitive, RendererChoice, Settings};
use crate::sequence::{Sequence, SequenceError};
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED, PlayRange};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The speeds that the keys step through.
const SPEEDS: [f64; 9] = [0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0];

/// The keys change sizes by this factor.
const SIZE_STEP: f32 = 1.25;

/// Bounds of splat scale and of point size in pixels.
pub(in crate::app) const SPLAT_SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.1..=10.0;
pub(in crate::app) const POINT_SIZE_RANGE_PX: std::ops::RangeInclusive<f32> = 1.0..=32.0;

impl State {
    pub(super) fn take_in(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Found {
                inputs,
                sequence,
                side,
            } => match sequence {
                Ok(sequence) => {
                    match side {
                        Side::A => self.open(sequence),
                        Side::B => self.compare_with(sequence),
                    }
                    if let Err(problem) = self.recent.add(&inputs) {
                        self.notices.warn(problem);
                    }
                }
                Err(SequenceError::Cancelled) => {}
                Err(error) => self.notices.error(error.to_string()),
            },
            Outcome::Chosen { dialog, paths } => self.chosen(dialog, paths),
            Outcome::Cancelled => {}
            Outcome::NoDialog => self.notices.error(
                "No file dialog could be opened: on Linux one needs xdg-desktop-portal or zenity. \
                 Drop files or a folder on the window, or name them on the command line: pointreel view FOLDER",
            ),
            Outcome::Saved(path) => self.notices.info(format!("Saved {}", path.display())),
            Outcome::PathRead { file, draft } => self.take_path(draft, Some(file)),
            Outcome::PathSaved { file, draft } => self.path_is_saved(file, draft),
            Outcome::Exported(result) => self.export_has_ended(result),
            Outcome::Benchmark(result) => {
                self.benchmark.finish(result);
                self.learn_quality();
            }
            Outcome::Compared(difference) => {
                if let Some(pictures) = self.pictures_mut() {
                    pictures.take_in(difference);
                }
            }
            Outcome::Distances(distances) => {
                if let (Some(beside), Some(distances)) = (&mut self.beside, distances) {
                    beside.take_in(distances);
                }
            }
            Outcome::MadeFrame(made) => {
                if let Some(made) = made {
                    self.temporal.take_in(*made);
                }
            }
            Outcome::Traced(traced) => self.trails.take_in(traced),
            Outcome::Levels(frame) => {
                self.drawing.take_levels(&frame);
                if let Some(beside) = &mut self.beside {
                    beside.drawing.take_levels(&frame);
                }
            }
            Outcome::InView(made) => {
                self.drawing.take_surfels_in_view(&made);
                if let Some(beside) = &mut self.beside {
                    beside.drawing.take_surfels_in_view(&made);
                }
            }
            Outcome::Looked(more) => self.take_more(*more),
            Outcome::Thumbnail(delivery) => self.thumbnails.take_in(*delivery),
            Outcome::Failed(text) => self.notices.error(text),
        }
    }

    fn chosen(&mut self, dialog: DialogKind, paths: Vec<PathBuf>) {
        let first = paths[0].clone();
        match dialog {
            DialogKind::OpenFiles | DialogKind::OpenFolder => {
                self.open_paths(paths);
            }
            DialogKind::CompareFiles | DialogKind::CompareFolder => self.compare_paths(paths),
            DialogKind::SavePicture => {
                self.requests
                    .push(WindowRequest::Screenshot(Some(with_extension(
                        first, "png",
                    ))));
            }
            DialogKind::OpenPath => self.open_path(first),
            DialogKind::SavePath => self.save_path_to(with_extension(first, "json")),
            DialogKind::ExportTo(_) | DialogKind::ExportFolder => self.take_place(dialog, &first),
            DialogKind::SaveReport(format) => {
                let Benchmark::Done(table) = &self.benchmark else {
                    return;
                };
                let text = match format {
                    ReportFormat::Json => &table.json,
                    ReportFormat::Csv => &table.csv,
                    ReportFormat::Html => &table.html,
                };
                let file = with_extension(first, format.extension());
                self.tasks.save(file, text.clone().into_bytes());
            }
        }
    }

    /// Moves the camera until all points are seen, and those beside them, keeping its direction.
    pub fn frame_all(&mut self) {
        if let Some(camera) = self.all_framed(&self.bounds_beside()) {
            self.glide_to(camera);
        }
    }

    /// Does what a key or menu asks for.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::TogglePlay => self.play_with(Player::toggle),
            Command::Step(count) => self.play_with(|player, now| player.step(count, now)),
            Command::First => self.play_with(|player, now| player.seek(0, now)),
            Command::Last => self.play_with(|player, now| player.seek(usize::MAX, now)),
            Command::ToggleFollow => self.play_with(|player, now| {
                player.follow_newest(!player.follows_newest(), now);
            }),
            Command::NextLoopMode => self.play_with(|player, now| {
                let next = next_loop_mode(player.clock().loop_mode());
                player.set_loop_mode(next, now);
            }),
            Command::Slower => {
                self.change_speed(|speed| SPEEDS.iter().rev().copied().find(|&s| s < speed - 1e-9));
            }
            Command::Faster => {
                self.change_speed(|speed| SPEEDS.iter().copied().find(|&s| s > speed + 1e-9));
            }
            Command::Reverse => {
                self.play_with(|player, now| player.set_speed(-player.clock().speed(), now));
            }
            Command::SetIn => self.set_range(PlayRange::beginning_at),
            Command::SetOut => self.set_range(PlayRange::ending_at),
            Command::ClearRange => self.set_range(|_, _| PlayRange::default()),
            Command::ToggleMarker => self.toggle_marker(),
            Command::NextMarker => self.go_to_marker(true),
            Command::PreviousMarker => self.go_to_marker(false),
            Command::ResetView => self.reset_view(),
            Command::FrameAll => self.frame_all(),
            Command::Look(preset) => self.camera.look_from(preset),
            Command::ToggleOrthographic => self.toggle_projection(),
            Command::ToggleTurntable => self.turntable.is_on ^= true,
            Command::Focus => self.focus_at_pointer(),
            Command::CopyView => self.copy_view(),
            Command::PasteView => self.requests.push(WindowRequest::PasteView),
            Command::ToggleTool(tool) => self.inspection.toggle(tool),
            Command::ToggleGrid => self.settings.grid ^= true,
            Command::ToggleScaleBar => self.shows_scale_bar ^= true,
            Command::Smaller => self.scale_size(1.0 / SIZE_STEP),
            Command::Larger => self.scale_size(SIZE_STEP),
            Command::OpenFiles => self.tasks.ask(DialogKind::OpenFiles, None),
            Command::OpenFolder => self.tasks.ask(DialogKind::OpenFolder, None),
            Command::CompareFiles => self.tasks.ask(DialogKind::CompareFiles, None),
            Command::CompareFolder => self.tasks.ask(DialogKind::CompareFolder, None),
            Command::CloseComparison => {
                self.close_beside();
                self.comparison = None;
            }
            Command::NextLayout => self.next_layout(),
            Command::OpenDemo => self.open(Arc::new(Sequence::demo())),
            Command::Screenshot => self.requests.push(WindowRequest::Screenshot(None)),
            Command::SaveScreenshotAs => {
                let name = format!("{}.png", self.picture_stem());
                self.tasks.ask(DialogKind::SavePicture, Some(name));
            }
            Command::ToggleExport => self.toggle_export(None),
            Command::ExportPath => self.toggle_export(Some(Subject::Path)),
            Command::TogglePath => self.panels.path ^= true,
            Command::AddKeyframe => self.add_keyframe(),
            Command::TogglePreview => self.toggle_preview(),
            Command::NewPath => self.ask_or_do(Question::New),
            Command::OpenPath => self.ask_or_do(Question::Open),
            Command::SavePath => self.save_path(false),
            Command::SavePathAs => self.save_path(true),
            Command::FullScreen => self.requests.push(WindowRequest::FullScreen),
            Command::ToggleSettings => self.panels.settings ^= true,
            Command::ToggleStatistics => self.panels.statistics ^= true,
            Command::ToggleComparison => self.toggle_comparison(),
            Command::Undo => {
                let before = self.history.undo();
                self.take_edited(before);
            }
            Command::Redo => {
                let after = self.history.redo();
                self.take_edited(after);
            }
            Command::ToggleTrails => self.toggle_trails(),
            Command::Theme(theme) => self.theme = theme,
            Command::ToggleLegend => self.panels.legend ^= true,
            Command::ToggleThumbnails => self.thumbnails.is_on ^= true,
            Command::RedoThumbnails => self.thumbnails.redo(),
            Command::TogglePalette => {
                self.palette = match self.palette.take() {
                    Some(_) => None,
                    None => Some(Palette::default()),
                };
            }
            Command::ToggleHelp => self.panels.help ^= true,
            Command::Escape => self.escape(),
            Command::Quit => self.ask_or_do(Question::Quit),
        }
    }

    fn toggle_trails(&mut self) {
        self.trails.is_on ^= true;
        if self.trails.is_on && self.inspection.picked().next().is_none() {
            self.notices
                .info("Pick a point (I and a click): its trail is shown");
        }
    }

    fn toggle_comparison(&mut self) {
        if self.beside.is_some() {
            let text = "Two sequences are compared: File, Close comparison ends that";
            return self.notices.info(text);
        }
        self.comparison = match self.comparison.take() {
            Some(_) => None,
            None => Some(Comparison::new(self.settings)),
        };
    }

    fn escape(&mut self) {
        let running = matches!(self.benchmark, Benchmark::Running(_));
        // The key has taken the keyboard from their fields already, so they do not see it.
        let has_closed = self.palette.take().is_some() || self.timeline.renaming.take().is_some();
        if has_closed || self.stop_preview() || self.path.question.take().is_some() {
            // One thing at a time.
        } else if self.panels.export {
            self.panels.export = false;
        } else if self.panels.help {
            self.panels.help = false;
        } else if self.panels.benchmark && !running {
            self.panels.benchmark = false;
        } else if self.inspection.escape() {
            // One thing at a time.
        } else if self.full_screen {
            self.requests.push(WindowRequest::FullScreen);
        }
    }

    /// Changes the player, if there is one, at the present time.
    pub(in crate::app) fn play_with(&mut self, change: impl FnOnce(&mut Player, Duration)) {
        if let Some(player) = &mut self.player {
            change(player, self.now);
        }
    }

    /// Takes the playhead in the hand, or lets it go: meanwhile playing rests.
    pub(in crate::app) fn play_with_scrubbing(&mut self, begin: bool) {
        let Some(player) = &mut self.player else {
            return;
        };
        if begin {
            self.scrubbing.resume = player.is_playing();
            if self.scrubbing.resume {
                player.toggle(self.now);
            }
        } else if std::mem::take(&mut self.scrubbing.resume) && !player.is_playing() {
            player.toggle(self.now);
        }
    }

    /// Measures the open sequence on a thread; playing rests, it would disturb the measurement.
    pub fn start_benchmark(&mut self, suite: Suite) {
        let Some(player) = &mut self.player else {
            return;
        };
        if player.is_playing() {
            player.toggle(self.now);
        }
        let sequence = Arc::clone(player.sequence());
        let name = self.sequence_name().unwrap_or_default();
        self.start_benchmark_job(suite.name(), benchmark_job(suite, name, sequence));
    }

    /// Shows the benchmark window and runs `job` in it.
    pub fn start_benchmark_job(&mut self, suite: &str, job: BenchmarkJob) {
        self.panels.benchmark = true;
        let at = (self.wake(), self.now);
        self.benchmark.start(suite, job, &self.tasks, at);
    }

    /// Reads what was measured of the open sequence before, once it is known what it would be kept by. True if there is
    /// something.
    pub(super) fn look_for_quality(&mut self) -> bool {
        let adapter = &self.graphics.adapter;
        let Some(player) = self.player.as_ref().filter(|_| !adapter.is_empty()) else {
            return false;
        };
        if self.quality_key.is_some() {
            return false;
        }
        let key = QualityKey::new(adapter, player.sequence());
        self.quality = Quality::read(&key);
        self.quality_key = Some(key);
        self.quality.is_some()
    }

    /// Takes over what a benchmark has found of the open sequence, and keeps it.
    fn learn_quality(&mut self) {
        let Benchmark::Done(table) = &self.benchmark else {
            return;
        };
        let points: Vec<LabPoint> = table.points.iter().map(|point| (**point).clone()).collect();
        let is_of_open = self
            .sequence_name()
            .is_some_and(|name| points.first().is_some_and(|point| point.sequence == name));
        let Some(quality) = Quality::of(&points).filter(|_| is_of_open) else {
            return;
        };
        if let Some(key) = &self.quality_key
            && let Err(reason) = quality.write(key)
        {
            log::warn!("what was measured is not kept: {reason}");
        }
        self.quality = Some(quality);
    }

    /// Looks whether settings or camera path have changed, for undo. Call after the panels.
    pub(in crate::app) fn note_settings(&mut self, ctx: &egui::Context) {
        let (is_held, seconds) = ctx.input(|input| (input.pointer.any_down(), input.time));
        let now = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        let edited = Edited {
            settings: self.settings,
            path: Arc::clone(&self.path.draft),
        };
        self.history.note(&edited, is_held, now);
    }

    fn take_edited(&mut self, edited: Option<Edited>) {
        if let Some(Edited { settings, path }) = edited {
            self.settings = settings;
            self.path.draft = path;
        }
    }

    /// Asks the window for what only it can do.
    pub(in crate::app) fn request(&mut self, request: WindowRequest) {
        self.requests.push(request);
    }

    /// How an export draws: as the window does, but at full resolution.
    pub(in crate::app) fn settings_of_export(&self) -> Settings {
        let mut settings = self.drawn_settings();
        settings.resolution = 1.0;
        if self.without_gpu == Some(settings.renderer) {
            settings.renderer = RendererChoice::Cpu;
        }
        settings
    }

    /// Draws as `way` from now on.
    pub fn draw_as(&mut self, way: &Settings) {
        self.settings = self.settings.drawn_as(way);
    }

    /// Asks where to write the benchmark's result.
    pub(in crate::app) fn ask_for_export(&mut self, dialog: DialogKind) {
        let Benchmark::Done(table) = &self.benchmark else {
            return;
        };
        let DialogKind::SaveReport(format) = dialog else {
            return;
        };
        let name = format!("pointreel-{}.{}", table.suite, format.extension());
        self.tasks.ask(dialog, Some(name));
    }

    fn change_speed(&mut self, next: impl Fn(f64) -> Option<f64>) {
        self.play_with(|player, now| {
            let speed = player.clock().speed();
            if let Some(size) = next(speed.abs()) {
                player.set_speed(size.clamp(MIN_SPEED, MAX_SPEED).copysign(speed), now);
            }
        });
    }

    fn scale_size(&mut self, factor: f32) {
        let (size, range) = match self.drawn_settings().primitive {
            Primitive::Point => (&mut self.settings.point_size_px, POINT_SIZE_RANGE_PX),
            Primitive::Auto | Primitive::Surfel | Primitive::Voxel => {
                (&mut self.settings.splat_scale, SPLAT_SCALE_RANGE)
            }
        };
        *size = (*size * factor).clamp(*range.start(), *range.end());
    }

    /// Takes the keys out of egui's input and does what they ask for. Call before the panels.
    pub fn handle_keys(&mut self, ctx: &egui::Context) {
        let typing = ctx.text_edit_focused();
        let (events, modifiers, now_secs) =
            ctx.input(|input| (input.raw.events.clone(), input.modifiers, input.time));
        self.fly.note(&events, typing);
        self.handle_clipboard(ctx);
        for command in command::dispatch(ctx) {
            // While flying, Ctrl is the slow pace and Q the way down.
            if command != Command::Quit || !self.fly.is_flying() {
                self.run(command);
            }
        }
        if self.fly.is_flying() {
            self.fly.step(&mut self.camera, now_secs, modifiers);
            ctx.request_repaint();
        }
    }

    /// What is open, for the title and for names of files.
    pub fn sequence_name(&self) -> Option<String> {
        name_of(self.player.as_ref()?.sequence())
    }

    fn picture_stem(&self) -> String {
        let frame = self
            .player
            .as_ref()
            .and_then(Player::shown)
            .map_or(0, |frame| frame.index + 1);
        format!("pointreel-{}-{frame:04}", self.sequence_stem())
    }

    /// What is open, for names of files: without extension.
    pub(in crate::app) fn sequence_stem(&self) -> String {
        let name = self.sequence_name().unwrap_or_else(|| "empty".to_owned());
        name.rsplit_once('.')
            .map_or(name.clone(), |(stem, _)| stem.to_owned())
    }

    /// Compares the picture of the window's settings, or of the open sequence, with the other one.
    pub fn compare_pictures(&self, edited: image::RgbaImage, other: image::RgbaImage) {
        let edited_side = self.comparison.as_ref().map(|comparison| comparison.edited);
        let pair = match edited_side {
            Some(Side::B) => [other, edited],
            Some(Side::A) | None => [edited, other],
        };
        if let Some(pictures) = self.pictures() {
            pictures.compare(pair, &self.tasks);
        }
    }

    /// From now on the processor draws in place of the graphics card whose device was lost, until a person chooses who
    /// draws.
    pub(in crate::app) fn draw_without_gpu(&mut self) {
        self.without_gpu = Some(self.settings.renderer);
        self.forget_picture();
    }

    /// Writes `image` to `path`, or to a new file in the folder of pictures.
    pub fn save_picture(&mut self, image: image::RgbaImage, path: Option<PathBuf>) {
        let place = match path {
            Some(path) => PicturePlace::File(path),
            None => PicturePlace::New {
                folder: picture_folder(),
                stem: self.picture_stem(),
            },
        };
        self.tasks.save_picture(image, place);
    }
}

/// The name of the file or folder that a sequence is from; `None` of an empty one.
pub(super) fn name_of(sequence: &Sequence) -> Option<String> {
    let last = sequence.len().checked_sub(1)?;
    let entry = sequence.entry(0);
    // Frames of one file stand together, so the ends tell. Asked for in every pass: nothing here may grow with the
    // sequence.
    let is_one_file = sequence.entry(last).path == entry.path;
    let of_all = if is_one_file {
        entry.path.file_name()
    } else {
        entry.path.parent().and_then(|folder| folder.file_name())
    };
    Some(of_all.map_or_else(
        || entry.name.clone(),
        |name| name.to_string_lossy().into_owned(),
    ))
}

/// Off, loop, ping-pong, off …
fn next_loop_mode(mode: LoopMode) -> LoopMode {
    let index = LoopMode::ALL
        .iter()
        .position(|&other| other == mode)
        .unwrap_or(0);
    LoopMode::ALL[(index + 1) % LoopMode::ALL.len()]
}

fn with_extension(path: PathBuf, extension: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(extension)
    }
}

/// The person's folder of pictures if the system has one, else where the program was started.
pub(in crate::app) fn picture_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.picture_dir().map(PathBuf::from))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}
