//! Saving the sequence: the choices offered, the predicted size, and the files written.

use super::settings::choose;
use super::{click, options, press, sequence, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{PanelId, PrecisionKind, SaveFormat, Severity, State, WorkKind};
use pointreel::cloud::{Attributes, Positions, RawCloud};
use pointreel::reel::ReelFile;
use pointreel::sequence::{FrameEntry, Sequence, Shape};
use pointreel::source::Spin;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const SAVE: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::CTRL
};

/// A coloured wave of 900 points with normals, that moves.
fn wave(phase: f32) -> RawCloud {
    let places = (0..900).map(|index| {
        let [x, y] = [index % 30, index / 30].map(|place| place as f32 * 0.1);
        [x, y, 0.3 * (x + phase).sin()]
    });
    RawCloud {
        attributes: Attributes {
            colors: Some((0..900).map(|index| [(index % 30 * 8) as u8, 99, 9, 255]).collect()),
            normals: Some(vec![[0.0, 0.6, 0.8]; 900]),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F32(places.collect()))
    }
}

/// Frames of a wave, the same number as in other tests.
fn waves(broken: &'static [u64]) -> Arc<Sequence> {
    visited_waves(super::FRAMES as u64, broken, |_| {})
}

/// This many frames of a wave. Those in `broken` cannot be read; others call `visit` with their number first.
fn visited_waves(count: u64, broken: &'static [u64], visit: impl Fn(u64) + Send + Sync + 'static) -> Arc<Sequence> {
    let entries = (0..count).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/scans/walk/frame_{number:04}.ply"))
    });
    Arc::new(Sequence::with_decoder(entries.collect(), move |entry| {
        let number = entry.number.unwrap_or(0);
        if broken.contains(&number) {
            return Err("it is broken".into());
        }
        visit(number);
        Ok(wave(number as f32 * 0.1))
    }))
}

/// The dialog is open, and files are written to `folder`.
fn saving_of(sequence: Arc<Sequence>, folder: &Path) -> Harness<'static, State> {
    let mut harness = window_on(sequence, options());
    harness.state_mut().features.save.folder = folder.display().to_string();
    press(&mut harness, SAVE, Key::S);
    assert!(harness.state().panels.has(PanelId::SAVE));
    harness
}

/// Updates until `is_done`.
fn wait(harness: &mut Harness<'_, State>, what: &str, is_done: impl Fn(&State) -> bool) {
    let patience = Instant::now();
    while !is_done(harness.state()) {
        assert!(patience.elapsed() < Duration::from_mins(1), "{what}");
        let now = harness.state().now() + Duration::from_millis(10);
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

fn wait_for_estimate(harness: &mut Harness<'_, State>, frames: usize) {
    wait(harness, "an estimate", |state| {
        let estimate = state.features.save.estimates.estimate();
        let has_all = estimate.is_some_and(|(estimate, is_old)| !is_old && estimate.frames == frames);
        has_all && !state.features.save.estimates.is_busy()
    });
}

/// The message once it is over; there was none before.
fn finish(harness: &mut Harness<'_, State>) -> String {
    wait(harness, "the end of saving", |state| {
        !state.shared.works.has(WorkKind::Save) && !state.notices.list().is_empty()
    });
    let said = harness.state().notices.list()[0].text.clone();
    dismiss_all(harness);
    said
}

fn dismiss_all(harness: &mut Harness<'_, State>) {
    let notices = &mut harness.state_mut().notices;
    let ids: Vec<u64> = notices.list().iter().map(|notice| notice.id).collect();
    for id in ids {
        notices.dismiss(id);
    }
}

fn save_button_is_offered(harness: &Harness<'_, State>, word: &str) -> bool {
    let button = harness.get_by_role_and_label(Role::Button, word);
    !button.accesskit_node().is_disabled()
}

#[test]
fn sizes_and_errors_are_shown_before_a_sequence_file_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    wait_for_estimate(&mut harness, 5);
    assert!(harness.query_by_label("Estimate by 5 frames of 24").is_some());
    let (estimate, _) = harness.state().features.save.estimates.estimate().unwrap();
    let rough = estimate.errors.unwrap();
    assert!(rough.largest > 0.0 && rough.normals_deg.is_some() && rough.color_psnr_db.is_some());
    for told in ["about ", ", RMS 0.", "geometry ", "mean "] {
        assert!(harness.query_all_by_label_contains(told).next().is_some(), "{told}");
    }
    click(&mut harness, "Save");
    let said = finish(&mut harness);
    let file = folder.path().join("walk.reel");
    assert_eq!(said, format!("Saved 24 frames: {}", file.display()));
    let reel = ReelFile::open_path(&file).unwrap();
    assert_eq!(reel.frame_count(), 24);
    // Some hundred bytes describe which conversion wrote the file, the same number for small frames as for large ones.
    let described = reel.part().map_or(0, |part| part.made_of.len());
    let written = reel.byte_size() as f64 - described as f64;
    let expected = 24.0 * estimate.frame_bytes;
    assert!(
        (0.95..1.05).contains(&(written / expected)),
        "{written} bytes, {expected} were expected"
    );

    // Saving again would replace it, and a message says so.
    press(&mut harness, SAVE, Key::S);
    assert!(harness.query_by_label_contains("it is replaced").is_some());
    choose(&mut harness, "Positions", "Lossless");
    wait_for_estimate(&mut harness, 5);
    let (lossless, _) = harness.state().features.save.estimates.estimate().unwrap();
    assert_eq!(lossless.errors.unwrap().largest, 0.0);
    assert!(lossless.bits_per_point() > 2.0 * estimate.bits_per_point());
    // For neither positions nor normals.
    assert_eq!(harness.query_all_by_label("none").count(), 2);
    click(&mut harness, "Replace");
    finish(&mut harness);
    let opened = Sequence::discover(&[file]).unwrap();
    assert_eq!(opened.decode(3).unwrap().positions.len(), 900);
}

#[test]
fn changing_options_cancels_the_estimate_and_shows_the_previous_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    wait_for_estimate(&mut harness, 5);
    let (before, _) = harness.state().features.save.estimates.estimate().unwrap();
    harness.state_mut().features.save.choose_precision(PrecisionKind::Bits);
    harness.state_mut().features.save.bits = 4;
    let now = harness.state().now();
    harness.state_mut().update(now);
    // Nothing starts before the choices have been unchanged for a while.
    assert_eq!(harness.state().features.save.estimates.estimate(), Some((before, true)));
    assert!(
        harness
            .state()
            .next_deadline()
            .is_some_and(|due| due > now && due < now + Duration::from_secs(1))
    );
    wait_for_estimate(&mut harness, 5);
    let (coarse, _) = harness.state().features.save.estimates.estimate().unwrap();
    assert!(coarse.retained_points < 500.0, "{coarse:?}");
    // Frames that were decoded for the previous choices are not decoded again.
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().panels.has(PanelId::SAVE));
    harness.state_mut().update(now);
    assert_eq!(harness.state().features.save.estimates.estimate(), None);
}

#[test]
fn frames_are_saved_as_files_in_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[2]), folder.path());
    choose(&mut harness, "Format", "Files: ply");
    assert_eq!(
        harness.state().features.save.format,
        SaveFormat::Files("ply".parse().unwrap())
    );
    assert!(harness.query_by_label("Colour error").is_none(), "files keep all");
    wait_for_estimate(&mut harness, 4);
    assert!(
        harness.query_by_label_contains("could not be evaluated").is_some(),
        "frame 2 is broken"
    );
    let (estimate, _) = harness.state().features.save.estimates.estimate().unwrap();
    assert_eq!(estimate.errors.unwrap().largest, 0.0);
    click(&mut harness, "Save");
    wait(&mut harness, "the end of saving", |state| {
        !state.shared.works.has(WorkKind::Save) && state.notices.list().len() >= 2
    });
    let notices = harness.state().notices.list();
    let texts: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
    assert!(
        texts.iter().any(|text| text.starts_with("Saved 23 frames")),
        "{texts:?}"
    );
    assert!(
        texts.iter().any(|text| text.starts_with("Frame 3 is not in it")),
        "{texts:?}"
    );
    let written = folder.path().join("walk/frame_0005.ply");
    assert_eq!(fs::metadata(&written).unwrap().len() as f64, estimate.frame_bytes);
    // Another format is not mixed with them.
    press(&mut harness, SAVE, Key::S);
    choose(&mut harness, "Format", "Files: pcd");
    assert!(harness.query_by_label_contains("other files in this folder").is_some());
    assert!(!save_button_is_offered(&harness, "Save"));
}

#[test]
fn a_cancelled_file_resumes_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    // Groups of 30 frames are encoded by all threads at the same time; later frames wait.
    let threads = std::thread::available_parallelism().unwrap().get() as u64;
    let whole = 30 * threads;
    let (open, gate) = sync_channel::<()>(0);
    let gate = Mutex::new(gate);
    let is_closed = Arc::new(AtomicBool::new(false));
    let closed = Arc::clone(&is_closed);
    let sequence = visited_waves(whole + 5, &[], move |number| {
        if number == whole + 2 && closed.load(Ordering::Relaxed) {
            // A dropped gate counts as open.
            let _ = gate.lock().unwrap().recv();
        }
    });
    let mut harness = saving_of(sequence, folder.path());
    wait_for_estimate(&mut harness, 5);
    is_closed.store(true, Ordering::Relaxed);
    click(&mut harness, "Save");
    let done = whole as usize + 2;
    wait(&mut harness, "frames before the gate", |state| {
        state.shared.works.list()[0].progress().done() >= done
    });
    assert!(!harness.state_mut().may_close(), "closing would interrupt it");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    let now = harness.state().now() + Duration::from_secs(1);
    harness.state_mut().update(now);
    harness.run();
    let bar = format!("frames {done} of {}", whole + 5);
    assert!(harness.query_by_label_contains(&bar).is_some(), "{bar}");
    click(&mut harness, "Cancel");
    drop(open);
    let said = finish(&mut harness);
    assert!(said.contains(&format!("cancelled after {whole} frames")), "{said}");
    assert!(!folder.path().join("walk.reel").exists());
    press(&mut harness, SAVE, Key::S);
    assert!(harness.query_by_label_contains("it goes on from that").is_some());
    click(&mut harness, "Go on");
    let said = finish(&mut harness);
    assert!(said.starts_with(&format!("Saved {} frames", whole + 5)), "{said}");
    let reel = ReelFile::open_path(&folder.path().join("walk.reel")).unwrap();
    assert_eq!(reel.frame_count() as u64, whole + 5);
}

#[test]
fn impossible_saves_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let live = Arc::new(Sequence::of(Spin::new(Shape::Torus, 500)));
    let mut state = State::new(options());
    state.open(live);
    state.features.save.folder = folder.path().display().to_string();
    state.run(pointreel::app::Command::TOGGLE_SAVE);
    state.start_save();
    assert!(
        state.notices.list()[0].text.contains("live"),
        "{:?}",
        state.notices.list()[0]
    );
    assert!(!state.shared.works.has(WorkKind::Save));

    let mut harness = saving_of(sequence(&[]), &folder.path().join("missing"));
    assert!(harness.query_by_label_contains("does not exist").is_some());
    assert!(!save_button_is_offered(&harness, "Save"));
    harness.state_mut().start_save();
    assert_eq!(harness.state().notices.list()[0].severity, Severity::Error);
}

#[test]
fn a_file_created_meanwhile_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    let file = folder.path().join("walk.reel");
    fs::write(&file, "mine").unwrap();
    click(&mut harness, "Save");
    assert_eq!(harness.state().notices.list()[0].severity, Severity::Error);
    assert!(!harness.state().shared.works.has(WorkKind::Save));
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    // Now it is reported.
    dismiss_all(&mut harness);
    harness.run();
    assert!(harness.query_by_label_contains("it is replaced").is_some());
    click(&mut harness, "Replace");
    let said = finish(&mut harness);
    assert!(said.starts_with("Saved 24 frames"), "{said}");
}

#[test]
fn the_result_is_previewed_next_to_the_open_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    choose(&mut harness, "Positions", "Bits");
    harness.state_mut().features.save.bits = 4;
    click(&mut harness, "Compare");
    wait(&mut harness, "the frame of B", |state| {
        state
            .features
            .split_view
            .as_ref()
            .is_some_and(|split_view| split_view.companion.shown().is_some())
    });
    let split_view = harness.state().features.split_view.as_ref().unwrap();
    assert_eq!(split_view.name, "walk, as it would be saved");
    let points = split_view.companion.shown().unwrap().frame.len();
    assert!(points > 20 && points < 500, "{points}");
}

#[test]
fn merging_shows_its_cost_before_it_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    wait_for_estimate(&mut harness, 5);
    assert_eq!(harness.state().features.save.precision, PrecisionKind::PointSpacing);
    let (every, _) = harness.state().features.save.estimates.estimate().unwrap();
    assert_eq!(every.retained_points, every.points);
    let merged = every.other_way.unwrap();
    let price = format!(
        "Merges {:.0} of {:.0} points per frame",
        every.points - merged.points,
        every.points
    );
    assert!(harness.query_by_label_contains(&price).is_some(), "{price}");
    harness.get_by_role_and_label(Role::CheckBox, "Merging").click();
    harness.run();
    // The dialog requests an estimate for its choices once it has been drawn with them.
    harness.run();
    let now = harness.state().now() + Duration::from_millis(10);
    harness.state_mut().update(now);
    wait_for_estimate(&mut harness, 5);
    assert_eq!(harness.state().features.save.precision, PrecisionKind::SamplingDensity);
    let (estimate, _) = harness.state().features.save.estimates.estimate().unwrap();
    assert_eq!(estimate.retained_points, merged.points);
    assert!(harness.query_by_label_contains(&price).is_some(), "{price}");
}

#[test]
fn every_control_of_the_dialog_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saving_of(waves(&[]), folder.path());
    for precision in ["Point spacing", "Bits", "Length", "Lossless"] {
        if precision != "Point spacing" {
            choose(&mut harness, "Positions", precision);
        }
        wait_for_estimate(&mut harness, 5);
        assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    }
    assert!(harness.query_by_label("Order").is_some());
    assert!(harness.query_by_label("Normals").is_some());
}
