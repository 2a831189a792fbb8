//! A window that plays, orbits and scrubs by itself, and records the presented images (`pointreel bench window`).
//!
//! **How it works.** A benchmark is a list of steps, each an action with a primitive on a sequence. The event loop runs
//! its due steps ([`WindowBench::advance`]) and passes its mouse events to egui as if they had come from the window
//! system; after each redraw it is notified of the presented image ([`WindowBench::note`]). An event is timestamped
//! with the instant at which it was due, so one that waits while an image is drawn is as late as a real one would be.
//! Everything else is the window as users have it: same loop, same panels, same pacing.

mod gesture;
mod processor;

use self::gesture::Gesture;
pub(super) use self::processor::Processor;
use super::meter::{GpuWork, Redraw};
use super::state::{PictureStage, State};
use crate::bench::{BenchOptions, Input, WindowAction};
use crate::playback::Player;
use crate::scene::{Choice, Primitive, RendererChoice, Settings};
use egui::Event;
use std::collections::VecDeque;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Duration of mouse orbiting or scrubbing per played frame: 4 s for the usual 300.
const GESTURE_TIME_PER_FRAME: Duration = Duration::from_micros(13_333);

/// A window that has been still for so long rests.
const REST: Duration = Duration::from_millis(600);

/// Timeout of steps that do not end by themselves; large files take their time.
const MAX_TIME: Duration = Duration::from_mins(1);

/// Primitives to draw.
const PRIMITIVES: [Primitive; 3] = [Primitive::Point, Primitive::Surfel, Primitive::Voxel];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Action {
    Open,
    Play,
    Turn,
    Scrub,
}

impl Action {
    fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Play => "play",
            Self::Turn => "turn",
            Self::Scrub => "scrub",
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Step {
    input: usize,
    primitive: Choice<Primitive>,
    action: Action,
}

/// Progress of a step.
#[derive(Debug)]
enum Phase {
    /// The frame is not there as it is to be drawn, or the window does not rest yet.
    Settling { still_since: Duration },
    Running {
        gesture: Option<Gesture>,
        /// Time at which the window began to show the measured content.
        begin: Duration,
    },
    /// The mouse was released; the image of all points has not been presented yet.
    Resting { since: Duration },
}

/// Measurements of the running step so far.
#[derive(Debug)]
struct Watched {
    step: Step,
    phase: Phase,
    begun_at: Duration,
    found: WindowAction,
    processor: Processor,
    gpu: GpuWork,
    /// Due times of events whose image has not been presented.
    pending: Vec<Duration>,
    pictures_before: u64,
    panel_runs_before: u64,
    frames_before: u64,
}

/// The steps of a benchmark and their results.
#[derive(Debug)]
pub(super) struct WindowBench {
    inputs: Vec<Input>,
    frames: u64,
    renderer: Choice<RendererChoice>,
    steps: VecDeque<Step>,
    watched: Option<Watched>,
    done: Vec<WindowAction>,
}

impl WindowBench {
    /// Opening with the settings of a new window, then all actions for all primitives, on each sequence.
    pub(super) fn new(inputs: &[Input], options: &BenchOptions, renderer: Choice<RendererChoice>) -> Self {
        let opened = (0..inputs.len()).map(|input| Step {
            input,
            primitive: Settings::default().primitive,
            action: Action::Open,
        });
        let moved = inputs.iter().enumerate().flat_map(|(index, input)| {
            let moves = input.sequence.len() > 1;
            PRIMITIVES.into_iter().flat_map(move |primitive| {
                let actions = [Action::Play, Action::Turn, Action::Scrub];
                let actions = actions
                    .into_iter()
                    .filter(move |&action| moves || action == Action::Turn);
                actions.map(move |action| Step {
                    input: index,
                    primitive: primitive.into(),
                    action,
                })
            })
        });
        Self {
            inputs: inputs.to_vec(),
            frames: options.frames as u64,
            renderer,
            steps: opened.chain(moved).collect(),
            watched: None,
            done: Vec::new(),
        }
    }

    /// Returns the results once all steps are done.
    pub(super) fn result(&mut self) -> Option<Vec<WindowAction>> {
        let is_over = self.steps.is_empty() && self.watched.is_none();
        is_over.then(|| std::mem::take(&mut self.done))
    }

    /// When there is something to do next.
    pub(super) fn next_deadline(&self) -> Option<Duration> {
        let watched = self.watched.as_ref();
        let Some(watched) = watched else {
            return (!self.steps.is_empty()).then_some(Duration::ZERO);
        };
        let end = watched.begun_at + MAX_TIME;
        Some(match &watched.phase {
            Phase::Settling { still_since } => end.min(*still_since + REST),
            Phase::Running {
                gesture: Some(gesture), ..
            } => end.min(gesture.next_deadline()),
            Phase::Running { gesture: None, .. } | Phase::Resting { .. } => end,
        })
    }

    /// Runs the steps due at `now`; returns mouse events.
    pub(super) fn advance(&mut self, now: Duration, state: &mut State) -> Vec<Event> {
        let Some(watched) = &mut self.watched else {
            if let Some(step) = self.steps.pop_front() {
                self.watched = Some(self.begin(step, now, state));
            }
            return Vec::new();
        };
        if now.saturating_sub(watched.begun_at) > MAX_TIME {
            self.finish(now, state);
            return Vec::new();
        }
        match &mut watched.phase {
            Phase::Settling { still_since } => {
                if now < *still_since + REST {
                    return Vec::new();
                }
                if !is_whole(state) {
                    *still_since = now;
                    return Vec::new();
                }
                let length = GESTURE_TIME_PER_FRAME.mul_f64(self.frames as f64);
                let gesture = match watched.step.action {
                    Action::Scrub => Gesture::along(state.features.timeline.bar_rect, now, length),
                    Action::Open | Action::Play | Action::Turn => Gesture::around(state.viewport.rect, now, length),
                };
                watched.start(now, state, Some(gesture));
                Vec::new()
            }
            Phase::Running {
                gesture: Some(gesture), ..
            } => {
                let (events, is_over) = gesture.advance(now, &mut watched.pending);
                if is_over {
                    watched.found.seconds = now.saturating_sub(watched.begin()).as_secs_f64();
                    watched.phase = Phase::Resting { since: now };
                }
                events
            }
            Phase::Running { gesture: None, .. } | Phase::Resting { .. } => Vec::new(),
        }
    }

    fn begin(&self, step: Step, now: Duration, state: &mut State) -> Watched {
        let input = &self.inputs[step.input];
        let style = Settings::default().with(|style| {
            style.drawing.renderer = self.renderer;
            style.primitive = step.primitive;
        });
        let is_opened = step.action == Action::Open;
        if is_opened {
            Processor::forget_peak();
        }
        // As from a fresh start: with an empty loader. For the open action, not even the automatic settings have been
        // determined.
        let sequence = if is_opened {
            Arc::new(input.sequence.fresh())
        } else {
            Arc::clone(&input.sequence)
        };
        state.open_fresh(sequence, style, step.action == Action::Play);
        let mut watched = Watched {
            step,
            phase: Phase::Settling { still_since: now },
            begun_at: now,
            found: WindowAction {
                sequence: input.name.clone(),
                primitive: step.primitive.to_string(),
                action: step.action.name().to_owned(),
                painted_by: if state.graphics.paints_on_processor {
                    format!("processor ({})", state.graphics.adapter)
                } else {
                    state.graphics.adapter.clone()
                },
                ..WindowAction::default()
            },
            processor: Processor::now(),
            gpu: GpuWork::default(),
            pending: Vec::new(),
            pictures_before: 0,
            panel_runs_before: 0,
            frames_before: 0,
        };
        if is_opened {
            let start_ms = Processor::since_start().map(|since| since.as_secs_f64() * 1e3);
            watched.found.start_ms = start_ms.filter(|_| self.done.is_empty());
            watched.start(now, state, None);
        }
        if step.action == Action::Play {
            watched.found.fps_asked = Some(input.sequence.fps());
            watched.start(now, state, None);
        }
        watched
    }

    /// Records a redraw that ended at `now`. True if the benchmark has something to do.
    pub(super) fn note(&mut self, redraw: &Redraw, is_presented: bool, now: Duration, state: &State) -> bool {
        let Some(watched) = &mut self.watched else {
            return false;
        };
        let is_over = watched.note(redraw, is_presented, self.frames, now, state);
        if is_over {
            self.finish(now, state);
        }
        is_over
    }

    fn finish(&mut self, now: Duration, state: &State) {
        if let Some(watched) = self.watched.take() {
            self.done.push(watched.finish(now, state));
        }
    }
}

/// Returns true if the first frame is drawn with all its points.
fn is_whole(state: &State) -> bool {
    let player = state.player.as_ref().filter(|player| !player.is_partial());
    let frame = player.and_then(|player| player.shown());
    frame.is_some_and(|frame| !frame.is_sample()) && state.is_drawn()
}

/// Returns the time it takes to read a file and do nothing with it; `None` where there is none.
fn plain_read_ms(path: &Path) -> Option<f64> {
    let begin = Instant::now();
    let mut file = File::open(path).ok()?;
    let mut piece = vec![0; 1 << 20];
    while file.read(&mut piece).ok()? > 0 {}
    Some(begin.elapsed().as_secs_f64() * 1e3)
}

impl Watched {
    fn begin(&self) -> Duration {
        match self.phase {
            Phase::Running { begin, .. } => begin,
            Phase::Settling { .. } | Phase::Resting { .. } => self.begun_at,
        }
    }

    /// From now on everything counts.
    fn start(&mut self, now: Duration, state: &State, gesture: Option<Gesture>) {
        self.phase = Phase::Running { gesture, begin: now };
        self.processor = Processor::now();
        self.gpu = GpuWork::default();
        self.pictures_before = state.shared.counters.pictures;
        self.panel_runs_before = state.shared.counters.ui_passes;
        self.frames_before = state.player.as_ref().map_or(0, Player::frames_shown);
        self.found.parts_ms = Default::default();
        self.found.points = [0; 2];
    }

    /// True once the step is over.
    fn note(&mut self, redraw: &Redraw, is_presented: bool, max_frames: u64, now: Duration, state: &State) -> bool {
        let pictures = state.shared.counters.pictures - self.pictures_before;
        let is_picture = is_presented && pictures > self.found.pictures;
        if self.step.action == Action::Open {
            if is_picture {
                self.found.pictures = pictures;
                self.note_opened(now, state);
            }
            return self.found.whole_ms.is_some();
        }
        let player = state.player.as_ref();
        let frames = player.map_or(0, Player::frames_shown) - self.frames_before;
        match &mut self.phase {
            Phase::Settling { still_since } => *still_since = now,
            Phase::Resting { since } => {
                let is_whole = is_picture || pictures == self.found.pictures;
                if is_presented && is_whole && !state.is_picture_coarse() {
                    let rest_ms = now.saturating_sub(*since).as_secs_f64() * 1e3;
                    self.found.rest_ms = (self.step.action == Action::Turn).then_some(rest_ms);
                    return true;
                }
            }
            Phase::Running { begin, .. } => {
                if is_presented {
                    let late = self.pending.drain(..).map(|due| now.saturating_sub(due));
                    self.found
                        .latencies_ms
                        .extend(late.map(|late| late.as_secs_f64() * 1e3));
                }
                if !is_picture {
                    return false;
                }
                // The clock starts at the first image.
                if self.step.action == Action::Play && self.found.pictures == 0 {
                    let first_ms = now.saturating_sub(self.begun_at).as_secs_f64() * 1e3;
                    self.found.first_ms = Some(first_ms);
                    *begin = now;
                    self.processor = Processor::now();
                }
                self.found.pictures = pictures;
                self.gpu.add(redraw.gpu);
                self.found.frames = frames;
                let ms = |part: Duration| part.as_secs_f64() * 1e3;
                let parts = [
                    redraw.drawing,
                    redraw.panels,
                    redraw.painting,
                    redraw.presenting,
                    redraw.waiting,
                ];
                for (known, part) in self.found.parts_ms.iter_mut().zip(parts) {
                    known.push(ms(part));
                }
                if let Some(frame) = player.and_then(|player| player.shown()) {
                    let frame = &frame.frame;
                    self.found.points[0] += frame.len() as u64;
                    self.found.points[1] += (frame.points_in_file() - frame.dropped_points()) as u64;
                }
                return self.step.action == Action::Play && frames >= max_frames;
            }
        }
        false
    }

    /// Records a presented image of the sequence being opened.
    fn note_opened(&mut self, now: Duration, state: &State) {
        let Some(stage) = state.picture_stage() else {
            return;
        };
        let ms = now.saturating_sub(self.begun_at).as_secs_f64() * 1e3;
        let found = &mut self.found;
        let times = [
            (&mut found.first_ms, PictureStage::SomePoints),
            (&mut found.all_points_ms, PictureStage::AllPoints),
            (&mut found.whole_ms, PictureStage::Whole),
        ];
        for (time, _) in times.into_iter().filter(|&(_, min)| stage >= min) {
            time.get_or_insert(ms);
        }
        if stage == PictureStage::SurfelsInView {
            found.in_view_ms.get_or_insert(ms);
        }
        found.peak_bytes = Processor::peak_resident_bytes();
    }

    fn finish(mut self, now: Duration, state: &State) -> WindowAction {
        if self.step.action == Action::Open {
            let entry = state.player.as_ref().map(|player| player.sequence().entry(0));
            self.found.read_ms = entry.and_then(|entry| plain_read_ms(&entry.path));
        }
        if let Phase::Running { begin, .. } = self.phase {
            self.found.seconds = now.saturating_sub(begin).as_secs_f64();
        }
        let used = Processor::now().since(&self.processor);
        self.found.cpu_ms = used.as_ref().map(|used| used.all_ms);
        self.found.cpu_ms_of = used
            .as_ref()
            .map(|used| [used.prepare_ms, used.driver_ms, used.helpers_ms]);
        self.found.resident_bytes = Processor::resident_bytes();
        let GpuWork {
            submissions,
            passes,
            uploaded_bytes,
        } = self.gpu;
        self.found.gpu = (submissions > 0).then_some([submissions, passes, uploaded_bytes]);
        self.found.panel_runs = state.shared.counters.ui_passes - self.panel_runs_before;
        if let Some(player) = &state.player {
            self.found.frames_late = player.late_frames();
            self.found.frames_skipped = player.clock().skipped();
        }
        self.found
    }
}
