//! Two sequences side by side.

use super::points::click_on;
use super::{click, drag, load_all, options, press, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::DVec3;
use pointreel::app::{Command, Layout, Side, State, StateOptions, Tool, WindowRequest};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::playback::PairBy;
use pointreel::scene::{Primitive, Scene, Settings};
use pointreel::sequence::{FrameEntry, Sequence};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// `FRAMES` of the window's own sequence are loaded by its helpers.
use super::FRAMES;

/// Cubes of edge 1 at `place`, in a folder `name`, `spacing_ms` apart if there are times; frames in `broken` cannot be
/// read.
fn cubes(
    name: &'static str,
    place: DVec3,
    count: usize,
    spacing_ms: Option<u64>,
    broken: &'static [u64],
) -> Arc<Sequence> {
    let source = |number: u64| FrameEntry {
        number: Some(number),
        time: spacing_ms.map(|spacing| Duration::from_millis(1000 + number * spacing)),
        ..FrameEntry::file(format!("/scans/{name}/{name}_{number:02}.ply"))
    };
    let sources = (0..count as u64).map(source).collect();
    Arc::new(Sequence::with_decoder(sources, move |source| {
        if broken.contains(&source.number.unwrap_or(0)) {
            return Err(format!("{}: torn", source.name).into());
        }
        let corner = |index: u32| place + DVec3::from_array([0, 1, 2].map(|axis| half(index, axis)));
        let corners = (0..8).map(|index| corner(index).to_array()).collect();
        Ok(RawCloud::from_positions(Positions::F64(corners)))
    }))
}

fn half(corner: u32, axis: u32) -> f64 {
    f64::from(corner >> axis & 1) - 0.5
}

/// A window on cubes with points of 9 pixels, paused, next to `b`; all frames loaded.
fn split_view(b: &Arc<Sequence>) -> Harness<'static, State> {
    second_with(cubes("left", DVec3::ZERO, FRAMES, Some(40), &[]), b, options())
}

fn second_with(a: Arc<Sequence>, b: &Arc<Sequence>, options: StateOptions) -> Harness<'static, State> {
    let mut harness = window_on(a, options);
    harness.state_mut().style = Settings::default().with(|style| {
        style.primitive = Primitive::Point.into();
        style.points.size_px = 9.0;
    });
    load_all(harness.state_mut());
    harness.state_mut().compare_with(Arc::clone(b));
    load_both(&mut harness);
    harness
}

/// Waits until the second loader has every frame.
fn load_both(harness: &mut Harness<'_, State>) {
    let now = harness.state().now();
    harness.state_mut().update(now);
    let state = harness.state();
    let loader = state.features.split_view.as_ref().unwrap().companion.loader();
    for index in 0..loader.sequence().len() {
        // A broken frame counts as well.
        let _ = loader.wait(index, &Scene::needs(&state.style.decided()));
    }
    harness.state_mut().update(now);
    harness.run();
    draw(harness);
}

/// The window's work after each run of the panels.
fn draw(harness: &mut Harness<'_, State>) {
    harness.state_mut().next_packet();
    harness.state_mut().next_other_packet();
}

fn go_to(harness: &mut Harness<'_, State>, frame: usize) {
    let now = harness.state().now();
    let player = harness.state_mut().player.as_mut().unwrap();
    player.seek(frame, now);
    harness.state_mut().update(now);
    harness.run();
    draw(harness);
}

fn companion_frame(harness: &Harness<'_, State>) -> Option<usize> {
    let companion = &harness.state().features.split_view.as_ref().unwrap().companion;
    assert_eq!(companion.shown().map(|frame| frame.index), companion.frame());
    companion.frame()
}

fn budgets(harness: &Harness<'_, State>) -> [usize; 2] {
    let state = harness.state();
    let of_a = state.player.as_ref().unwrap().loader().stats().budget_bytes;
    let split_view = state.features.split_view.as_ref();
    let of_b = split_view.map_or(0, |split_view| split_view.companion.loader().stats().budget_bytes);
    [of_a, of_b]
}

#[test]
fn a_second_sequence_is_found_shown_and_closed() {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..3 {
        let path = folder.path().join(format!("scan_{frame}.xyz"));
        std::fs::write(path, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    }
    let a = cubes("left", DVec3::ZERO, FRAMES, None, &[]);
    let budget_bytes = (64 << 20) + 1;
    let with_budget = StateOptions {
        budget_bytes: Some(budget_bytes),
        ..options()
    };
    let mut harness = window_on(a, with_budget);
    assert_eq!(budgets(&harness), [budget_bytes, 0]);
    harness.state_mut().compare_paths(vec![folder.path().to_owned()]);
    let begin = Instant::now();
    while harness.state().features.split_view.is_none() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no answer");
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(5));
    }
    load_both(&mut harness);
    assert!(harness.state().notices.list().is_empty());
    // All of the budget, and no more.
    assert_eq!(budgets(&harness).iter().sum::<usize>(), budget_bytes);
    harness.state_mut().set_budget_bytes(32 << 20);
    assert_eq!(budgets(&harness), [16 << 20; 2]);
    let name = folder.path().file_name().unwrap().to_string_lossy();
    for label in ["A  left_00.ply", &format!("B  {name}: scan_0.xyz")] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
    for (role, label) in [
        (Role::Button, "Side by side"),
        (Role::Button, "Line"),
        (Role::Button, "Index"),
        (Role::Button, "Time"),
        (Role::SpinButton, "Offset"),
        (Role::Button, "Measure distances"),
        (Role::Slider, "Line between A and B"),
    ] {
        assert!(harness.query_by_role_and_label(role, label).is_some(), "{label}");
    }
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    // C compares two styles, and does not discard the sequence.
    press(&mut harness, Modifiers::NONE, Key::C);
    assert!(harness.state().features.split_view.is_some() && harness.state().features.comparison.is_none());
    click(&mut harness, "Close comparison");
    assert!(harness.state().features.split_view.is_none());
    assert_eq!(budgets(&harness), [32 << 20, 0]);
    assert!(harness.query_by_label("Offset").is_none());
}

#[test]
fn incomparable_sequences_are_reported() {
    let mut harness = window_on(cubes("left", DVec3::ZERO, FRAMES, None, &[]), options());
    harness.state_mut().compare_paths(vec!["/nowhere/at/all".into()]);
    let begin = Instant::now();
    while harness.state().notices.list().is_empty() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no answer");
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(5));
    }
    let text = &harness.state().notices.list()[0].text;
    assert!(text.contains("/nowhere/at/all"), "{text}");
    assert!(harness.state().features.split_view.is_none());
}

#[test]
fn the_split_view_is_reached_by_menus_and_keys() {
    let b = cubes("right", DVec3::ZERO, 3, None, &[]);
    let mut harness = split_view(&b);
    click(&mut harness, "File");
    let item = |text: &str| {
        let items = harness.get_all_by_role(Role::Button);
        items
            .filter(|node| {
                node.accesskit_node()
                    .label()
                    .is_some_and(|label| label.starts_with(text))
            })
            .count()
    };
    assert_eq!(item("Compare with…"), 1);
    assert_eq!(item("Close comparison"), 2, "in the menu and in the bar");
    harness.get_by_label("Compare with…").click();
    harness.run();
    for text in ["Compare with files…", "Compare with a folder…"] {
        assert!(harness.query_by_label_contains(text).is_some(), "{text}");
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(
        harness.state().features.split_view.as_ref().unwrap().layout,
        Layout::SideBySide
    );
    for layout in [Layout::Wipe, Layout::SideBySide] {
        press(&mut harness, Modifiers::SHIFT, Key::C);
        assert_eq!(harness.state().features.split_view.as_ref().unwrap().layout, layout);
    }
    harness.state_mut().run(Command::CLOSE_COMPARISON);
    harness.run();
    assert!(harness.state().features.split_view.is_none());
}

#[test]
fn one_camera_shows_both_side_by_side_or_overlaid() {
    let b = cubes("right", DVec3::ZERO, 3, None, &[]);
    let mut harness = split_view(&b);
    let packets = |harness: &mut Harness<'_, State>| {
        harness.state_mut().forget_picture();
        let state = harness.state_mut();
        [state.next_packet().unwrap(), state.next_other_packet().unwrap()]
    };
    let [a, b] = packets(&mut harness);
    let whole = harness.state().viewport.rect.union(harness.state().viewport.other_rect);
    assert_eq!(a.viewport_px[0] + b.viewport_px[0], whole.width() as u32);
    assert!(a.viewport_px[0].abs_diff(b.viewport_px[0]) <= 1);
    // The divider moves, and no view is squeezed: the vertical extent is the same at any width.
    let place = |share: f32| egui::pos2(whole.left() + share * whole.width(), whole.center().y);
    drag(&mut harness, place(0.5), place(0.25));
    let [a, b] = packets(&mut harness);
    assert!(a.viewport_px[0] < b.viewport_px[0]);
    assert_eq!(a.viewport_px[1], b.viewport_px[1]);
    assert_eq!(a.view.focal[1], b.view.focal[1]);
    for packet in [&a, &b] {
        let [width, height] = packet.viewport_px.map(|edge| edge as f32);
        let aspect = packet.view.focal[1] / packet.view.focal[0];
        assert!((aspect - width / height).abs() < 1e-4);
    }
    assert_eq!(a.view.eye_high, b.view.eye_high);
    // A drag in either half rotates both.
    for share in [0.1, 0.7] {
        let before = harness.state().camera;
        drag(&mut harness, place(share), place(share + 0.1));
        assert_ne!(harness.state().camera, before);
        let [a, b] = packets(&mut harness);
        assert_eq!(a.view.view_from_frame_rotation, b.view.view_from_frame_rotation);
    }
    drag(&mut harness, place(0.25), place(0.02));
    assert_eq!(harness.state().pictures().unwrap().split, 0.1, "no half without width");
    click(&mut harness, "Line");
    let [a, b] = packets(&mut harness);
    assert_eq!(a.view, b.view);
    assert_eq!(a.viewport_px[0], whole.width() as u32);
    assert_eq!(harness.state().viewport.rect, harness.state().viewport.other_rect);
}

#[test]
fn frames_are_paired_by_time_by_index_and_with_an_offset() {
    // Half the rate of A, and as long as six of its frames.
    let b = cubes("right", DVec3::ZERO, 3, Some(80), &[]);
    let mut harness = split_view(&b);
    let by = |harness: &Harness<'_, State>| {
        harness
            .state()
            .features
            .split_view
            .as_ref()
            .unwrap()
            .companion
            .paired_by()
    };
    assert_eq!(by(&harness), PairBy::Time);
    go_to(&mut harness, 4);
    assert_eq!(companion_frame(&harness), Some(2));
    go_to(&mut harness, 8);
    assert_eq!(companion_frame(&harness), None);
    assert!(harness.query_by_label("B  right: no frame at this time").is_some());
    assert!(harness.state_mut().next_other_packet().is_none());
    let offset = harness.get_by_role_and_label(Role::SpinButton, "Offset");
    offset.set_value_accesskit(-2.0);
    harness.run();
    go_to(&mut harness, 8);
    assert_eq!(companion_frame(&harness), Some(2));
    assert!(harness.query_by_label("B  right_02.ply").is_some());
    click(&mut harness, "Index");
    go_to(&mut harness, 3);
    assert_eq!(companion_frame(&harness), Some(1));
    click(&mut harness, "Time");
    assert_eq!(by(&harness), PairBy::Time);

    // Without times the numbers in the names decide.
    let b = cubes("right", DVec3::ZERO, 3, None, &[]);
    let mut harness = split_view(&b);
    assert_eq!(by(&harness), PairBy::Number);
    click(&mut harness, "Time");
    assert_eq!(by(&harness), PairBy::Number, "there are no times to choose");
    go_to(&mut harness, 5);
    assert!(harness.query_by_label("B  right: no frame of this number").is_some());
    click(&mut harness, "Index");
    assert_eq!(by(&harness), PairBy::Index);
}

#[test]
fn a_broken_frame_of_b_is_reported_by_name() {
    let b = cubes("right", DVec3::ZERO, FRAMES, None, &[1]);
    let mut harness = split_view(&b);
    go_to(&mut harness, 1);
    assert!(harness.query_by_label("B  right: frame 2 cannot be shown").is_some());
    let text = &harness.state().notices.list()[0].text;
    assert!(text.starts_with("Frame 2 of 24 of B (right) is skipped."), "{text}");
    go_to(&mut harness, 2);
    assert!(harness.query_by_label("B  right_02.ply").is_some());
}

#[test]
fn a_known_shift_has_known_distances() {
    let b = cubes("right", DVec3::new(0.25, 0.0, 0.0), 3, None, &[]);
    let mut harness = split_view(&b);
    click(&mut harness, "Measure distances");
    let begin = Instant::now();
    while harness.query_by_label_contains("Hausdorff").is_none() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no answer");
        harness.state_mut().update(Duration::ZERO);
        harness.run();
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run();
    let way = "mean 0.25  RMS 0.25  largest 0.25";
    let expected = format!("A→B  {way}   B→A  {way}   Hausdorff 0.25");
    assert!(harness.query_by_label(&expected).is_some());
    assert!(harness.query_by_label("Measure distances").is_none());
    // For other frames nothing is known yet.
    go_to(&mut harness, 1);
    assert!(harness.query_by_label_contains("Hausdorff").is_none());
    assert!(harness.query_by_label("Measure distances").is_some());
}

#[test]
fn clicks_show_which_sequence_a_point_belongs_to() {
    let b = cubes("right", DVec3::new(0.0, 2.0, 0.0), 3, None, &[]);
    let mut harness = split_view(&b);
    harness.state_mut().run(Command::RESET_VIEW);
    harness.run();
    draw(&mut harness);
    // The window position of a point in one of the halves.
    let place = |harness: &Harness<'_, State>, side: Side, place: DVec3| {
        let (state, viewport) = (harness.state(), harness.state().viewport);
        let (rect, size_px) = match side {
            Side::A => (viewport.rect, viewport.size_px),
            Side::B => (viewport.other_rect, viewport.other_size_px),
        };
        let px = state.camera.to_px(place, size_px).unwrap();
        rect.min + egui::vec2(px.x as f32, px.y as f32)
    };
    let corner = |side: Side| {
        let up = if side == Side::B { 2.0 } else { 0.0 };
        DVec3::new(0.5, 0.5 + up, 0.5)
    };
    harness.state_mut().features.inspection.toggle(Tool::Point);
    for layout in [Layout::SideBySide, Layout::Wipe] {
        let is_wipe = layout == Layout::Wipe;
        for side in [Side::A, Side::B] {
            if is_wipe {
                if side == Side::A {
                    press(&mut harness, Modifiers::SHIFT, Key::C);
                }
                // The whole image is on one side of the divider.
                let split = if side == Side::A { 1.0 } else { 0.0 };
                harness.state_mut().features.split_view.as_mut().unwrap().pictures.split = split;
                harness.run();
                draw(&mut harness);
            }
            let at = place(&harness, side, corner(side));
            click_on(&mut harness, at, 1);
            let point = harness.state().features.inspection.point.clone().unwrap();
            assert_eq!((point.anchor.side, point.anchor.index_in_file), (side, 7));
            assert_eq!(point.values.position, corner(side));
            let name = if side == Side::A { "A left" } else { "B right" };
            assert!(harness.query_by_label(name).is_some(), "{name}");
            // The other one has nothing there.
            let nothing = place(&harness, side, corner(if side == Side::A { Side::B } else { Side::A }));
            harness.state_mut().features.inspection.point = None;
            click_on(&mut harness, nothing, 1);
            assert!(harness.state().features.inspection.point.is_none());
        }
    }
    press(&mut harness, Modifiers::SHIFT, Key::C);
    draw(&mut harness);
    harness.state_mut().features.inspection.toggle(Tool::Point);
    // A double click in B's half moves the camera towards its point.
    let at = place(&harness, Side::B, corner(Side::B));
    click_on(&mut harness, at, 2);
    harness.state_mut().update(Duration::from_secs(5));
    let target = harness.state().camera.target_in_world;
    assert!(target.distance(corner(Side::B)) < 1e-6, "{target}");
    // Picked points of B are removed with it.
    harness.run();
    draw(&mut harness);
    harness.state_mut().features.inspection.toggle(Tool::Point);
    let at = place(&harness, Side::B, corner(Side::B));
    click_on(&mut harness, at, 1);
    assert!(harness.state().features.inspection.point.is_some());
    harness.state_mut().run(Command::CLOSE_COMPARISON);
    assert!(harness.state().features.inspection.point.is_none());
}

#[test]
fn disjoint_clouds_are_reported_and_one_key_shows_both() {
    let b = cubes("right", DVec3::new(4.0, 5.0, 0.0), 3, None, &[]);
    let harness = split_view(&b);
    let texts: Vec<&str> = harness
        .state()
        .notices
        .list()
        .iter()
        .map(|notice| notice.text.as_str())
        .collect();
    // From 0.5 to 3.5 and to 4.5: a triangle of 3, 4 and 5.
    assert!(
        texts.len() == 1 && texts[0].starts_with("B (right) is 5 away from A (left)"),
        "{texts:?}"
    );
    let mut harness = harness;
    let radius = harness.state().camera.distance;
    press(&mut harness, Modifiers::NONE, Key::R);
    let camera = harness.state().camera;
    let off_center = camera.target_in_world - DVec3::new(2.0, 2.5, 0.0);
    assert!(off_center.length() < 1.0, "{off_center}");
    assert!(camera.distance > radius);
    // Clouds that overlap need no notice.
    let b = cubes("right", DVec3::new(0.9, 0.0, 0.0), 3, None, &[]);
    assert!(split_view(&b).state().notices.list().is_empty());
}

#[test]
fn images_are_only_compared_when_overlaid() {
    let b = cubes("right", DVec3::ZERO, 3, None, &[]);
    let mut harness = split_view(&b);
    let compares_at = |harness: &mut Harness<'_, State>, millis| {
        harness.state_mut().update(Duration::from_millis(millis));
        harness.state_mut().take_requests() == [WindowRequest::Compare]
    };
    assert!(!compares_at(&mut harness, 1000));
    assert!(harness.query_by_label("Error map").is_none());
    click(&mut harness, "Line");
    draw(&mut harness);
    assert!(harness.query_by_label("Error map").is_some());
    assert!(compares_at(&mut harness, 2000));
    assert!(!compares_at(&mut harness, 3000), "once");
    // Without a frame of B there is nothing to compare.
    harness.state_mut().camera.orbit(5.0, 0.0);
    go_to(&mut harness, 7);
    assert_eq!(companion_frame(&harness), None);
    assert!(!compares_at(&mut harness, 4000));
}

/// A file as the window system hands it over.
#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("nobody asks for them".to_owned())
    }
}

#[test]
fn a_drop_opens_and_with_shift_compares() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dropped.xyz");
    std::fs::write(&path, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let mut harness = window_on(cubes("left", DVec3::ZERO, FRAMES, None, &[]), options());
    let drop_with = |harness: &mut Harness<'_, State>, modifiers: Modifiers| {
        let name = |state: &State| {
            [
                state.sequence_name(),
                state.features.split_view.as_ref().map(|b| b.name.clone()),
            ]
        };
        let before = name(harness.state());
        let input = harness.input_mut();
        let changed = egui::Event::ModifiersChanged;
        input.events.push(changed(modifiers));
        input.dropped_files.push(Arc::new(Dropped(path.clone())));
        harness.step();
        let released = changed(Modifiers::NONE);
        harness.input_mut().events.push(released);
        harness.step();
        let begin = Instant::now();
        while name(harness.state()) == before {
            assert!(begin.elapsed() < Duration::from_secs(20), "no answer");
            harness.state_mut().update(Duration::ZERO);
            std::thread::sleep(Duration::from_millis(5));
        }
        name(harness.state())
    };
    let (left, dropped) = (Some("left".to_owned()), Some("dropped.xyz".to_owned()));
    let names = drop_with(&mut harness, Modifiers::SHIFT);
    assert_eq!(names, [left, dropped.clone()]);
    // Opened instead of both.
    let names = drop_with(&mut harness, Modifiers::NONE);
    assert_eq!(names, [dropped, None]);
}

#[test]
fn another_document_has_no_comparison() {
    let far = DVec3::new(5e5, 0.0, 0.0);
    let b = cubes("right", far + DVec3::X, FRAMES, Some(40), &[]);
    let mut harness = split_view(&b);
    let whole = budgets(&harness).iter().sum::<usize>();
    harness.state_mut().open(cubes("other", far, FRAMES, Some(40), &[]));
    load_all(harness.state_mut());
    assert_eq!(harness.state().sequence_name().as_deref(), Some("other"));
    assert!(
        harness.state().features.split_view.is_none(),
        "it is of the document before"
    );
    assert_eq!(budgets(&harness), [whole, 0]);
}
