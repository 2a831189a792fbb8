//! The suite of time beside error, and its page.

use super::{assert_files_agree, demo, input, small};
use pointreel::bench::{BenchOptions, Cell, Input, LabPoint, Report, Step, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::{Sequence, Shape};
use std::cell::RefCell;
use std::path::Path;
use std::sync::LazyLock;

/// Two runs, of which the second finds the truths that the first has kept.
static RUNS: LazyLock<[Report; 2]> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let truths = folder.path().join("truths");
    [(); 2].map(|()| {
        let report = errors_on_a_sphere(&truths);
        // Image, depth and tolerance of two views.
        assert_eq!(std::fs::read_dir(&truths).unwrap().count(), 6);
        report
    })
});

/// Ways of the processor on a sphere of few points, whose truth is known.
fn errors_on_a_sphere(truth_folder: &Path) -> Report {
    let sphere = Input {
        shape: Some(Shape::Sphere),
        ..input("sphere", Sequence::of(Shape::Sphere.frame(3_000)))
    };
    let options = BenchOptions {
        viewport_px: [160, 120],
        viewpoints: 2,
        frames: 1,
        warmup: 0,
        repeat: 1,
        modes: "cpu".parse().unwrap(),
        truth_folder: Some(truth_folder.to_owned()),
        ..BenchOptions::new(suites::ERROR)
    };
    let measured = RefCell::new(Vec::new());
    let watch = |step: Step| measured.borrow_mut().extend(step.measured);
    let report = run(&[sphere], &options, None, &watch, &Progress::default()).unwrap();
    let said: Vec<String> = measured
        .into_inner()
        .iter()
        .map(|point| point.label().to_owned())
        .collect();
    let labels: Vec<String> = report.points.iter().map(|point| point.label.clone()).collect();
    assert_eq!(said, labels, "each is shown once it is measured");
    report
}

#[test]
fn errors_of_render_modes_are_in_the_order_predicted_by_theory() {
    let [report, again] = &*RUNS;
    assert_files_agree(report);
    let error = |report: &Report, label: &str, key: &str| {
        let row = report.rows.iter().find(|row| report.cells(row)[1] == label);
        let row = row.unwrap_or_else(|| panic!("{label} is missing"));
        report.value(row, key).and_then(Cell::number).unwrap()
    };
    let flip = |label: &str| error(report, label, "flip_object_mean");
    assert_eq!(
        flip("surfel two-pass CPU"),
        error(again, "surfel two-pass CPU", "flip_object_mean")
    );
    // Without depth the rear shines through; in one pass squares intersect each other; fewer pixels show less.
    assert!(flip("surfel two-pass CPU") < flip("surfel regular CPU"));
    assert!(flip("surfel two-pass CPU") < flip("surfel no-depth CPU"));
    // Cells that close the surface approximate it better than dots, and lighting the surface in them better than
    // lighting cubes.
    assert!(flip("voxel by spacing τ 1 CPU") < flip("voxel by spacing lit by faces τ 1 CPU"));
    assert!(flip("voxel by spacing τ 1 CPU") < flip("voxel δ 5 % τ 1 CPU"));
    assert!(flip("surfel two-pass CPU") < flip("surfel two-pass at 50 % CPU"));
    let holes = |label: &str| error(report, label, "hole_share");
    assert!(holes("point 1 px CPU") > holes("point 2 px CPU") && holes("point 2 px CPU") > holes("point 3 px CPU"));
    // Points as wide in the scene as they are apart close it: their size is decided by the scene, on white as well.
    for row in &report.rows {
        let label = report.cells(row)[1].to_string();
        if label.starts_with("point projected") {
            assert!(holes(&label) < 0.02, "{label}: {}", holes(&label));
        }
    }
    assert!(
        holes("surfel two-pass-enlarged CPU") < 0.001,
        "{}",
        holes("surfel two-pass-enlarged CPU")
    );
    // The rear is visible through the gaps between small points.
    let wrong = |label: &str| error(report, label, "wrong_surface_share");
    assert!(wrong("point 1 px CPU") > 0.02 && wrong("surfel two-pass CPU") < 0.001);

    // The front: nothing beats it, and everything else is beaten.
    let beats = |a: &LabPoint, b: &LabPoint| {
        a.draw_ms <= b.draw_ms && a.flip <= b.flip && (a.draw_ms < b.draw_ms || a.flip < b.flip)
    };
    for point in &report.points {
        let is_beaten = report.points.iter().any(|other| beats(other, point));
        assert_eq!(point.is_on_front, !is_beaten, "{}", point.label);
    }
}

#[test]
fn the_page_contains_every_point_and_makes_no_requests() {
    let [report, _] = &*RUNS;
    let page = report.to_html();
    let (_, data) = page
        .split_once("<script type=\"application/json\" id=\"data\">")
        .unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let points = data["points"].as_array().unwrap();
    assert_eq!(points.len(), report.points.len());
    for (found, point) in points.iter().zip(&report.points) {
        assert_eq!(found["label"], point.label);
        // serde_json reads the last digit of some numbers incorrectly.
        let error = found["ms"].as_f64().unwrap() - point.draw_ms;
        assert!(error.abs() <= 1e-14 * point.draw_ms);
        for picture in ["picture", "error"] {
            assert!(
                found[picture]
                    .as_str()
                    .unwrap()
                    .starts_with("data:image/png;base64,iVBOR")
            );
        }
    }
    for outside in ["http://", "https://", "src=\"", "@import", "url("] {
        let addresses = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!addresses.contains(outside), "{outside}");
    }
}

#[test]
fn a_selection_without_variants_is_an_error() {
    let options = BenchOptions {
        modes: "gpu".parse().unwrap(),
        ..small(suites::ERROR)
    };
    let error = run(&demo(), &options, None, &|_| {}, &Progress::default()).unwrap_err();
    assert!(error.to_string().contains("requested render modes"), "{error}");
}
