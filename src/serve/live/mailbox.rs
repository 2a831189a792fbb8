//! Mailbox of messages to send to one client: two frames at most, and answers.
//!
//! A frame that arrives while two wait replaces the oldest: the newest wins. So that frames do not queue in the buffers
//! of the network instead, which hold seconds of small ones, no more than two are in flight: a client acknowledges
//! received frames ([`crate::wire::Got`]). One that never does so is sent as much as the network takes. A client whose
//! answers take longer than two frames last gets two frames in that time.

use super::outgoing::Outgoing;
use crate::locks::lock;
use crate::wire::{Message, Now};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Frames that wait.
pub(super) const MAX_FRAMES: usize = 2;

/// Answers that wait: a client that sends pings more often is not answered.
const MAX_ANSWERS: usize = 8;

/// Frames in flight to a client that acknowledges received ones.
// Without this bound, network buffers hold seconds of small frames. The price: a client whose acknowledgements take
// longer than two frames last gets two per round trip, 20 frames per second at a round-trip time of 100 ms.
const MAX_ON_THE_WAY: usize = 2;

/// Next item of a client's send queue.
#[derive(Debug)]
pub(super) enum Next {
    Frame(Arc<Outgoing>),
    Answer(Message),
    /// There is nothing.
    Nothing,
    /// Nothing more, for this reason.
    End(String),
}

/// Outgoing mailbox of one client: the messages queued for sending.
#[derive(Debug, Default)]
pub(super) struct Mailbox {
    inside: Mutex<Inside>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Inside {
    frames: VecDeque<Arc<Outgoing>>,
    answers: VecDeque<Message>,
    /// Numbers of the newest frames that were sent and not received yet.
    on_the_way: VecDeque<u64>,
    says_what_it_got: bool,
    dropped: u64,
    end: Option<String>,
}

impl Inside {
    fn is_free(&self) -> bool {
        !self.says_what_it_got || self.on_the_way.len() < MAX_ON_THE_WAY
    }
}

impl Mailbox {
    /// Takes a frame; returns true if another one was dropped for it.
    pub(super) fn push(&self, frame: Arc<Outgoing>) -> bool {
        let mut inside = lock(&self.inside);
        let drops = inside.frames.len() >= MAX_FRAMES;
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
        if inside.answers.len() < MAX_ANSWERS {
            inside.answers.push_back(message);
        }
        drop(inside);
        self.changed.notify_all();
    }

    /// The client has received the frame of this number, and those before it.
    pub(super) fn got(&self, number: u64) {
        let mut inside = lock(&self.inside);
        inside.says_what_it_got = true;
        inside.on_the_way.retain(|sent| *sent > number);
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

    /// Waits for the next message to send, at most that long.
    pub(super) fn next(&self, at_most: Duration) -> Next {
        let inside = lock(&self.inside);
        let nothing = |inside: &mut Inside| {
            let has_frame = !inside.frames.is_empty() && inside.is_free();
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
        if !inside.is_free() {
            return Next::Nothing;
        }
        let Some(frame) = inside.frames.pop_front() else {
            return Next::Nothing;
        };
        if inside.on_the_way.len() >= MAX_ON_THE_WAY {
            inside.on_the_way.pop_front();
        }
        inside.on_the_way.push_back(frame.number);
        Next::Frame(frame)
    }
}

/// Returns the heartbeat message, sent when there has been no frame for a while.
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
        let mailbox = Mailbox::default();
        let drops: Vec<bool> = (0..5).map(|number| mailbox.push(frame(number))).collect();
        assert_eq!(drops, [false, false, true, true, true]);
        assert_eq!(
            (sent(&mailbox), sent(&mailbox), sent(&mailbox)),
            (Some(3), Some(4), None)
        );
        assert_eq!(mailbox.dropped(), 3);
    }

    #[test]
    fn frames_in_flight_are_limited_by_what_a_client_receives() {
        let mailbox = Mailbox::default();
        let mut push_and_send = |number| {
            mailbox.push(frame(number));
            sent(&mailbox)
        };
        assert_eq!(push_and_send(0), Some(0));
        mailbox.got(0);
        // Two are in transit; the third waits until one has arrived.
        assert_eq!([1, 2, 3].map(&mut push_and_send), [Some(1), Some(2), None]);
        mailbox.got(1);
        assert_eq!(sent(&mailbox), Some(3));
        // A client that never acknowledges frames is sent all of them.
        let silent = Mailbox::default();
        let all = (0..8).filter(|&number| {
            silent.push(frame(number));
            sent(&silent).is_some()
        });
        assert_eq!(all.count(), 8);
    }

    #[test]
    fn answers_come_before_frames_and_the_end_before_everything() {
        let mailbox = Mailbox::default();
        mailbox.push(frame(0));
        for number in 0..20 {
            mailbox.answer(heartbeat(number, None));
        }
        let answers = (0..20).filter(|_| matches!(mailbox.next(Duration::ZERO), Next::Answer(_)));
        assert_eq!(answers.count(), MAX_ANSWERS);
        mailbox.answer(heartbeat(0, None));
        mailbox.end("it is over");
        assert!(matches!(mailbox.next(Duration::from_mins(1)), Next::End(reason) if reason == "it is over"));
    }
}
