use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;
use crate::scene::Primitive;
use crate::sequence::FrameEntry;
use crate::source::{About, Capabilities, Decoder, Growth, Source};
use std::collections::BTreeSet;
use std::sync::{Condvar, Mutex};
use std::time::Instant;

/// Duration of a frame at 24 fps; rounded up like the clock's deadlines.
const FRAME: Duration = Duration::from_nanos(41_666_667);

/// Lets the decoder have frames one by one: the disk of these tests is as slow as they want.
#[derive(Debug, Default)]
struct Gate {
    open: Mutex<BTreeSet<u64>>,
    changed: Condvar,
}

impl Gate {
    fn let_through(&self, frames: impl IntoIterator<Item = u64>) {
        self.open.lock().unwrap().extend(frames);
        self.changed.notify_all();
    }

    fn pass(&self, frame: u64) {
        let open = self.open.lock().unwrap();
        drop(self.changed.wait_while(open, |open| !open.contains(&frame)).unwrap());
    }
}

struct Fixture {
    gate: Arc<Gate>,
    player: Player,
    style: Style,
}

impl Drop for Fixture {
    /// The loader joins its threads, which must not wait for the gate then.
    fn drop(&mut self) {
        self.gate.let_through(0..1000);
    }
}

impl Fixture {
    fn new(play: bool) -> Self {
        Self::of_frames(10, play)
    }

    fn of_frames(count: u64, play: bool) -> Self {
        let gate = Arc::new(Gate::default());
        let waiting = Arc::clone(&gate);
        let sources = (0..count).map(|number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(format!("frame_{number}.ply"))
        });
        let sequence = Sequence::with_decoder(sources.collect(), move |source| {
            waiting.pass(source.number.unwrap_or(0));
            Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]])))
        });
        let player = Player::new(Arc::new(sequence), LoaderOptions::default(), play).unwrap();
        let style = Style {
            primitive: Primitive::Point,
            ..Style::default()
        };
        Self { gate, player, style }
    }

    fn update(&mut self, now: Duration) -> Option<usize> {
        self.player.update(now, &self.style);
        self.player.shown().map(|frame| frame.index)
    }

    /// Lets `frames` through and waits until the loader has them.
    fn load(&mut self, frames: std::ops::Range<u64>) {
        self.gate.let_through(frames.clone());
        let needs = Scene::needs(&self.style);
        let begin = Instant::now();
        for frame in frames {
            while matches!(self.player.loader.get(frame as usize, &needs), Slot::Pending) {
                assert!(begin.elapsed() < Duration::from_secs(20), "frame {frame} does not come");
                std::thread::yield_now();
            }
        }
    }
}

#[test]
fn a_single_frame_is_at_rest_once_loaded() {
    let mut fixture = Fixture::of_frames(1, true);
    fixture.update(Duration::ZERO);
    assert!(fixture.player.is_playing(), "as far as anybody knows");
    fixture.load(0..1);
    assert_eq!(fixture.update(FRAME), Some(0));
    assert!(!fixture.player.is_playing());
    assert_eq!(fixture.player.next_deadline(), None);
}

#[test]
fn playing_starts_with_the_first_drawn_frame() {
    let mut fixture = Fixture::new(true);
    assert_eq!(fixture.update(Duration::ZERO), None);
    assert_eq!(fixture.update(Duration::from_secs(7)), None);
    assert_eq!(
        fixture.player.next_deadline(),
        None,
        "only the loader can bring something"
    );
    fixture.load(0..3);
    assert_eq!(fixture.update(Duration::from_secs(8)), Some(0));
    assert_eq!(fixture.player.next_deadline(), Some(Duration::from_secs(8) + FRAME));
    assert_eq!(fixture.update(Duration::from_secs(8) + FRAME), Some(1));
}

#[test]
fn a_slow_disk_holds_the_clock_and_loses_no_frame() {
    let mut fixture = Fixture::new(true);
    fixture.update(Duration::ZERO);
    fixture.load(0..1);
    let mut now = Duration::ZERO;
    assert_eq!(fixture.update(now), Some(0));
    for frame in 1..6 {
        now += FRAME;
        assert_eq!(fixture.update(now), Some(frame - 1), "frame {frame} is not there yet");
        assert_eq!(fixture.player.waiting_for(), Some(frame));
        now += Duration::from_secs(1);
        fixture.load(frame as u64..frame as u64 + 1);
        assert_eq!(fixture.update(now), Some(frame));
    }
    assert_eq!(fixture.player.clock().skipped(), 0);
    assert_eq!(fixture.player.frames_shown(), 6);
}

#[test]
fn a_slow_screen_skips_frames_and_counts_them() {
    let mut fixture = Fixture::new(true);
    fixture.update(Duration::ZERO);
    fixture.load(0..10);
    assert_eq!(fixture.update(Duration::ZERO), Some(0));
    assert_eq!(fixture.update(4 * FRAME + FRAME / 2), Some(4));
    assert_eq!(fixture.player.clock().skipped(), 3);
}

#[test]
fn the_achieved_rate_is_measured() {
    let mut fixture = Fixture::new(true);
    fixture.update(Duration::ZERO);
    fixture.load(0..10);
    for half in 0..100 {
        fixture.update(half * 2 * FRAME);
    }
    let held = fixture.player.fps_held().unwrap();
    assert!((held - 12.0).abs() < 0.1, "{held}");
    fixture.player.toggle(200 * FRAME);
    assert_eq!(fixture.player.fps_held(), None);
}

#[test]
fn pausing_and_seeking_while_waiting_stay_at_the_requested_frame() {
    let mut fixture = Fixture::new(true);
    fixture.update(Duration::ZERO);
    fixture.load(0..1);
    fixture.update(Duration::ZERO);
    fixture.update(FRAME);
    assert_eq!(fixture.player.waiting_for(), Some(1));
    fixture.player.toggle(Duration::from_secs(5));
    assert!(!fixture.player.is_playing());
    fixture.update(Duration::from_secs(6));
    assert_eq!(
        fixture.player.clock().frame(),
        1,
        "not where the clock would have run to"
    );
    fixture.player.seek(8, Duration::from_secs(7));
    fixture.update(Duration::from_secs(7));
    assert_eq!(fixture.player.waiting_for(), Some(8));
    fixture.load(1..9);
    assert_eq!(fixture.update(Duration::from_secs(8)), Some(8));
    assert_eq!(fixture.update(Duration::from_secs(99)), Some(8));
}

#[test]
fn waiting_for_the_last_frame_of_a_sequence_that_does_not_loop_ends_there() {
    let mut fixture = Fixture::new(false);
    fixture.player.set_loop_mode(LoopMode::Off, Duration::ZERO);
    fixture.update(Duration::ZERO);
    fixture.load(0..9);
    fixture.player.seek(8, Duration::ZERO);
    assert_eq!(fixture.update(Duration::ZERO), Some(8));
    fixture.player.toggle(Duration::ZERO);
    assert_eq!(fixture.update(FRAME), Some(8));
    assert_eq!(fixture.player.waiting_for(), Some(9));
    assert!(fixture.player.is_playing());
    fixture.load(9..10);
    assert_eq!(fixture.update(Duration::from_secs(2)), Some(9));
    assert_eq!(fixture.update(Duration::from_secs(9)), Some(9));
    assert!(!fixture.player.is_playing());
}

#[test]
fn read_warnings_of_a_frame_are_reported_once() {
    let sources = (0..3).map(|number| FrameEntry::file(format!("frame_{number}.ply")));
    let sequence = Sequence::with_decoder(sources.collect(), |source| {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]]));
        if source.name != "frame_1.ply" {
            cloud.warnings = vec![format!("{}: no faces", source.name)];
        }
        Ok(cloud)
    });
    let sequence = Arc::new(sequence);
    let mut player = Player::new(sequence, LoaderOptions::default(), false).unwrap();
    let style = Style {
        primitive: Primitive::Point,
        ..Style::default()
    };
    let mut told = Vec::new();
    for frame in [0, 1, 2, 0, 2] {
        player.seek(frame, Duration::ZERO);
        told.extend(player.update(Duration::ZERO, &style).new_warnings);
        let needs = Scene::needs(&style);
        player.loader().wait(frame, &needs).unwrap();
        told.extend(player.update(Duration::ZERO, &style).new_warnings);
        assert_eq!(player.shown().map(|shown| shown.index), Some(frame));
    }
    assert_eq!(told, ["frame_0.ply: no faces", "frame_2.ply: no faces"]);
}

/// Frames that a test lets come and go.
#[derive(Default)]
struct LiveFrames {
    frames: Mutex<std::ops::Range<usize>>,
}

impl Source for Arc<LiveFrames> {
    fn frames(&self) -> std::ops::Range<usize> {
        self.frames.lock().unwrap().clone()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::new(FrameEntry::embedded(format!("{index}"), &[]))
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(|_: &FrameEntry, _: &Progress| Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3]; 8]))))
    }

    fn about(&self) -> About<'_> {
        About::default()
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            growth: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Growth for Arc<LiveFrames> {
    fn may_grow(&self) -> bool {
        false
    }

    fn is_live(&self) -> bool {
        true
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        Ok(0)
    }
}

#[test]
fn a_stream_faster_than_frame_preparation_is_still_shown() {
    let stream = Arc::new(LiveFrames::default());
    *stream.frames.lock().unwrap() = 0..1;
    let sequence = Arc::new(Sequence::of(Arc::clone(&stream)));
    let mut player = Player::new(Arc::clone(&sequence), LoaderOptions::default(), false).unwrap();
    player.follow_newest(true, Duration::ZERO);
    let style = Style::default();
    let begin = std::time::Instant::now();
    let mut seen = Vec::new();
    // Another frame has arrived before each update.
    for end in 2.. {
        *stream.frames.lock().unwrap() = 0..end;
        player.update(Duration::from_millis(10 * end as u64), &style);
        if let Some(frame) = player.shown().filter(|frame| seen.last() != Some(&frame.index)) {
            seen.push(frame.index);
        }
        if seen.len() == 5 {
            break;
        }
        assert!(begin.elapsed() < Duration::from_secs(20), "only {seen:?} are seen");
        std::thread::yield_now();
    }
    assert!(seen.is_sorted(), "{seen:?}");
}

#[test]
fn the_newest_stream_frame_is_shown_and_expired_ones_are_not_played() {
    let stream = Arc::new(LiveFrames::default());
    *stream.frames.lock().unwrap() = 0..1;
    let sequence = Arc::new(Sequence::of(Arc::clone(&stream)));
    let loader = LoaderOptions {
        workers: 1,
        ..LoaderOptions::default()
    };
    let mut player = Player::new(Arc::clone(&sequence), loader, false).unwrap();
    let style = Style::default();
    player.follow_newest(true, Duration::ZERO);
    let shown = |player: &mut Player, now_ms: u64| {
        let begin = std::time::Instant::now();
        loop {
            player.update(Duration::from_millis(now_ms), &style);
            if player.waiting_for().is_none() && (player.shown().is_some() || player.failure().is_some()) {
                let failed = player.failure().map(ToString::to_string);
                return (player.shown().map(|frame| frame.index), failed);
            }
            assert!(begin.elapsed() < Duration::from_secs(20), "no frame comes");
            std::thread::yield_now();
        }
    };
    assert_eq!(shown(&mut player, 0), (Some(0), None));
    *stream.frames.lock().unwrap() = 7..10;
    assert_eq!(shown(&mut player, 100), (Some(9), None));
    // Resumed, playback loops over the available frames.
    player.toggle(Duration::from_millis(200));
    let mut seen = Vec::new();
    for step in 1..=4 {
        seen.push(shown(&mut player, 200 + 1000 * step / 24 + 5 * step).0.unwrap());
    }
    assert!(seen.iter().all(|frame| (7..10).contains(frame)), "{seen:?}");
    // Seeking to a frame that is gone reports that; one that is still cached is shown.
    player.toggle(Duration::from_secs(1));
    player.seek(3, Duration::from_secs(1));
    let (_, failed) = shown(&mut player, 1000);
    assert!(failed.unwrap().contains("frame 4 (index 3) is gone"));
    player.seek(0, Duration::from_secs(1));
    assert_eq!(shown(&mut player, 1000), (Some(0), None));
}
