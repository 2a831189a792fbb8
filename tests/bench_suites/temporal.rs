//! The suite of flicker.

use super::{assert_files_agree, input};
use pointreel::bench::{BenchOptions, Cell, Input, Report, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::{Sequence, Shape};

fn flicker_of(input: Input, modes: &str) -> Report {
    let options = BenchOptions {
        viewport_px: [160, 120],
        viewpoints: 1,
        frames: 1,
        modes: modes.parse().unwrap(),
        ..BenchOptions::new(suites::TEMPORAL)
    };
    run(&[input], &options, None, &|_| {}, &Progress::default()).unwrap()
}

#[test]
fn surfaces_at_rest_stand_still_whatever_else_moves() {
    let sphere = Input {
        shape: Some(Shape::Sphere),
        ..input("sphere", Sequence::of(Shape::Sphere.frame(5_000)))
    };
    let report = flicker_of(sphere, "cpu");
    assert_files_agree(&report);
    let number = |row, key: &str| report.value(row, key).and_then(Cell::number).unwrap();
    let rows = |scene: &str| {
        let rows: Vec<_> = report.rows.iter().filter(|row| report.cells(row)[1] == scene).collect();
        assert!(rows.len() >= 10, "{scene}");
        rows
    };
    // Points in the scene are as wide as the extent asks for: those do move.
    for row in rows("one point moves") {
        let (mode, flip) = (&report.cells(row)[2], number(row, "flip_over_time"));
        assert!(flip <= 0.002 || mode.starts_with("point"), "{mode}: {flip}");
    }
    // Other points of the same surface are seen to change, more so where they are fewer.
    let mean = |scene: &str| {
        let rows = rows(scene);
        rows.iter().map(|row| number(row, "flip_over_time")).sum::<f64>() / rows.len() as f64
    };
    let [again, fewer] = ["sampled again", "sampled again, a quarter of the points"].map(mean);
    assert!(again > 0.005 && fewer > again, "{again} {fewer}");
    for scene in ["shape moves", "camera turns"] {
        assert!(rows(scene).iter().all(|row| number(row, "steps") == 4.0));
    }
}

#[test]
fn files_have_the_scenes_that_need_no_formula() {
    let report = flicker_of(input("demo", Sequence::demo()), "cpu,voxel");
    let mut scenes: Vec<String> = report.rows.iter().map(|row| report.cells(row)[1].clone()).collect();
    scenes.dedup();
    assert_eq!(scenes, ["camera turns", "next frames, motion included"]);
}
