//! What one client is to be sent: two frames at most, and answers.
//!
//! A frame that comes while two wait takes the place of the oldest: the newest wins. So that frames do not queue in the
//! buffers of the network instead, no more are on the way than two, and as many as a frame takes to be received on a
//! connection that is free; a client says what it has received ([`crate::wire::Got`]). One that never says so is sent
//! what the network takes.

use super::outgoing::Outgoing;
use crate::locks::lock;
use crate::wire::{Message, Now};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Frames that wait.
pub(super) const MOST_FRAMES: usize = 2;

/// Answers that wait: a client that asks more often is not answered.
const MOST_ANSWERS: usize = 8;

/// Frames on the way where one takes no time.
const FEWEST_ON_THE_WAY: usize = 2;

/// Frames on the way at most, however far the client is.
const MOST_ON_THE_WAY: usize = 64;

/// Of the last so many frames the fastest tells how far away the client is.
const REMEMBERED_WAYS: usize = 64;

/// What is to be sent next.
#[derive(Debug)]
pub(super) enum Next {
    Frame(Arc<Outgoing>),
    Answer(Message),
    /// There is nothing.
    Nothing,
    /// Nothing more, for this reason.
    End(String),
}

/// What one client is to be sent.
#[derive(Debug)]
pub(super) struct Mailbox {
    inside: Mutex<Inside>,
    changed: Condvar,
    /// Of the stream.
    spacing: Duration,
}

#[derive(Debug, Default)]
struct Inside {
    frames: VecDeque<Arc<Outgoing>>,
    answers: VecDeque<Message>,
    /// Numbers of frames that were sent and not received yet, and when they were.
    on_the_way: VecDeque<(u64, Instant)>,
    ways: VecDeque<Duration>,
    says_what_it_got: bool,
    dropped: u64,
    end: Option<String>,
}

impl Inside {
    fn is_free(&self, spacing: Duration) -> bool {
        if !self.says_what_it_got {
            return true;
        }
        let fastest = self.ways.iter().min().copied().unwrap_or_default();
        let frames = fastest.as_secs_f64() / spacing.as_secs_f64().max(1e-6);
        let most = FEWEST_ON_THE_WAY.saturating_add(frames as usize).min(MOST_ON_THE_WAY);
        self.on_the_way.len() < most
    }
}

impl Mailbox {
    /// Of a stream with a frame every `spacing`.
    pub(super) fn new(spacing: Duration) -> Self {
        Self {
            inside: Mutex::default(),
            changed: Condvar::default(),
            spacing,
        }
    }

    /// Takes a frame; says whether another one was dropped for it.
    pub(super) fn push(&self, frame: Arc<Outgoing>) -> bool {
        let mut inside = lock(&self.inside);
        let drops = inside.frames.len() >= MOST_FRAMES;
        if drops {
            inside.frames.pop_front();
            inside.dropped += 1;
        }
        inside.frames.push_back(frame);
        drop(inside);
        self.changed.notify_all();
        drops
    }

    pub(super) fn answer(&self, message: Message) {
        let mut inside = lock(&self.inside);
        if inside.answers.len() < MOST_ANSWERS {
            inside.answers.push_back(message);
        }
        drop(inside);
        self.changed.notify_all();
    }

    /// The client has received the frame of this number, and those before it.
    pub(super) fn got(&self, number: u64, now: Instant) {
        let mut inside = lock(&self.inside);
        inside.says_what_it_got = true;
        while let Some(&(sent, at)) = inside.on_the_way.front()
            && sent <= number
        {
            inside.on_the_way.pop_front();
            if sent == number {
                if inside.ways.len() == REMEMBERED_WAYS {
                    inside.ways.pop_front();
                }
                inside.ways.push_back(now.saturating_duration_since(at));
            }
        }
        drop(inside);
        self.changed.notify_all();
    }

    /// There is nothing more to be sent.
    pub(super) fn end(&self, reason: &str) {
        lock(&self.inside).end.get_or_insert_with(|| reason.to_owned());
        self.changed.notify_all();
    }

    /// Frames that were dropped.
    pub(super) fn dropped(&self) -> u64 {
        lock(&self.inside).dropped
    }

    /// Waits for what is to be sent next, no longer than that.
    pub(super) fn next(&self, at_most: Duration) -> Next {
        let inside = lock(&self.inside);
        let nothing = |inside: &mut Inside| {
            let has_frame = !inside.frames.is_empty() && inside.is_free(self.spacing);
            !has_frame && inside.answers.is_empty() && inside.end.is_none()
        };
        let waited = self.changed.wait_timeout_while(inside, at_most, nothing);
        let (mut inside, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if let Some(reason) = &inside.end {
            return Next::End(reason.clone());
        }
        if let Some(answer) = inside.answers.pop_front() {
            return Next::Answer(answer);
        }
        if !inside.is_free(self.spacing) {
            return Next::Nothing;
        }
        let Some(frame) = inside.frames.pop_front() else {
            return Next::Nothing;
        };
        if inside.on_the_way.len() >= MOST_ON_THE_WAY {
            inside.on_the_way.pop_front();
        }
        inside.on_the_way.push_back((frame.number, Instant::now()));
        Next::Frame(frame)
    }
}

/// What is said where there is no frame for a while.
pub(super) fn heartbeat(clock_ns: u64, newest: Option<u64>) -> Message {
    Now { clock_ns, newest }.message()
}

#[cfg(test)]
mod tests {
    use super::super::outgoing::Body;
    use super::*;
    use crate::wire::{FrameHead, Kind};

    fn frame(number: u64) -> Arc<Outgoing> {
        let head = FrameHead {
            index: 0,
            number,
            time_ns: 0,
            served_ns: 0,
        };
        Arc::new(Outgoing::new(head, Body::new(Kind::Points, Vec::new())))
    }

    fn sent(mailbox: &Mailbox) -> Option<u64> {
        match mailbox.next(Duration::ZERO) {
            Next::Frame(frame) => Some(frame.number),
            _ => None,
        }
    }

    #[test]
    fn the_newest_two_frames_wait() {
        let mailbox = Mailbox::new(Duration::from_millis(33));
        let drops: Vec<bool> = (0..5).map(|number| mailbox.push(frame(number))).collect();
        assert_eq!(drops, [false, false, true, true, true]);
        assert_eq!((sent(&mailbox), sent(&mailbox), sent(&mailbox)), (Some(3), Some(4), None));
        assert_eq!(mailbox.dropped(), 3);
    }

    #[test]
    fn no_more_frames_are_on_the_way_than_a_client_receives() {
        let mailbox = Mailbox::new(Duration::from_millis(100));
        let now = Instant::now();
        let mut push_and_send = |number| {
            mailbox.push(frame(number));
            sent(&mailbox)
        };
        assert_eq!(push_and_send(0), Some(0));
        mailbox.got(0, now);
        // Two are on the way; the third waits until one has come.
        assert_eq!([1, 2, 3].map(&mut push_and_send), [Some(1), Some(2), None]);
        mailbox.got(1, now);
        assert_eq!(sent(&mailbox), Some(3));
        // A client as far away as three frames last is sent three more.
        let far = Mailbox::new(Duration::from_millis(100));
        far.push(frame(0));
        sent(&far);
        far.got(0, Instant::now() + Duration::from_millis(350));
        let sent_far = (1..8).filter(|&number| {
            far.push(frame(number));
            sent(&far).is_some()
        });
        assert_eq!(sent_far.count(), 5);
    }

    #[test]
    fn answers_come_first_and_the_end_before_all() {
        let mailbox = Mailbox::new(Duration::from_millis(33));
        mailbox.push(frame(0));
        for number in 0..20 {
            mailbox.answer(heartbeat(number, None));
        }
        let answers = (0..20).filter(|_| matches!(mailbox.next(Duration::ZERO), Next::Answer(_)));
        assert_eq!(answers.count(), MOST_ANSWERS);
        mailbox.answer(heartbeat(0, None));
        mailbox.end("it is over");
        assert!(matches!(mailbox.next(Duration::from_mins(1)), Next::End(reason) if reason == "it is over"));
    }
}
