//! The window of a benchmark.

use super::menu::choose_item;
use super::{click, options, sequence, window, window_on};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Benchmark, BenchmarkJob, BenchmarkTable, Command, State};
use pointreel::bench::{LabPoint, Quality, RatePoint, Sweep, Table};
use pointreel::bench::{Measured, Step};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::measure::ReferenceCloud;
use pointreel::reel::{Precision, ReelOptions};
use pointreel::scene::{Background, PointStyle, Primitive, RendererChoice, Settings, Strategy};
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

/// A table of a report from its heading and two rows.
fn table(name: &str, lines: [[&str; 2]; 3]) -> Table {
    let [columns, first, second] = lines.map(|line| line.map(str::to_owned).to_vec());
    Table {
        name: name.to_owned(),
        columns,
        rows: vec![first, second],
    }
}

/// Starts `job` in the benchmark window.
fn start(harness: &mut Harness<'_, State>, job: BenchmarkJob) {
    harness.state_mut().start_benchmark_job("surfels", job);
    harness.run();
}

/// Updates until the benchmark is no longer running.
fn finish(harness: &mut Harness<'_, State>) {
    let begin = Instant::now();
    while matches!(harness.state().features.benchmark, Benchmark::Running(_)) {
        assert!(begin.elapsed() < Duration::from_secs(20), "the benchmark does not end");
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

#[test]
fn a_benchmark_shows_progress_then_its_table() {
    let mut harness = window();
    let (go_on, gate) = sync_channel::<()>(0);
    let (reached, half_way) = sync_channel::<()>(0);
    let job: BenchmarkJob = Box::new(move |report, _| {
        report(Step {
            done: 3,
            total: 6,
            label: "storage".to_owned(),
            measured: None,
        });
        reached.send(()).unwrap();
        gate.recv().unwrap();
        Ok(BenchmarkTable {
            suite: "surfels".to_owned(),
            adapter: "Test adapter".to_owned(),
            tables: vec![
                table("", [["strategy", "median"], ["storage", "1.25"], ["texture", "2.50"]]),
                table("leaves", [["δ", "loss"], ["2 %", "1.75"], ["10 %", "8.25"]]),
            ],
            bars_title: "median ms".to_owned(),
            bars: vec![("storage".to_owned(), 1.25), ("texture".to_owned(), 2.5)],
            ..BenchmarkTable::default()
        })
    });
    start(&mut harness, job);
    half_way.recv().unwrap();
    harness.run();
    assert!(harness.query_by_label("storage").is_some());
    assert!(harness.query_by_label_contains("3 of 6").is_some());
    go_on.send(()).unwrap();
    finish(&mut harness);
    for label in [
        "Surfels × strategies",
        "Test adapter",
        "strategy",
        "median",
        "texture",
        "2.50",
        "leaves",
        "8.25",
        "Export JSON…",
        "Export CSV…",
    ] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
}

#[test]
fn a_benchmark_is_cancelled_or_fails_with_its_reason() {
    let mut harness = window();
    let patient: BenchmarkJob = Box::new(|_, progress| {
        while !progress.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err("cancelled".to_owned())
    });
    start(&mut harness, patient);
    click(&mut harness, "Cancel");
    finish(&mut harness);
    assert!(matches!(harness.state().features.benchmark, Benchmark::Cancelled(_)));
    assert!(harness.query_by_label("The benchmark was cancelled.").is_some());

    start(
        &mut harness,
        Box::new(|_, _| Err("the GPU is out of memory".to_owned())),
    );
    finish(&mut harness);
    assert!(harness.query_by_label("the GPU is out of memory").is_some());
}

#[test]
fn a_benchmark_starts_with_the_chosen_renderer_and_size() {
    let mut harness = window_on(sequence(&[]), options());
    click(&mut harness, "Benchmark");
    choose_item(&mut harness, "Octree");
    assert!(harness.query_by_label("Start").is_some(), "nothing runs before that");
    assert!(matches!(harness.state().features.benchmark, Benchmark::Idle));
    for label in ["Width", "Height", "Frames", "Viewpoints", "Rounds"] {
        assert!(
            harness.query_by_role_and_label(Role::SpinButton, label).is_some(),
            "{label}"
        );
    }
    let setup = harness.state_mut().features.benchmark_setup.as_mut().unwrap();
    (setup.renderer, setup.viewport_px) = (RendererChoice::Cpu.into(), [320, 240]);
    (setup.frames, setup.viewpoints, setup.repeat) = (1, 1, 1);
    // Another suite has its own defaults, the same one keeps its choices.
    let chosen = *setup;
    for (suite, is_kept) in [("octree", true), ("error", false)] {
        harness.state_mut().give(Command::SET_UP_BENCHMARK, suite).unwrap();
        let now = harness.state().features.benchmark_setup.unwrap();
        assert_eq!(now == chosen, is_kept, "{suite}");
    }
    harness.state_mut().features.benchmark_setup = Some(chosen);
    harness.run();
    click(&mut harness, "Start");
    let begin = Instant::now();
    while matches!(harness.state().features.benchmark, Benchmark::Running(_)) {
        assert!(begin.elapsed() < Duration::from_mins(2), "the benchmark does not end");
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(2));
    }
    let Benchmark::Done(table) = &harness.state().features.benchmark else {
        panic!("{:?}", harness.state().features.benchmark);
    };
    assert_eq!(table.suite, "octree");
    assert!(
        table.json.contains("320") && table.json.contains("240"),
        "{}",
        table.json
    );
    harness.run();
    assert!(harness.query_by_label("Start").is_none(), "the dialog has closed");
}

/// A render mode with this time and error.
fn point(draw_ms: f64, flip: f64, style: Settings) -> Arc<LabPoint> {
    Arc::new(LabPoint {
        sequence: "demo".to_owned(),
        style,
        label: format!("way of {draw_ms} ms"),
        draw_ms,
        flip,
        flip_over_time: 0.5 * flip,
        on_fronts: [false; 2],
        picture: image::RgbaImage::new(24, 16),
        error_map: image::RgbaImage::new(24, 16),
    })
}

/// Points of 2 px, voxels at half the resolution, surfels, and points that voxels beat.
fn points() -> Vec<Arc<LabPoint>> {
    let cpu = Settings::default().with(|style| style.drawing.renderer = RendererChoice::Cpu.into());
    let points_2_px = Settings {
        primitive: Primitive::Point.into(),
        points: PointStyle {
            size_px: 2.0,
            ..PointStyle::default()
        },
        ..cpu
    };
    let voxels = cpu.with(|style| {
        style.primitive = Primitive::Voxel.into();
        style.drawing.resolution = 0.5;
    });
    let beaten = Settings {
        primitive: Primitive::Point.into(),
        ..cpu
    };
    vec![
        point(1.0, 0.5, points_2_px),
        point(8.0, 0.2, voxels),
        point(30.0, 0.05, cpu),
        point(9.0, 0.4, beaten),
    ]
}

#[test]
fn variants_appear_while_measured_and_a_click_applies_one() {
    let mut harness = window();
    harness.state_mut().style.backdrop.background = Background::solid([1, 2, 3]);
    let (go_on, gate) = sync_channel::<()>(0);
    let (reached, half_way) = sync_channel::<()>(0);
    let job: BenchmarkJob = Box::new(move |report, _| {
        for measured in &points()[..2] {
            report(Step {
                measured: Some(Measured::Way(Arc::clone(measured))),
                ..Step::default()
            });
        }
        reached.send(()).unwrap();
        gate.recv().unwrap();
        Ok(BenchmarkTable {
            suite: "error".to_owned(),
            points: points(),
            html: "<!DOCTYPE html>".to_owned(),
            ..BenchmarkTable::default()
        })
    });
    start(&mut harness, job);
    half_way.recv().unwrap();
    harness.run();
    click(&mut harness, "8.00 ms, FLIP 0.2000: way of 8 ms");
    let style = harness.state().style;
    assert_eq!(
        (style.primitive, style.drawing.resolution),
        (Primitive::Voxel.into(), 0.5)
    );
    assert_eq!(
        style.backdrop.background,
        Background::solid([1, 2, 3]),
        "the background is the person's"
    );
    go_on.send(()).unwrap();
    finish(&mut harness);
    assert!(harness.query_by_label("Export page…").is_some());
    assert!(harness.query_by_label("30.00 ms, FLIP 0.0500: way of 30 ms").is_some());
    assert!(
        harness.query_by_label_contains("way of 9 ms").is_none(),
        "voxels are faster and better"
    );
}

#[test]
fn the_window_does_not_move_and_retains_measured_results() {
    let mut harness = window();
    let (go_on, gate) = sync_channel::<()>(0);
    let (reached, next) = sync_channel::<()>(0);
    let job: BenchmarkJob = Box::new(move |report, progress| {
        for (done, measured) in (1..).zip(points()) {
            report(Step {
                done,
                total: 4,
                label: "a way with a name that is a good deal longer than the window is wide, in all its settings"
                    .repeat(3),
                measured: Some(Measured::Way(measured)),
            });
            reached.send(()).unwrap();
            gate.recv().unwrap();
        }
        while !progress.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err("cancelled".to_owned())
    });
    start(&mut harness, job);
    let mut places = Vec::new();
    for _ in 0..4 {
        next.recv().unwrap();
        harness.run();
        let cancel = harness.get_by_label("Cancel").rect();
        places.push((harness.state().appearance.benchmark_place.unwrap(), cancel));
        go_on.send(()).unwrap();
    }
    assert!(places.iter().all(|place| *place == places[0]), "{places:?}");
    let place = places[0].0;
    let picture = harness.state().viewport.rect;
    assert!(picture.contains_rect(place), "{place:?} in {picture:?}");
    assert!(place.right() <= picture.center().x + 10.0, "the other half is seen");
    click(&mut harness, "Cancel");
    finish(&mut harness);
    assert!(matches!(harness.state().features.benchmark, Benchmark::Cancelled(_)));
    assert!(
        harness.query_by_label("8.00 ms, FLIP 0.2000: way of 8 ms").is_some(),
        "it stays"
    );

    // A small window squeezes it, and it is restored when the window is large again.
    harness.set_size(egui::vec2(500.0, 320.0));
    harness.run();
    let squeezed = harness.state().appearance.benchmark_place.unwrap();
    assert!(harness.ctx.content_rect().contains_rect(squeezed), "{squeezed:?}");
    harness.set_size(egui::vec2(1280.0, 800.0));
    harness.run();
    assert_eq!(harness.state().appearance.benchmark_place, Some(place));
    // The next one starts there.
    let preferences = harness.state().preferences();
    let mut next = window_on(
        super::sequence(&[]),
        pointreel::app::StateOptions {
            preferences,
            ..super::options()
        },
    );
    next.state_mut()
        .run(pointreel::app::Command::panel(pointreel::app::PanelId::BENCHMARK));
    next.run();
    let again = next.state().appearance.benchmark_place.unwrap();
    assert!((again.min - place.min).length() < 1.0 && (again.max - place.max).length() < 1.0);
}

#[test]
fn measured_variants_apply_only_to_their_sequence() {
    let mut harness = window();
    let before = harness.state().style;
    let mut measured = before;
    for way in &points()[..2] {
        harness.state_mut().draw_as_measured(&way.style);
        measured = harness.state().style;
        assert_eq!(measured.drawing.renderer, RendererChoice::Cpu);
    }
    // A manual change belongs to the user.
    harness.state_mut().style.light.eye_dome_strength = 0.25;
    assert_ne!(measured.drawing.resolution, before.drawing.resolution);
    let retained = harness.state().preferences().settings;
    assert_eq!(retained.drawing, before.drawing, "the next window begins as before");
    harness.state_mut().open(super::sequence(&[]));
    let style = harness.state().style;
    assert_eq!(style.drawing, before.drawing);
    assert_eq!(style.light, before.light, "the look is that of the other document");
}

#[test]
fn the_fastest_strategy_is_offered() {
    let mut harness = window();
    start(
        &mut harness,
        Box::new(|_, _| {
            Ok(BenchmarkTable {
                suite: "surfels".to_owned(),
                fastest: Some((Strategy::Uniform, 159.0)),
                ..BenchmarkTable::default()
            })
        }),
    );
    finish(&mut harness);
    click(&mut harness, "Use the fastest: Uniform buffers");
    assert_eq!(harness.state().style.drawing.strategy, Strategy::Uniform);
}

#[test]
fn a_slider_goes_from_fast_to_exact() {
    let mut harness = window();
    assert!(harness.query_by_label("Measure…").is_some());
    let points: Vec<LabPoint> = points().iter().map(|point| (**point).clone()).collect();
    harness.state_mut().features.quality.known = Quality::of(&points);
    harness.run();
    assert!(harness.query_by_label("Custom settings").is_some());
    // The slider's arrow keys, as used without a mouse.
    let slider = harness.get_by_role_and_label(egui::accesskit::Role::Slider, "Fast to exact");
    slider.focus();
    harness.run();
    harness.key_press(egui::Key::ArrowLeft);
    harness.run();
    assert_eq!(harness.state().style.primitive, Primitive::Voxel);
    assert!(harness.query_by_label_contains("8.0 ms, FLIP 0.200").is_some());
}

/// Eight corners and one point near to one of them.
fn corners() -> RawCloud {
    let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
    let near = std::iter::once([0.01, 0.0, 0.0]);
    RawCloud::from_positions(Positions::F32(corners.chain(near).collect()))
}

/// A variant with this many bits of the corners' positions.
fn rate(bits: u8) -> Arc<RatePoint> {
    let mut moved = corners();
    let Positions::F32(positions) = &mut moved.positions else {
        panic!("of single precision");
    };
    positions[8][0] += 0.1 / f32::from(bits);
    Arc::new(RatePoint {
        sequence: "walk".to_owned(),
        sweep: Sweep::Positions,
        label: format!("{bits} bits"),
        options: ReelOptions {
            precision: Precision::Bits(bits),
            ..ReelOptions::default()
        },
        bits_per_point: f64::from(bits) * 1.5,
        error: ReferenceCloud::new(&corners()).unwrap().compare(&moved).unwrap(),
        flip: 0.5 / f64::from(bits),
        picture: image::RgbaImage::new(24, 16),
        error_map: image::RgbaImage::new(24, 16),
    })
}

#[test]
fn rates_appear_while_measured_and_a_click_compares_with_the_original() {
    let entries = (0..super::FRAMES).map(|_| pointreel::sequence::FrameEntry::file("/scans/walk/corners.ply"));
    let sequence = pointreel::sequence::Sequence::with_decoder(entries.collect(), |_| Ok(corners()));
    let mut harness = window_on(Arc::new(sequence), super::options());
    let (go_on, gate) = sync_channel::<()>(0);
    let (reached, half_way) = sync_channel::<()>(0);
    let job: BenchmarkJob = Box::new(move |report, _| {
        report(Step {
            measured: Some(Measured::Rate(rate(2))),
            ..Step::default()
        });
        reached.send(()).unwrap();
        gate.recv().unwrap();
        Ok(BenchmarkTable {
            suite: "rate".to_owned(),
            rates: vec![rate(2), rate(8)],
            ..BenchmarkTable::default()
        })
    });
    start(&mut harness, job);
    half_way.recv().unwrap();
    harness.run();
    let label = |harness: &Harness<'_, State>, ending: &str| {
        let node = harness.query_by_label_contains(ending)?;
        egui_kittest::kittest::NodeT::accesskit_node(&node).label()
    };
    let first = label(&harness, "FLIP 0.2500: 2 bits").expect("the point that was measured");
    assert!(first.starts_with("3.00 bits, D1 "), "{first}");
    assert!(harness.query_by_label_contains(": 8 bits").is_none());
    click(&mut harness, &first);
    let begin = Instant::now();
    while harness
        .state()
        .features
        .split_view
        .as_ref()
        .is_none_or(|split_view| split_view.companion.shown().is_none())
    {
        assert!(begin.elapsed() < Duration::from_secs(20), "no frame beside");
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(2));
    }
    let split_view = harness.state().features.split_view.as_ref().unwrap();
    assert!(split_view.name.ends_with(", 2 bits"), "{}", split_view.name);
    assert_eq!(
        split_view.companion.shown().unwrap().frame.len(),
        8,
        "two points share a cell"
    );
    go_on.send(()).unwrap();
    finish(&mut harness);
    for loss in ["D1", "D2", "Colours", "FLIP"] {
        harness
            .get_by_role_and_label(egui::accesskit::Role::Button, loss)
            .click();
        harness.run();
    }
    assert!(harness.query_by_label_contains(": 8 bits").is_some());
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
}
