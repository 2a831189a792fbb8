//! The suite of time and error, and its page.

use super::{assert_files_agree, demo, input, small};
use pointreel::bench::{BenchOptions, Cell, Input, LabError, LabPoint, Report, Step, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::{Sequence, Shape};
use std::cell::RefCell;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::LazyLock;

/// Two runs: the second finds the ground truths that the first stored.
static RUNS: LazyLock<[Report; 2]> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let truths = folder.path().join("truths");
    [(); 2].map(|()| {
        let report = errors_on_a_sphere(&truths);
        // Image, depth and tolerance of two views, each in two lights and with the camera turned as well.
        assert_eq!(std::fs::read_dir(&truths).unwrap().count(), 24);
        report
    })
});

/// Render modes of the CPU on a sphere of few points, whose ground truth is known.
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

/// A number of the mode with this label.
fn error(report: &Report, label: &str, key: &str) -> f64 {
    let row = report.rows.iter().find(|row| report.cells(row)[1] == label);
    let row = row.unwrap_or_else(|| panic!("{label} is missing"));
    report.value(row, key).and_then(Cell::number).unwrap()
}

#[test]
fn errors_of_render_modes_are_in_the_order_predicted_by_theory() {
    let [report, again] = &*RUNS;
    assert_files_agree(report);
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
    // Points as wide in the scene as they are apart close it: their size is decided by the scene, on white as well.
    for row in &report.rows {
        let label = &report.cells(row)[1];
        if label.starts_with("point projected") {
            assert!(holes(label) < 0.02, "{label}: {}", holes(label));
        }
    }
    let holes_of_points = [1, 2, 3].map(|size_px| holes(&format!("point {size_px} px lit by normals CPU")));
    assert!(holes_of_points[0] > holes_of_points[1] && holes_of_points[1] > holes_of_points[2]);
    assert!(
        holes("surfel two-pass-enlarged CPU") < 0.001,
        "{}",
        holes("surfel two-pass-enlarged CPU")
    );
    // The rear is visible through the gaps between small points.
    let wrong = |label: &str| error(report, label, "wrong_surface_share");
    assert!(wrong("point 1 px lit by normals CPU") > 0.02 && wrong("surfel two-pass CPU") < 0.001);

    // Points and disks are as far from the truth in one light as in another that the truth has as well; points without
    // light would be farther from it than in light.
    let physical = report
        .points
        .iter()
        .find(|point| point.label.contains("physical light"));
    let physical = physical.unwrap();
    assert!(
        physical.flip < 1.5 * flip("surfel two-pass CPU"),
        "{}: {}",
        physical.label,
        physical.flip
    );
    for row in &report.rows {
        assert_eq!(report.value(row, "truth"), Some(&Cell::Text("formula".to_owned())));
    }

    // Single pixels crawl when the camera turns, and blended disks do not.
    let over_time = |label: &str| error(report, label, "flip_over_time");
    let [dots, disks] = ["point 1 px lit by normals CPU", "surfel two-pass CPU"].map(over_time);
    assert!(disks > 0.0 && dots > 2.0 * disks, "{dots} and {disks}");

    // The fronts: nothing beats them, and everything else is beaten.
    for error in LabError::ALL {
        let beats = |a: &LabPoint, b: &LabPoint| {
            let [a_error, b_error] = [a, b].map(|point| error.of(point));
            let is_no_worse = a.draw_ms <= b.draw_ms && a_error <= b_error;
            a.lighting() == b.lighting() && is_no_worse && (a.draw_ms < b.draw_ms || a_error < b_error)
        };
        for point in &report.points {
            let is_beaten = report.points.iter().any(|other| beats(other, point));
            assert_eq!(point.is_on_front(error), !is_beaten, "{}", point.label);
        }
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
        assert_eq!(found["truth"], "formula");
        // serde_json reads the last digit of some numbers wrong.
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

/// A sphere of quads as a PLY file, with colours by position.
fn write_sphere(path: &Path, rows: u32) {
    let columns = 2 * rows;
    let mut vertices = String::new();
    let mut faces = String::new();
    for row in 0..=rows {
        for column in 0..columns {
            let polar = f64::from(row) / f64::from(rows) * std::f64::consts::PI;
            let azimuth = f64::from(column) / f64::from(columns) * std::f64::consts::TAU;
            let place = [polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin()];
            let [red, green, blue] = place.map(|axis| (127.5 + 120.0 * (6.0 * axis).sin()) as u8);
            let [x, y, z] = place;
            writeln!(vertices, "{x} {y} {z} {red} {green} {blue}").unwrap();
            if row < rows {
                let at = |row: u32, column: u32| row * columns + column % columns;
                let quad = [
                    at(row, column),
                    at(row, column + 1),
                    at(row + 1, column + 1),
                    at(row + 1, column),
                ];
                writeln!(faces, "4 {} {} {} {}", quad[0], quad[1], quad[2], quad[3]).unwrap();
            }
        }
    }
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        (rows + 1) * columns,
        rows * columns
    );
    std::fs::write(path, header + &vertices + &faces).unwrap();
}

/// Modes of an input from one viewpoint.
fn report_of(input: Input, modes: &str, subsample: Option<&str>) -> Report {
    let options = BenchOptions {
        viewport_px: [160, 120],
        viewpoints: 1,
        frames: 1,
        warmup: 0,
        repeat: 1,
        modes: modes.parse().unwrap(),
        subsample: subsample.map(|share| share.parse().unwrap()),
        ..BenchOptions::new(suites::ERROR)
    };
    run(&[input], &options, None, &|_| {}, &Progress::default()).unwrap()
}

/// The kind of truth of all rows.
fn truth_of(report: &Report) -> &str {
    let kind = |row| match report.value(row, "truth") {
        Some(Cell::Text(kind)) => kind.as_str(),
        other => panic!("{other:?}"),
    };
    let first = kind(&report.rows[0]);
    assert!(report.rows.iter().all(|row| kind(row) == first));
    assert!(report.to_table().contains(first) && report.to_csv().contains(first) && report.to_json().contains(first));
    first
}

#[test]
fn the_triangles_of_a_file_are_the_truth_of_its_points() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sphere.ply");
    write_sphere(&path, 40);
    let meshed = || input("sphere", Sequence::discover(std::slice::from_ref(&path)).unwrap());
    let report = report_of(meshed(), "cpu,mesh,two-pass-enlarged", None);
    assert_eq!(truth_of(&report), "mesh");
    let flip = |label: &str| error(&report, label, "flip_object_mean");
    // Drawn as the truth is, triangles differ from it by the samples of a pixel alone.
    assert!(flip("mesh 2 px with Supersampling CPU") < flip("mesh 2 px CPU"));
    assert!(flip("mesh 2 px CPU") < 0.8 * flip("surfel two-pass-enlarged CPU"));
    assert!(error(&report, "mesh 2 px CPU", "psnr_db") > 25.0);
    assert!(error(&report, "mesh 2 px CPU", "wrong_surface_share") < 0.005);
    // A part of the points has the same truth, and is farther from it.
    let part = report_of(meshed(), "cpu,two-pass-enlarged", Some("20%"));
    assert_eq!(truth_of(&part), "mesh");
    let label = "surfel two-pass-enlarged CPU";
    assert!(error(&part, label, "flip_object_mean") > flip(label));
    assert!(
        part.notes.iter().any(|note| note.contains("of 3280 points are drawn")),
        "{:?}",
        part.notes
    );
}

#[test]
fn a_part_of_the_points_is_held_against_all_of_them() {
    let sphere = || input("sphere", Sequence::of(Shape::Sphere.frame(4_000)));
    let [whole, part] = [None, Some("25%")].map(|share| report_of(sphere(), "cpu,regular,opaque", share));
    assert_eq!((truth_of(&whole), truth_of(&part)), ("own disks", "dense twin"));
    assert_eq!(
        (whole.sequences[0].mean_points, part.sequences[0].mean_points),
        (4000.0, 1000.0)
    );
    let flip = |report: &Report| error(report, "surfel opaque CPU", "flip_object_mean");
    assert!(flip(&part) > 1.2 * flip(&whole), "{} and {}", flip(&part), flip(&whole));
    // A formula is a better truth than points.
    let shape = Input {
        shape: Some(Shape::Sphere),
        ..sphere()
    };
    assert_eq!(truth_of(&report_of(shape, "cpu,opaque", Some("25%"))), "formula");
}
