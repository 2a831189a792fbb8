//! What other poses say of the shown one: how far it is from one of them in colours, and ghosts of its neighbours.
//!
//! How it works. Both make another frame from the one that the player shows, on a thread: the same points in other
//! colours ([`PreparedFrame::in_colors`]), then with others around them ([`compose`]). Until it is there the pose
//! is shown as it is, but for a moment the frame that was made of the pose before stays, so that the picture does not
//! flicker while playing. What is under way for a pose that the playhead has left is cancelled. Distances are kept, as
//! they take longest; colours follow from them.

mod in_window;
pub(in crate::app) mod panel;
mod task;

pub use task::ComposedFrame;

use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::app::work::works::Progress;
use crate::measure::Change;
use crate::playback::Player;
use crate::scene::{Scene, Style};
pub use crate::sequence::OnionSkin;
use crate::sequence::{Ghost, Needs, PreparedFrame, Slot};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;
use task::{ChangeRequest, PoseRequest, compose};

/// Bytes of distances that are kept.
const MAX_KEPT_BYTES: usize = 256 << 20;

/// So long the picture of a pose that the playhead has left stays in place of one that is being made.
const HOLD: Duration = Duration::from_millis(120);

/// The colours of a pose by how far each point is from another pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeMap {
    /// Whether they are shown.
    pub is_on: bool,
    /// How many frames later the other pose is; negative for earlier.
    pub step: i64,
    /// The distance in the last colour, scene units; that which 99 % of the points do not exceed if `None`.
    pub range: Option<f64>,
    /// The distance above which points are counted, scene units.
    pub threshold: f64,
}

/// The distances of one pose to another: the frames, and how many points of the first there are.
type ChangeKey = (usize, usize, usize);

/// Makes frames of what is chosen.
#[derive(Debug)]
pub struct Temporal {
    /// Colours by change.
    pub change: ChangeMap,
    /// Ghosts.
    pub onion: OnionSkin,
    /// Oldest first.
    known: VecDeque<(ChangeKey, Arc<Change>)>,
    running: Option<(PoseRequest, Progress)>,
    made: Option<ComposedFrame>,
    /// Since when the pose of `made` is not that of the playhead.
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
            known: VecDeque::new(),
            running: None,
            made: None,
            left_at: None,
        }
    }
}

impl Temporal {
    /// What is drawn in place of the shown pose, if there is something.
    pub(in crate::app) fn shown(&self) -> Option<&ComposedFrame> {
        self.made.as_ref()
    }

    /// The frame that the shown one is compared with; `None` where the sequence has no such frame.
    pub fn other_frame(&self, index: usize, frame_count: usize) -> Option<usize> {
        let other = i64::try_from(index).ok()?.checked_add(self.change.step)?;
        usize::try_from(other).ok().filter(|&other| other < frame_count)
    }

    /// The change of the shown pose, once it is known, and the distance in its last colour, scene units.
    pub fn measured(&self, pose: &Arc<PreparedFrame>) -> Option<(&Change, f64)> {
        let made = self.made.as_ref()?;
        let change = made.change.as_ref()?;
        let asked = made.request.change?;
        (Arc::ptr_eq(&made.request.pose, pose) && asked.to as i64 - pose.index as i64 == self.change.step)
            .then(|| (change.as_ref(), asked.range.unwrap_or(change.usual_range())))
    }

    /// Why the change cannot be shown, if it cannot.
    pub fn problem(&self) -> Option<&str> {
        self.made.as_ref()?.problem.as_deref()
    }

    /// Forgets all frames, as another sequence is opened; what is chosen stays.
    pub(in crate::app) fn forget_frames(&mut self) {
        self.cancel();
        *self = Self {
            change: self.change,
            onion: self.onion,
            ..Self::default()
        };
    }

    /// Starts what the shown pose lacks, and cancels what nobody waits for any more. True if another frame is to be
    /// drawn.
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
            self.start(request, player, tasks);
        }
        let is_gone = self.left_at.is_some_and(|left| now >= left + HOLD);
        if is_gone {
            self.made = None;
            self.left_at = None;
        }
        is_gone
    }

    fn start<T: TaskOutcome + From<Option<Box<ComposedFrame>>>>(
        &mut self,
        request: PoseRequest,
        player: &Player,
        tasks: &Tasks<T>,
    ) {
        let progress = Progress::default();
        self.running = Some((request.clone(), progress.clone()));
        let known = self.known_change(&request);
        let sequence = Arc::clone(player.sequence());
        // The pose to compare with may be in memory; if not, the task reads it.
        let other = request
            .change
            .and_then(|change| match player.loader().get(change.to, &Needs::default()) {
                Slot::Ready(frame) | Slot::Partial(frame) | Slot::Stale(frame) if !frame.is_sample() => Some(frame),
                _ => None,
            });
        tasks.start("poses", move || {
            compose(request, known, other.as_deref(), &sequence, &progress).map(Box::new)
        });
    }

    /// Takes what a task has made, unless something else is wanted by now.
    pub(in crate::app) fn take_in(&mut self, made: ComposedFrame) {
        if let (Some(change), Some(key)) = (&made.change, key(&made.request))
            && self.known_change(&made.request).is_none()
        {
            self.known.push_back((key, Arc::clone(change)));
            while self.known.len() > 1 && self.kept_bytes() > MAX_KEPT_BYTES {
                self.known.pop_front();
            }
        }
        if self.running.take_if(|(request, _)| *request == made.request).is_some() {
            self.made = Some(made);
            self.left_at = None;
        }
    }

    /// When a picture that is held has to go.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        self.left_at.map(|left| left + HOLD)
    }

    fn kept_bytes(&self) -> usize {
        let changes = self.known.iter().map(|(_, change)| change.byte_size());
        changes.sum()
    }

    fn known_change(&self, request: &PoseRequest) -> Option<Arc<Change>> {
        let key = key(request)?;
        let known = self.known.iter().find(|(known, _)| *known == key);
        known.map(|(_, change)| Arc::clone(change))
    }

    fn cancel(&mut self) {
        if let Some((_, progress)) = self.running.take() {
            progress.cancel();
        }
    }

    /// What is to be made of the shown pose; `None` if it is shown as it is.
    fn request(&self, player: &Player, style: &Style) -> Option<PoseRequest> {
        let pose = player.shown()?;
        let needs = Scene::needs(style);
        let frame_count = player.sequence().len();
        let change = self.other_frame(pose.index, frame_count);
        let change = change.filter(|_| self.change.is_on);
        let ghost = |(index, share, tint)| match player.loader().get(index, &needs) {
            Slot::Ready(frame) | Slot::Coarse(frame) | Slot::Partial(frame) | Slot::Stale(frame) => {
                Some(Ghost { frame, share, tint })
            }
            Slot::Pending | Slot::Failed(_) => None,
        };
        let ghosts = Some(self.onion).filter(|onion| onion.is_on);
        let ghosts = ghosts.map_or_else(Vec::new, |onion| onion.around(pose.index, frame_count));
        let request = PoseRequest {
            pose: Arc::clone(pose),
            change: change.map(|to| ChangeRequest {
                to,
                range: self.change.range,
                map: style.colors.map,
            }),
            ghosts: ghosts.into_iter().filter_map(ghost).collect(),
            needs,
        };
        (request.change.is_some() || !request.ghosts.is_empty()).then_some(request)
    }
}

fn key(request: &PoseRequest) -> Option<ChangeKey> {
    let pose = &request.pose;
    Some((pose.index, request.change?.to, pose.frame.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_frame_is_one_of_the_sequence() {
        let with = |step| Temporal {
            change: ChangeMap {
                step,
                ..Temporal::default().change
            },
            ..Temporal::default()
        };
        assert_eq!(with(1).other_frame(3, 5), Some(4));
        assert_eq!(with(2).other_frame(3, 5), None);
        assert_eq!(with(-3).other_frame(3, 5), Some(0));
        assert_eq!(with(-4).other_frame(3, 5), None);
        assert_eq!(with(i64::MAX).other_frame(3, 5), None);
    }
}
