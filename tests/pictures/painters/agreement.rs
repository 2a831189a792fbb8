//! Every panel and window of the program, painted with and without a GPU.
#![allow(
    clippy::print_stdout,
    reason = "how close they are is worth a look when one changes the painter"
)]

use super::beside::{Both, Comparison, Pictures, picture};
use crate::walk::{load_all, options, sequence, state_on};
use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton, TextureFilter, TextureId, Theme, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointreel::app::panels::window_ui;
use pointreel::app::{
    BenchmarkJob, BenchmarkTable, Command, PanelId, Preferences, Quantity, State, StateOptions, apply_theme,
};
use pointreel::bench::Table;
use pointreel::scene::{Primitive, Settings};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Points; the settings scroll at this height.
const SIZE: egui::Vec2 = vec2(960.0, 600.0);

/// A window that both painters paint.
struct Shown {
    harness: Harness<'static, State>,
    pictures: Pictures,
    compared: Rc<RefCell<Vec<Comparison>>>,
}

impl Shown {
    fn new(options: StateOptions) -> Self {
        let pictures = Pictures::default();
        let compared = Rc::new(RefCell::new(Vec::new()));
        let mut state = state_on(sequence(&[7]), options);
        state.viewport.texture = Some(TextureId::User(0));
        let harness = Harness::builder()
            .with_size(SIZE)
            .with_max_steps(20)
            .with_context_setup(apply_theme)
            .renderer(Both::new(Rc::clone(&pictures), Rc::clone(&compared)))
            .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state);
        Self {
            harness,
            pictures,
            compared,
        }
    }

    fn state(&mut self) -> &mut State {
        self.harness.state_mut()
    }

    fn click(&mut self, label: &str) {
        let node = self.harness.get_by_role_and_label(Role::Button, label);
        node.click();
        self.harness.run_steps(4);
    }

    /// Images as large as they are shown, or half of it and scaled.
    fn fill_pictures(&mut self, share: u32) {
        let viewport = &self.harness.state().viewport;
        let sizes = [viewport.size_px, viewport.other_size_px];
        let count = if viewport.other_texture.is_some() { 2 } else { 1 };
        let filter = if share == 1 {
            TextureFilter::Nearest
        } else {
            TextureFilter::Linear
        };
        let new = sizes.iter().zip(1..).take(count).map(|(size_px, seed)| {
            let size_px = size_px.map(|edge| edge.div_ceil(share));
            (picture(size_px, seed), filter)
        });
        self.pictures.replace(new.collect());
    }

    /// Light and dark, at three scales; `label` must be seen in each.
    fn compare(&mut self, name: &str, label: &str) {
        for (theme, scale) in [
            (Theme::Dark, 1.0),
            (Theme::Light, 1.5),
            (Theme::Dark, 2.0),
            (Theme::Light, 1.0),
            (Theme::Dark, 1.5),
            (Theme::Light, 2.0),
        ] {
            self.harness.ctx.set_theme(theme);
            let root = self.harness.input_mut().viewports.entry(egui::ViewportId::ROOT);
            root.or_default().native_pixels_per_point = Some(scale);
            // Popups fade in: semi-transparent states are compared as well.
            self.harness.run_steps(3);
            self.fill_pictures(if scale == 1.5 { 2 } else { 1 });
            let seen = self.harness.query_all_by_label_contains(label).next();
            assert!(seen.is_some(), "{name}, {theme:?}, {scale}: no {label}");
            let result = self.harness.render();
            if let Err(error) = result {
                panic!("{name}, {theme:?}, scale {scale}: {error}");
            }
        }
        let compared = self.compared.borrow();
        let sum = |count: fn(&Comparison) -> usize| compared.iter().map(count).sum::<usize>();
        println!(
            "{name}: of {} pixels {} are unequal, {} by more than a step, {} at most",
            sum(|found| found.pixels),
            sum(|found| found.unequal),
            sum(|found| found.odd),
            compared.iter().map(|found| found.largest).max().unwrap(),
        );
    }
}

fn window() -> Shown {
    Shown::new(options())
}

/// Updates until something is so.
fn until(shown: &mut Shown, is_so: impl Fn(&Harness<'_, State>) -> bool) {
    let patience = Instant::now();
    while !is_so(&shown.harness) {
        assert!(patience.elapsed() < Duration::from_mins(1));
        let now = shown.harness.state().now();
        shown.state().update(now);
        shown.harness.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn settings_and_the_timeline() {
    let mut shown = window();
    shown.compare("settings", "Background");
    shown.state().run(Command::TOGGLE_MARKER);
    shown.state().run(Command::SET_IN);
    shown.state().features.timeline.quantity = Some(Quantity::Points);
    shown.state().step_frames(6);
    shown.state().run(Command::SET_OUT);
    shown.compare("timeline", "Marker at frame 1");
}

#[test]
fn thumbnails() {
    let mut shown = Shown::new(StateOptions {
        preferences: Preferences::default(),
        ..options()
    });
    shown.harness.run_steps(2);
    until(&mut shown, |harness| {
        let [made, all] = harness.state().features.thumbnails.progress();
        made == all && all > 0
    });
    shown.compare("thumbnails", "Thumbnail of frame");
}

#[test]
fn statistics_help_and_notices() {
    let mut shown = window();
    shown.state().panels.set(PanelId::STATISTICS, true);
    shown.compare("statistics", "Uploads");
    shown.state().panels.set(PanelId::STATISTICS, false);
    shown.state().panels.set(PanelId::HELP, true);
    shown.compare("help", "Next frame");
    shown.state().panels.set(PanelId::HELP, false);
    shown.state().notices.error("frame_0007.ply: line 3".to_owned());
    shown.state().notices.warn("Frame 1 has colours, frame 6 has none");
    shown.compare("notices", "line 3");
}

#[test]
fn menus_and_the_palette() {
    let mut shown = window();
    shown.click("View");
    shown.compare("menu", "Orthographic");
    let mut shown = window();
    shown.state().run(Command::TOGGLE_PALETTE);
    shown.harness.run_steps(3);
    shown.compare("palette", "command");
}

#[test]
fn the_camera_path_and_exports() {
    let mut shown = window();
    for _ in 0..3 {
        shown.state().run(Command::ADD_KEYFRAME);
        shown.state().step_frames(4);
        shown.state().camera.orbit(40.0, 0.0);
        shown.harness.run_steps(1);
    }
    shown.compare("camera path", "After keyframe 2");
    shown.state().panels.set(PanelId::CAMERA_PATH, false);
    shown.state().features.export.folder = "/scans/out".to_owned();
    shown.state().features.export.has_ffmpeg = false;
    shown.state().run(Command::TOGGLE_EXPORT);
    shown.compare("export", "Export");
}

#[test]
fn a_benchmark() {
    let mut shown = window();
    let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
    let table = Table {
        name: "leaves".to_owned(),
        columns: row(["δ", "loss"]),
        rows: vec![row(["2 %", "1.75"]), row(["10 %", "8.25"])],
    };
    let job: BenchmarkJob = Box::new(move |_, _| {
        Ok(BenchmarkTable {
            suite: "surfels".to_owned(),
            adapter: "Test adapter".to_owned(),
            tables: vec![table],
            bars_title: "median ms".to_owned(),
            bars: vec![("storage".to_owned(), 1.25), ("texture".to_owned(), 2.5)],
            ..BenchmarkTable::default()
        })
    });
    shown.state().start_benchmark_job("surfels", job);
    until(&mut shown, |harness| {
        harness.query_by_label("Surfels × strategies").is_some()
    });
    shown.compare("benchmark", "Surfels × strategies");
}

#[test]
fn values_of_a_point_and_a_tooltip() {
    let mut shown = window();
    shown.state().style = Settings::default().with(|style| {
        style.primitive = Primitive::Point.into();
        style.points.size_px = 9.0;
    });
    load_all(shown.state());
    shown.harness.run();
    shown.state().next_packet().unwrap();
    shown.state().run(Command::PICK_POINTS);
    let viewport = &shown.harness.state().viewport;
    let camera = &shown.harness.state().camera;
    let at_px = camera.to_px(DVec3::splat(0.5), viewport.size_px).unwrap();
    let place = viewport.rect.min + vec2(at_px.x as f32, at_px.y as f32);
    shown.harness.hover_at(place);
    shown.harness.run();
    for pressed in [true, false] {
        shown.harness.input_mut().events.push(Event::PointerButton {
            pos: place,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    shown.harness.run();
    shown.compare("point", "Distance to camera");

    let mut shown = window();
    shown.harness.run();
    let label = shown.harness.get_by_role_and_label(Role::Label, "Splat scale");
    let place = label.rect().center();
    shown.harness.hover_at(place);
    shown.harness.run_steps(60);
    shown.fill_pictures(1);
    let hint = "Factor on every splat's radius";
    assert!(shown.harness.query_by_label_contains(hint).is_some());
    shown.harness.render().unwrap();
}

#[test]
fn change_map() {
    let mut shown = window();
    let role = Role::CheckBox;
    let node = shown.harness.get_by_role_and_label(role, "Change map");
    node.scroll_to_me();
    shown.harness.run();
    let node = shown.harness.get_by_role_and_label(role, "Change map");
    node.click();
    shown.harness.run();
    until(&mut shown, |harness| harness.query_by_label("Copy numbers").is_some());
    shown.compare("change map", "Copy numbers");
}

#[test]
fn two_images_with_a_line_between() {
    let mut shown = window();
    shown.state().run(Command::TOGGLE_COMPARISON);
    shown.state().viewport.other_texture = Some(TextureId::User(1));
    shown.harness.run_steps(2);
    shown.compare("comparison", "A (left)");
}

#[test]
fn an_image_shifted_by_a_pixel_is_detected() {
    let bytes = picture([200, 100], 1).into_raw();
    let words: Vec<u32> = bytes
        .chunks_exact(4)
        .map(|pixel| u32::from_be_bytes([0, pixel[0], pixel[1], pixel[2]]))
        .collect();
    assert!(Comparison::of(&words, &bytes).is_close());
    let mut moved = words.clone();
    moved.rotate_right(1);
    assert!(!Comparison::of(&moved, &bytes).is_close());
    // One glyph is missing.
    let mut odd = words;
    for row in 0..8 {
        odd[200 * row..][..5].fill(0x00ff_ffff);
    }
    assert!(!Comparison::of(&odd, &bytes).is_close());
}
