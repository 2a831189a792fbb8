//! Exports: the choices offered, and the files written by the window's own thread.

use super::settings::choose;
use super::{click, options, press, sequence, window, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use image::AnimationDecoder as _;
use image::codecs::gif::GifDecoder;
use pointreel::app::{Command, ExportSubject, PanelId, Severity, State, WorkKind};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::export::VideoFormat;
use pointreel::scene::{Primitive, RendererChoice};
use pointreel::sequence::{FrameEntry, Sequence};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The choices are open, and files are written to `folder`.
fn exporting(folder: &Path) -> Harness<'static, State> {
    exporting_of(sequence(&[]), folder)
}

fn exporting_of(sequence: Arc<Sequence>, folder: &Path) -> Harness<'static, State> {
    let mut harness = window_on(sequence, options());
    harness.state_mut().style.drawing.renderer = RendererChoice::Cpu.into();
    press(&mut harness, Modifiers::SHIFT, Key::P);
    let export = &mut harness.state_mut().features.export;
    export.folder = folder.display().to_string();
    export.size_px = Some([48, 32]);
    export.has_ffmpeg = false;
    harness.run();
    harness
}

fn set(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    harness
        .get_by_role_and_label(Role::SpinButton, label)
        .set_value_accesskit(value);
    harness.run();
}

fn is_offered(harness: &Harness<'_, State>, role: Role, label: &str) -> bool {
    let node = harness.get_by_role_and_label(role, label);
    !node.accesskit_node().is_disabled()
}

/// Updates until the export is over and its outcome is shown.
fn finish(harness: &mut Harness<'_, State>) -> String {
    let patience = Instant::now();
    while harness.state().shared.works.has(WorkKind::Export) || harness.state().notices.list().is_empty() {
        assert!(patience.elapsed() < Duration::from_mins(1));
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
    harness.state().notices.list()[0].text.clone()
}

fn names(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = files
        .map(|file| file.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_turntable_is_exported_as_gif_while_the_window_stays_responsive() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    choose(&mut harness, "What", "Turntable");
    set(&mut harness, "Images", 6.0);
    assert!(harness.query_by_label("6 images of 48 × 32, 0.2 s").is_some());
    click(&mut harness, "Export");
    assert!(!harness.state().panels.has(PanelId::EXPORT));
    // It draws with the settings chosen when it started.
    harness.state_mut().style.drawing.renderer = RendererChoice::Gpu.into();
    harness.state_mut().camera.orbit(90.0, 0.0);
    let said = finish(&mut harness);
    let file = folder.path().join("pointreel-walk-turntable.gif");
    assert!(said.contains(&file.display().to_string()), "{said}");
    let reader = BufReader::new(File::open(&file).unwrap());
    let frames = GifDecoder::new(reader).unwrap().into_frames();
    let frames = frames.collect_frames().unwrap();
    assert_eq!(frames.len(), 6);
    assert_eq!(frames[0].buffer().dimensions(), (48, 32));
    assert_ne!(frames[0].buffer(), frames[3].buffer());
    assert_eq!(names(folder.path()).len(), 1);
}

#[test]
fn the_sequence_is_exported_as_png_files_from_in_to_out_point() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    let state = harness.state_mut();
    state.style.primitive = Primitive::Point.into();
    for (frame, command) in [(3, Command::SET_IN), (6, Command::SET_OUT)] {
        let now = state.now();
        state.player.as_mut().unwrap().seek(frame, now);
        state.update(now);
        state.run(command);
    }
    choose(&mut harness, "What", "Sequence");
    assert_eq!(harness.state().features.export.per_second, 24.0);
    choose(&mut harness, "Format", "PNG files");
    harness.get_by_role_and_label(Role::CheckBox, "Background").click();
    harness.run();
    harness.state_mut().features.export.name = Some("walk".to_owned());
    harness.run();
    click(&mut harness, "Export");
    finish(&mut harness);
    let expected: Vec<String> = (0..4).map(|frame| format!("walk-{frame:04}.png")).collect();
    assert_eq!(names(folder.path()), expected);
    let picture = image::open(folder.path().join(&expected[0])).unwrap();
    let picture = picture.to_rgba8();
    assert_eq!(picture.get_pixel(0, 0).0, [0; 4]);
    assert!(picture.pixels().any(|pixel| pixel.0[3] == 255));

    // Exporting again would replace them, and a message says so.
    press(&mut harness, Modifiers::SHIFT, Key::P);
    assert!(harness.query_by_label_contains("it is replaced").is_some());
}

#[test]
fn the_camera_path_is_offered_once_it_has_keyframes() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    choose(&mut harness, "What", "Camera path");
    assert!(!is_offered(&harness, Role::Button, "Export"));
    assert!(harness.query_by_label_contains("no keyframes yet").is_some());
    for _ in 0..2 {
        harness.state_mut().run(Command::ADD_KEYFRAME);
        harness.state_mut().camera.orbit(30.0, 0.0);
    }
    harness.run();
    let text = "61 images of 48 × 32, 2.0 s";
    assert!(harness.query_by_label(text).is_some());
    assert!(is_offered(&harness, Role::Button, "Export"));
}

#[test]
fn unsupported_options_of_a_format_are_not_offered() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    choose(&mut harness, "What", "Turntable");
    harness.get_by_role_and_label(Role::ComboBox, "Format").click();
    harness.run();
    assert!(!is_offered(&harness, Role::Button, "MP4"), "without ffmpeg");
    harness.state_mut().features.export.has_ffmpeg = true;
    harness.run();
    click(&mut harness, "MP4");
    assert_eq!(harness.state().features.export.format, VideoFormat::Mp4);
    assert!(!is_offered(&harness, Role::CheckBox, "Background"));
    assert!(is_offered(&harness, Role::Button, "Export"));
    set(&mut harness, "Width", 49.0);
    assert!(harness.query_by_label_contains("even edges").is_some());
    assert!(!is_offered(&harness, Role::Button, "Export"));
    choose(&mut harness, "Size", "1280 × 720");
    assert_eq!(harness.state().export_size_px(), [1280, 720]);
    choose(&mut harness, "What", "Image");
    set(&mut harness, "Height", 1e9);
    assert_eq!(harness.state().export_size_px(), [1280, 65_536]);
    harness.state_mut().features.export.name = Some("a/b".to_owned());
    harness.run();
    assert!(!is_offered(&harness, Role::Button, "Export"));
}

#[test]
fn an_exported_image_matches_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    assert_eq!(harness.state().features.export.subject, ExportSubject::Picture);
    click(&mut harness, "Export");
    let said = finish(&mut harness);
    let file = folder.path().join("pointreel-walk-picture.png");
    assert!(said.contains(&file.display().to_string()), "{said}");
    let picture = image::open(&file).unwrap().to_rgba8();
    assert_eq!(picture.dimensions(), (48, 32));
    assert_ne!(picture.get_pixel(24, 16), picture.get_pixel(0, 0));
}

/// Frames that are not available before `gate` is opened: all but the first, whose origin is needed.
fn gated(gate: std::sync::mpsc::Receiver<()>) -> Arc<Sequence> {
    let gate = Mutex::new(gate);
    let sources = (0..super::FRAMES as u64)
        .map(|number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(format!("/scans/walk/frame_{number:04}.ply"))
        })
        .collect();
    let seen = Mutex::new(std::collections::HashSet::new());
    Arc::new(Sequence::with_decoder(sources, move |source| {
        // The window reads every frame once; the second read is the export's.
        let is_again = !seen.lock().unwrap().insert(source.number);
        if is_again && source.number == Some(3) {
            // A dropped gate counts as open.
            let _ = gate.lock().unwrap().recv();
        }
        let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
        Ok(RawCloud::from_positions(Positions::F32(corners.collect())))
    }))
}

#[test]
fn a_cancelled_export_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (open, gate) = sync_channel::<()>(0);
    let mut harness = exporting_of(gated(gate), folder.path());
    harness.state_mut().choose_export(ExportSubject::Sequence);
    harness.run();
    click(&mut harness, "Export");
    // Three images are drawn, the fourth waits for its frame.
    let patience = Instant::now();
    while harness.state().shared.works.list()[0].progress().done() < 3 {
        assert!(patience.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.state_mut().update(Duration::from_secs(1));
    harness.run();
    assert!(
        harness.query_by_label("image 3 of 24, …").is_some(),
        "nothing was seen done before: the pace is not known"
    );
    assert!(!harness.state_mut().may_close(), "closing would lose the export");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    click(&mut harness, "Cancel");
    assert!(harness.query_by_label("Stopping…").is_some());
    drop(open);
    let said = finish(&mut harness);
    assert!(said.contains("cancelled"), "{said}");
    assert_eq!(names(folder.path()), [""; 0]);
    assert!(harness.query_by_label("Stopping…").is_none());
}

#[test]
fn failed_writes_are_reported_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(&folder.path().join("missing"));
    click(&mut harness, "Export");
    let said = finish(&mut harness);
    assert!(said.contains("missing"), "{said}");
    assert_eq!(harness.state().notices.list()[0].severity, Severity::Error);
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn unreadable_frames_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting_of(sequence(&[2]), folder.path());
    harness.state_mut().choose_export(ExportSubject::Sequence);
    harness.run();
    let told = harness.state().notices.list().len();
    click(&mut harness, "Export");
    let patience = Instant::now();
    while harness.state().notices.list().len() < told + 2 {
        assert!(patience.elapsed() < Duration::from_mins(1));
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(2));
    }
    let notices = harness.state().notices.list();
    let texts: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
    assert!(
        texts.iter().any(|text| text.starts_with("Frame 3 is not shown in it")),
        "{texts:?}"
    );
}

#[test]
fn every_control_of_the_export_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    for subject in [ExportSubject::Picture, ExportSubject::Turntable, ExportSubject::Path] {
        harness.state_mut().choose_export(subject);
        harness.run();
        assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().panels.has(PanelId::EXPORT));
    assert!(window().query_by_label("Browse…").is_none());
}

#[test]
fn videos_show_the_same_ghosts_and_colors_as_the_image() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = exporting(folder.path());
    let state = harness.state_mut();
    state.style.primitive = Primitive::Point.into();
    for (frame, command) in [(3, Command::SET_IN), (5, Command::SET_OUT)] {
        let now = state.now();
        state.player.as_mut().unwrap().seek(frame, now);
        state.run(command);
    }
    state.features.export.format = VideoFormat::PngFiles;
    let mut export = |subject: ExportSubject, name: &str, is_on: bool| {
        let state = harness.state_mut();
        state.features.temporal.onion.is_on = is_on;
        state.features.temporal.change.is_on = is_on;
        state.choose_export(subject);
        state.features.export.name = Some(name.to_owned());
        state.start_export();
        let said = finish(&mut harness);
        assert!(said.starts_with("Exported"), "{said}");
        let id = harness.state().notices.list()[0].id;
        harness.state_mut().notices.dismiss(id);
    };
    // The player is at the last frame of the range.
    export(ExportSubject::Picture, "single", true);
    export(ExportSubject::Sequence, "with", true);
    export(ExportSubject::Sequence, "without", false);
    let open = |name: &str| image::open(folder.path().join(name)).unwrap().to_rgba8();
    let single = open("single.png");
    assert!(open("with-0002.png") == single, "the picture of the same frame");
    assert!(open("without-0002.png") != single);
}
