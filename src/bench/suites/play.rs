//! Real-time playback of a sequence as in the window, counting the frames that a user would see.
//!
//! How it works: a player with its own loader determines the frame to show at each deadline, and whenever the loader
//! has something new; each image is drawn at once, by the CPU where the window would choose it. Nothing is presented,
//! so an image costs only its drawing. The loop ends after the requested number of frames.
//!
//! Results: if the frame rate is held, at what cost in points, and if memory use is stable.

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, OptionGroup, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::playback::Player;
use crate::render::{AnyRenderer, Renderer};
use crate::scene::{Camera, Primitive, Scene, Style};
use crate::sequence::{LoaderOptions, PreparedFrame};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

/// Columns, in the order in which [`Played::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("primitive", "primitive"),
    Column::text("renderer", "renderer").hidden(),
    Column::number("fps_asked", "fps asked", 1),
    Column::number("fps_held", "held", 1),
    Column::percent("points_share", "points shown", 1),
    Column::number("frames_shown", "frames", 0),
    Column::number("frames_coarse", "coarse", 0),
    Column::number("frames_late", "late", 0),
    Column::number("frames_skipped", "skipped", 0),
    Column::number("frames_failed", "failed", 0).hidden(),
    Column::number("picture_ms_median", "picture ms", 2),
    Column::number("picture_ms_q3", "75 %", 2),
    Column::number("loader_peak_mib", "frames MiB", 0),
    Column::number("resident_begin_mib", "RSS MiB begin", 0),
    Column::number("resident_peak_mib", "most", 0),
    Column::number("resident_end_mib", "end", 0),
];

/// Real-time playback: achieved frame rate, number of points, memory use.
pub const PLAY: &Suite = &Suite {
    name: "play",
    brief: "achieved playback rate, without a window",
    title: "Playing",
    hint: "Play 300 frames by the clock, drawn but not presented: frames per second held, share of points shown, \
        memory",
    description: "playing by the clock, drawn but not presented: rate held, points shown, late and skipped frames, \
        memory",
    measured: "the player of the window by the clock, frames decoded and prepared meanwhile: frames per second \
        requested and shown, the share of their files' points that they had, those that had not all (coarse), were not \
        there when due (late) or passed unseen (skipped); CPU wall time from packet to finished picture; memory of the \
        whole program at the beginning, at most and at the end",
    not_measured: "panels, showing; the first frame",
    covered_by: "surfels",
    defaults: Defaults {
        viewport_px: [1280, 720],
        viewpoints: 1,
        frames: 300,
    },
    takes: &[OptionGroup::Playing],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "fps_held",
    bars_title: "Frames per second shown",
    bar_labels: 2,
};

const PRIMITIVES: [Primitive; 3] = [Primitive::Point, Primitive::Surfel, Primitive::Voxel];

/// Frames between two measurements of memory.
const LOOK_EVERY: u64 = 64;

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let wanted = run.options.frames;
    for subject in run.subjects(0)? {
        run.add_steps(PRIMITIVES.len());
        let mut rows = Vec::new();
        let mut points = Vec::new();
        for primitive in PRIMITIVES {
            run.begin_step(format!("{}: {primitive}, {wanted} frames", subject.name))?;
            let style = Style {
                primitive,
                ..Style::default()
            };
            let played = play(run, &subject, &style)?;
            points.push(played.mean_points);
            rows.push(played.row(subject.name, primitive));
        }
        run.finish(&subject, &points[..1], &[], rows);
    }
    Ok(())
}

/// Result of a playback run.
struct Played {
    renderer: String,
    fps_asked: f64,
    fps_held: f64,
    mean_points: f64,
    points_share: f64,
    shown: u64,
    coarse: u64,
    late: u64,
    skipped: u64,
    failed: usize,
    picture_ms: Option<Quantiles>,
    loader_peak_bytes: usize,
    /// At the beginning, at most, at the end.
    resident_bytes: [u64; 3],
}

/// Plays until the requested number of frames was shown, or none can be.
fn play(run: &Run<'_>, subject: &Subject<'_>, style: &Style) -> Result<Played, BenchError> {
    let (wake, woken) = sync_channel(1);
    let options = loader_options(run.options.budget_bytes, wake);
    let mut player = Player::new(Arc::clone(subject.sequence), options, true)?;
    let mut screen = PlayedPictures::new(run, subject, style)?;
    let mut memory = Memory::new();
    let seconds = play_by_the_clock(run, &mut player, &mut screen, &mut memory, &woken)?;
    let stats = player.loader().stats();
    let shown = player.frames_shown();
    Ok(Played {
        renderer: screen.renderer.summary(),
        fps_asked: player.clock().fps(),
        fps_held: shown.saturating_sub(1) as f64 / seconds.max(1e-9),
        mean_points: screen.points as f64 / screen.pictures_ms.len().max(1) as f64,
        points_share: screen.points as f64 / screen.points_in_files.max(1) as f64,
        shown,
        coarse: player.coarse_frames_shown(),
        late: player.late_frames(),
        skipped: player.clock().skipped(),
        failed: stats.failed_frames,
        picture_ms: Quantiles::of(&screen.pictures_ms),
        loader_peak_bytes: stats.peak_bytes,
        resident_bytes: memory.begin_peak_end,
    })
}

/// As in the window.
fn loader_options(budget_bytes: Option<usize>, wake: SyncSender<()>) -> LoaderOptions {
    let default = LoaderOptions::default();
    LoaderOptions {
        keeps_coarse_frames: true,
        budget_bytes: budget_bytes.unwrap_or(default.budget_bytes),
        wake: Arc::new(move || {
            // A full channel already contains a wake-up.
            let _ = wake.try_send(());
        }),
        ..default
    }
}

/// Draws each frame that is new; returns how long it played, seconds.
fn play_by_the_clock(
    run: &Run<'_>,
    player: &mut Player,
    screen: &mut PlayedPictures<'_>,
    memory: &mut Memory,
    woken: &Receiver<()>,
) -> Result<f64, BenchError> {
    // A single frame is shown once, however long it is played.
    let wanted = match screen.subject.sequence.len() {
        1 => 1,
        _ => run.options.frames as u64,
    };
    let begin = Instant::now();
    let mut first_shown = None;
    let mut last: Option<Arc<PreparedFrame>> = None;
    let mut looked_at = 0;
    while player.frames_shown() < wanted {
        run.check_cancelled()?;
        player.update(begin.elapsed(), screen.style);
        check_failures(player, screen.subject)?;
        let new = player
            .shown()
            .filter(|shown| !last.as_ref().is_some_and(|last| Arc::ptr_eq(last, shown)));
        if let Some(frame) = new.map(Arc::clone) {
            // The clock starts with the first frame, however long it takes to draw.
            first_shown.get_or_insert_with(|| begin.elapsed());
            let picture_ms = screen.draw(&frame)?;
            player.note_picture_ms(frame.frame.len(), picture_ms);
            last = Some(frame);
        } else {
            sleep(woken, player.next_deadline(), begin);
        }
        if player.frames_shown() >= looked_at + LOOK_EVERY || last.is_none() {
            looked_at = player.frames_shown();
            memory.look();
        }
    }
    memory.look();
    let played = begin.elapsed().saturating_sub(first_shown.unwrap_or_default());
    Ok(played.as_secs_f64())
}

/// Fails where no two frames can be read: one alone does not play.
fn check_failures(player: &Player, subject: &Subject<'_>) -> Result<(), BenchError> {
    match player.failure() {
        Some(failure) if player.loader().stats().failed_frames + 1 >= subject.sequence.len() => {
            Err(BenchError::NoFrame {
                sequence: subject.name.to_owned(),
                reason: failure.to_string(),
            })
        }
        _ => Ok(()),
    }
}

/// Sleeps until the deadline or a wake, a tenth of a second at most.
fn sleep(woken: &Receiver<()>, deadline: Option<Duration>, begin: Instant) {
    const LONGEST: Duration = Duration::from_millis(100);
    let wait = deadline.map_or(LONGEST, |deadline| deadline.saturating_sub(begin.elapsed()));
    match woken.recv_timeout(wait.min(LONGEST)) {
        Ok(()) | Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
    }
}

/// Renderer of the playback, and the images it drew.
struct PlayedPictures<'a> {
    renderer: AnyRenderer,
    scene: Scene,
    camera: Option<Camera>,
    style: &'a Style,
    viewport_px: [u32; 2],
    subject: &'a Subject<'a>,
    pictures_ms: Vec<f64>,
    points: u64,
    points_in_files: u64,
}

impl<'a> PlayedPictures<'a> {
    fn new(run: &Run<'_>, subject: &'a Subject<'a>, style: &'a Style) -> Result<Self, BenchError> {
        Ok(Self {
            renderer: AnyRenderer::open(style.drawing.renderer)?,
            scene: Scene::that_remembers(),
            camera: None,
            style,
            viewport_px: run.options.viewport_px,
            subject,
            pictures_ms: Vec::new(),
            points: 0,
            points_in_files: 0,
        })
    }

    /// Milliseconds from the frame to its finished image.
    fn draw(&mut self, frame: &PreparedFrame) -> Result<f64, BenchError> {
        let subject = self.subject;
        let camera = self.camera.get_or_insert_with(|| subject.framing(frame));
        let start = Instant::now();
        let packet = subject.packet(&mut self.scene, frame, camera, self.style, self.viewport_px);
        self.renderer.prepare(&packet)?;
        self.renderer.render()?;
        self.renderer.wait()?;
        let picture_ms = start.elapsed().as_secs_f64() * 1e3;
        self.pictures_ms.push(picture_ms);
        self.points += frame.frame.len() as u64;
        self.points_in_files += (frame.frame.points_in_file() - frame.frame.dropped_points()) as u64;
        Ok(picture_ms)
    }
}

/// Memory of the program that is in the machine's.
struct Memory {
    system: System,
    process: Option<Pid>,
    begin_peak_end: [u64; 3],
}

impl Memory {
    fn new() -> Self {
        let mut memory = Self {
            system: System::new(),
            process: sysinfo::get_current_pid().ok(),
            begin_peak_end: [0; 3],
        };
        memory.look();
        memory.begin_peak_end[0] = memory.begin_peak_end[2];
        memory
    }

    fn look(&mut self) {
        let Some(process) = self.process else { return };
        let only_memory = ProcessRefreshKind::nothing().with_memory();
        self.system
            .refresh_processes_specifics(ProcessesToUpdate::Some(&[process]), false, only_memory);
        let bytes = self.system.process(process).map_or(0, sysinfo::Process::memory);
        let [_, peak, end] = &mut self.begin_peak_end;
        *peak = bytes.max(*peak);
        *end = bytes;
    }
}

impl Played {
    fn row(&self, sequence: &str, primitive: Primitive) -> Row {
        let mib = |bytes: f64| Cell::Number(bytes / f64::from(1 << 20));
        let [begin, peak, end] = self.resident_bytes.map(|bytes| mib(bytes as f64));
        let picture = |of: fn(&Quantiles) -> f64| Cell::maybe(self.picture_ms.as_ref().map(of));
        Row::new(vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(primitive.to_string()),
            Cell::Text(self.renderer.clone()),
            Cell::Number(self.fps_asked),
            Cell::Number(self.fps_held),
            Cell::Number(self.points_share),
            Cell::Number(self.shown as f64),
            Cell::Number(self.coarse as f64),
            Cell::Number(self.late as f64),
            Cell::Number(self.skipped as f64),
            Cell::Number(self.failed as f64),
            picture(|quantiles| quantiles.median),
            picture(|quantiles| quantiles.q3),
            mib(self.loader_peak_bytes as f64),
            begin,
            peak,
            end,
        ])
    }
}
