//! A window at rest draws nothing: images and their reasons, counted as the event loop decides them.

use super::{options, window_on};
use egui::ViewportId;
use egui_kittest::Harness;
use pointreel::app::{State, StateOptions};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::sequence::{FrameEntry, FrameState, Sequence};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Polling interval of the test.
const STEP: Duration = Duration::from_millis(50);

/// The window with the part of the event loop that draws.
struct Driven {
    harness: Harness<'static, State>,
    woken: Arc<AtomicBool>,
    /// By the clock passed to the window.
    now: Duration,
    redraws: usize,
}

impl Driven {
    fn on(sequence: Arc<Sequence>, budget_bytes: usize) -> Self {
        let woken = Arc::new(AtomicBool::new(false));
        let wakes = Arc::clone(&woken);
        let options = StateOptions {
            budget_bytes: Some(budget_bytes),
            wake: Arc::new(move || wakes.store(true, Ordering::Relaxed)),
            ..options()
        };
        let mut driven = Self {
            harness: window_on(sequence, options),
            woken,
            now: Duration::ZERO,
            redraws: 0,
        };
        driven.redraw();
        driven
    }

    fn redraw(&mut self) {
        self.harness.state_mut().update(self.now);
        self.harness.step();
        let state = self.harness.state_mut();
        state.next_packet();
        state.next_other_packet();
        self.redraws += 1;
    }

    /// The event loop at its time: it updates after a wake, and draws if something visibly changes, is due, or is new.
    fn step(&mut self) {
        self.now += STEP;
        let state = self.harness.state_mut();
        let mut is_due = state.next_deadline().is_some_and(|due| due <= self.now);
        if self.woken.swap(false, Ordering::Relaxed) {
            is_due |= state.update(self.now).is_visible() || state.has_news();
        }
        let output = &self.harness.output().viewport_output;
        let delay = output[&ViewportId::ROOT].repaint_delay;
        if is_due || delay <= STEP {
            self.redraw();
        }
    }

    /// Continues until nothing is in progress and nothing was drawn for half a second.
    fn settle(&mut self) {
        let patience = Instant::now();
        let mut steps_at_rest = 0;
        while steps_at_rest < 10 {
            assert!(patience.elapsed() < Duration::from_mins(1), "never at rest");
            let before = self.redraws;
            thread::sleep(Duration::from_millis(2));
            self.step();
            let player = self.harness.state().player.as_ref().unwrap();
            let is_at_rest = self.redraws == before && !player.loader().is_busy();
            steps_at_rest = if is_at_rest { steps_at_rest + 1 } else { 0 };
        }
    }

    fn pictures(&self) -> u64 {
        self.harness.state().shared.counters.pictures
    }

    /// Redraws and rendered images in five seconds.
    fn of_five_seconds(&mut self) -> (usize, u64) {
        let before = (self.redraws, self.pictures());
        for _ in 0..100 {
            self.step();
        }
        (self.redraws - before.0, self.pictures() - before.1)
    }
}

/// Frames of 20,000 points: about a megabyte each.
fn sequence() -> Arc<Sequence> {
    let sources = (0..super::FRAMES).map(|n| FrameEntry::file(format!("/scans/walk/frame_{n:02}.ply")));
    Arc::new(Sequence::with_decoder(sources.collect(), |_| {
        let place = |n: usize| [(n % 100) as f32, (n / 100) as f32, (n % 7) as f32];
        let places = (0..20_000).map(place).collect();
        Ok(RawCloud::from_positions(Positions::F32(places)))
    }))
}

#[test]
fn nothing_is_drawn_while_nothing_is_under_way() {
    let mut driven = Driven::on(sequence(), 1 << 30);
    driven.settle();
    assert!(driven.pictures() > 0, "it has been drawn");
    assert_eq!(driven.of_five_seconds(), (0, 0));
    // A wake-up without news draws nothing either.
    driven.woken.store(true, Ordering::Relaxed);
    assert_eq!(driven.of_five_seconds(), (0, 0));
}

#[test]
fn coarse_copies_redraw_no_image_but_update_the_timeline_marks() {
    let mut driven = Driven::on(sequence(), 12 << 20);
    driven.settle();
    let state = driven.harness.state();
    let loader = state.player.as_ref().unwrap().loader();
    let copies = loader.stats().coarse_frames;
    assert!(copies > 0, "there is no memory for all frames");
    assert!(loader.states().contains(&FrameState::Coarse));
    assert!(
        driven.pictures() <= 2,
        "of the first frame, and from where all are seen"
    );
    assert_eq!(driven.of_five_seconds(), (0, 0));
}
