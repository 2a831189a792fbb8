//! Temporal comparison: derived frames that relate the shown frame to others: its distance from one of them in colours
//! (change map), and onion skins of its neighbours.
//!
//! How it works. Both are stages of composition ([`Lane::Poses`]) that build another frame from the one that the player
//! shows, on a thread. Until it is available the frame is shown as it is, but for a short time the derived frame of the
//! previous one stays, so that the image does not flicker while playing. Work for a frame that the playhead has left is
//! cancelled. Distances are cached, as they take longest; colours follow from them.

mod in_memory;
mod in_window;
mod known;
pub(in crate::app) mod panel;

use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::app::work::works::Progress;
pub use crate::composition::OnionSkin;
use crate::composition::{ChangeColors, ComposeOptions, Composed, Inputs, Lane, Measured, Problem, Request, StandIns};
use crate::measure::Change;
use crate::playback::Player;
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use in_memory::FramesInMemory;
use known::Known;
use std::sync::Arc;
use std::time::Duration;

/// Time for which the image of a frame that the playhead has left stays instead of one that is being computed.
const HOLD: Duration = Duration::from_millis(120);

/// The colours of a pose by how far each point is from another pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeMap {
    /// Visibility of the change map.
    pub is_on: bool,
    /// Frame offset of the other frame; negative for earlier.
    pub step: i64,
    /// The distance in the last colour, scene units; that which 99 % of the points do not exceed if `None`.
    pub range: Option<f64>,
    /// The distance above which points are counted, scene units.
    pub threshold: f64,
}

/// A frame that was made from a pose and others.
#[derive(Debug)]
pub struct ComposedFrame {
    request: Request,
    composed: Composed,
    /// Why something of it is missing.
    problem: Option<String>,
}

impl Message for Option<Box<ComposedFrame>> {}

impl ComposedFrame {
    /// Makes the frame; `None` if cancelled.
    fn of(request: Request, progress: &Progress) -> Option<Self> {
        let (composed, failure) = request.run(progress)?;
        let failure = failure.map(|reason| format!("There are too many ghosts: {reason}"));
        let problem = failure.or_else(|| composed.problems.iter().rev().find_map(in_panel));
        Some(Self {
            request,
            composed,
            problem,
        })
    }

    /// The pose, and the frame that was made of it.
    pub(in crate::app) fn composed(&self) -> &Composed {
        &self.composed
    }
}

/// A problem next to the choices that it is about; none where the panel shows it itself.
fn in_panel(problem: &Problem) -> Option<String> {
    match problem {
        Problem::OtherUnread { reason, .. } => Some(reason.to_string()),
        Problem::OtherEmpty { other, .. } => Some(format!("Frame {} has no points", other + 1)),
        Problem::NoOtherFrame { .. } | Problem::NoGhost { .. } | Problem::Note(_) => None,
    }
}

/// Makes the chosen derived frames.
#[derive(Debug)]
pub struct Temporal {
    /// Colours by change.
    pub change: ChangeMap,
    /// Ghosts.
    pub onion: OnionSkin,
    known: Known,
    running: Option<(Request, Progress)>,
    made: Option<ComposedFrame>,
    /// Time since which the frame of `made` differs from the playhead's.
    left_at: Option<Duration>,
}

impl Default for Temporal {
    fn default() -> Self {
        Self {
            change: ChangeMap {
                is_on: false,
                step: 1,
                range: None,
                threshold: 0.0,
            },
            onion: OnionSkin::default(),
            known: Known::default(),
            running: None,
            made: None,
            left_at: None,
        }
    }
}

impl ChangeMap {
    fn colors(&self) -> ChangeColors {
        ChangeColors {
            step: self.step,
            range: self.range,
        }
    }
}

impl Temporal {
    /// Returns the frame drawn instead of the shown one, if there is one.
    pub(in crate::app) fn shown(&self) -> Option<&ComposedFrame> {
        self.made.as_ref()
    }

    /// Colours and ghosts that are chosen.
    pub(in crate::app) fn options(&self) -> ComposeOptions {
        ComposeOptions {
            change: self.change.is_on.then(|| self.change.colors()),
            onion: Some(self.onion).filter(|onion| onion.is_on),
            ..ComposeOptions::NONE
        }
    }

    /// The frame that the shown one is compared with; `None` where the sequence has no such frame.
    pub fn other_frame(&self, index: usize, frame_count: usize) -> Option<usize> {
        self.change.colors().other_frame(index, frame_count)
    }

    /// The change of the shown pose, once it is known, and the distance in its last colour, scene units.
    pub fn measured(&self, pose: &Arc<PreparedFrame>) -> Option<(&Change, f64)> {
        let made = self.made.as_ref()?;
        let Measured { change, to, range } = made.composed.change.as_ref()?;
        (Arc::ptr_eq(&made.request.pose, pose) && *to as i64 - pose.index as i64 == self.change.step)
            .then_some((change, *range))
    }

    /// Why the change cannot be shown, if it cannot.
    pub fn problem(&self) -> Option<&str> {
        self.made.as_ref()?.problem.as_deref()
    }

    /// Forgets all frames, as another sequence is opened; the choices stay.
    pub(in crate::app) fn forget_frames(&mut self) {
        self.cancel();
        *self = Self {
            change: self.change,
            onion: self.onion,
            ..Self::default()
        };
    }

    /// Starts missing work for the shown frame, and cancels obsolete work. True if another frame is to be drawn.
    pub(in crate::app) fn follow<T: TaskOutcome + From<Option<Box<ComposedFrame>>>>(
        &mut self,
        player: &Player,
        style: &Style,
        tasks: &Tasks<T>,
        now: Duration,
    ) -> bool {
        let Some(request) = self.request(player, style) else {
            self.cancel();
            self.left_at = None;
            return self.made.take().is_some();
        };
        let made = self.made.as_ref();
        let is_left = made.is_some_and(|made| !Arc::ptr_eq(&made.request.pose, &request.pose));
        self.left_at = is_left.then(|| self.left_at.unwrap_or(now));
        if made.is_some_and(|made| made.request == request) {
            self.cancel();
        } else if self.running.as_ref().is_none_or(|(running, _)| *running != request) {
            self.cancel();
            self.start(request, tasks);
        }
        let is_gone = self.left_at.is_some_and(|left| now >= left + HOLD);
        if is_gone {
            self.made = None;
            self.left_at = None;
        }
        is_gone
    }

    fn start<T: TaskOutcome + From<Option<Box<ComposedFrame>>>>(&mut self, request: Request, tasks: &Tasks<T>) {
        let progress = Progress::default();
        self.running = Some((request.clone(), progress.clone()));
        tasks.start("poses", move || ComposedFrame::of(request, &progress).map(Box::new));
    }

    /// Takes the result of a task, unless the request has changed.
    pub(in crate::app) fn take_in(&mut self, made: ComposedFrame) {
        if let Some(Measured { change, to, .. }) = &made.composed.change {
            let pose = &made.request.pose;
            self.known.keep((pose.index, *to, pose.frame.len()), change);
        }
        if self.running.take_if(|(request, _)| *request == made.request).is_some() {
            self.made = Some(made);
            self.left_at = None;
        }
    }

    /// Time at which a held image expires.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        self.left_at.map(|left| left + HOLD)
    }

    fn cancel(&mut self) {
        if let Some((_, progress)) = self.running.take() {
            progress.cancel();
        }
    }

    /// Steps for the shown pose; `None` if it is shown as it is.
    fn request(&self, player: &Player, style: &Style) -> Option<Request> {
        let pose = player.shown()?;
        let inputs = Inputs {
            pose,
            options: &self.options(),
            style,
            frames: &FramesInMemory {
                player,
                known: &self.known,
            },
            stand_ins: StandIns::default(),
        };
        Request::gather(Lane::Poses, pose, &inputs)
    }
}
