//! Frames that take long to read: their bar, and their end when they are no longer needed.

use super::{click, options};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::panels::window_ui;
use pointreel::app::{Command, State, apply_theme};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::sequence::{FrameEntry, Sequence};
use pointreel::source::FrameList;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Number of steps, of ten, that a test lets a decoder do.
#[derive(Default)]
struct Gate {
    may_do: AtomicUsize,
    has_done: AtomicUsize,
    /// Decoders that went away.
    ended: AtomicUsize,
}

/// Files; the ones in `slow` are decoded as a gate lets them.
fn sequence(count: usize, slow: &'static [usize]) -> (Arc<Sequence>, Arc<Gate>) {
    let sources = (0..count).map(|number| FrameEntry::file(format!("/scans/walk/frame_{number}.ply")));
    let gate = Arc::new(Gate::default());
    let held = Arc::clone(&gate);
    let sequence = Sequence::of(FrameList::new(sources.collect(), move |source, progress| {
        let is_slow = slow.iter().any(|n| source.name == format!("frame_{n}.ply"));
        let mut done = if is_slow { 0 } else { 10 };
        progress.set(done, 10);
        while done < 10 && !progress.is_cancelled() {
            if done < held.may_do.load(Ordering::Relaxed) {
                done += 1;
                progress.set(done, 10);
                held.has_done.store(done, Ordering::Relaxed);
            }
            thread::sleep(Duration::from_millis(1));
        }
        held.ended.fetch_add(1, Ordering::Relaxed);
        Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3]; 8])))
    }));
    (Arc::new(sequence), gate)
}

fn window_on(sequence: Arc<Sequence>) -> Harness<'static, State> {
    let mut state = State::new(options());
    state.open(sequence);
    Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(20)
        .with_context_setup(apply_theme)
        .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state)
}

fn at(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

/// Waits for the work of another thread, with the window's time at rest.
fn until(harness: &mut Harness<'_, State>, is_so: impl Fn(&State) -> bool) {
    let begin = Instant::now();
    loop {
        let now = harness.state().now();
        harness.state_mut().update(now);
        if is_so(harness.state()) {
            break;
        }
        assert!(begin.elapsed() < Duration::from_secs(20), "nothing happens");
        thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

/// Lets a decoder continue to this step, and shows the window at `seconds`.
fn show(harness: &mut Harness<'_, State>, gate: &Gate, done: usize, seconds: f64) {
    gate.may_do.store(done, Ordering::Relaxed);
    while gate.has_done.load(Ordering::Relaxed) < done {
        thread::sleep(Duration::from_millis(1));
    }
    harness.state_mut().update(at(seconds));
    harness.run();
}

fn bar(harness: &Harness<'_, State>, label: &str) -> bool {
    harness
        .query_by_role_and_label(Role::ProgressIndicator, label)
        .is_some()
}

#[test]
fn a_slow_first_frame_has_a_progress_bar_and_can_be_cancelled() {
    let (sequence, gate) = sequence(3, &[0, 1, 2]);
    let mut harness = window_on(sequence);
    until(&mut harness, |state| !state.shared.works.list().is_empty());
    show(&mut harness, &gate, 2, 0.5);
    assert!(
        harness.query_by_label("Reading frame_0.ply").is_none(),
        "it may not take long"
    );
    show(&mut harness, &gate, 3, 1.5);
    harness.get_by_label("Reading frame_0.ply");
    assert!(bar(&harness, "30 %, 0:07 left"));
    show(&mut harness, &gate, 5, 2.5);
    assert!(bar(&harness, "50 %, 0:04 left"));
    // The window checks again by itself.
    assert_eq!(harness.state().next_deadline(), Some(at(2.6)));

    click(&mut harness, "Cancel");
    until(&mut harness, |state| state.player.is_none());
    harness.get_by_label("No sequence is open");
    harness.get_by_label("Opening walk was cancelled");
    until(&mut harness, |state| state.shared.works.list().is_empty());
    assert_eq!(gate.ended.load(Ordering::Relaxed), 1, "no other is begun");

    harness.state_mut().run(Command::OPEN_DEMO);
    until(&mut harness, |state| {
        let player = state.player.as_ref().unwrap();
        player.shown().is_some()
    });
}

#[test]
fn a_later_frame_that_is_cancelled_is_skipped() {
    // The automatic settings use frames 3, 6, 8 and 11: nothing else waits for the second.
    let (sequence, gate) = sequence(11, &[1]);
    let mut harness = window_on(sequence);
    let shown = |state: &State| {
        let player = state.player.as_ref().unwrap();
        player.shown().map(|frame| frame.index)
    };
    until(&mut harness, |state| shown(state) == Some(0));
    harness.state_mut().step_frames(1);
    until(&mut harness, |state| !state.shared.works.list().is_empty());
    show(&mut harness, &gate, 4, 2.0);
    assert!(bar(&harness, "40 %, …"), "no pace was seen yet");
    click(&mut harness, "Cancel");
    until(&mut harness, |state| !state.notices.list().is_empty());
    let text = &harness.state().notices.list()[0].text;
    assert!(text.starts_with("Frame 2 of 11 is skipped."), "{text}");
    assert!(text.contains("cancelled: open it again"), "{text}");
    harness.state_mut().step_frames(1);
    until(&mut harness, |state| shown(state) == Some(2));
}

#[test]
fn a_replaced_sequence_is_not_read_further() {
    let (slow, gate) = sequence(1, &[0]);
    let mut harness = window_on(slow);
    until(&mut harness, |state| !state.shared.works.list().is_empty());
    harness.state_mut().run(Command::OPEN_DEMO);
    until(&mut harness, |_| gate.ended.load(Ordering::Relaxed) == 1);
    assert!(harness.state().notices.list().is_empty());
    assert_eq!(harness.state().sequence_name().as_deref(), Some("demo"));
}
