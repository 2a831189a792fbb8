//! Behaviour common to all suites: progress, cancelling, broken frames, nothing to do.

use super::{common, demo, input, small};
use pointreel::bench::{BenchError, BenchOptions, Input, Step, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::{FrameEntry, Sequence};
use std::cell::RefCell;

#[test]
fn progress_reaches_its_total() {
    let steps = RefCell::new(Vec::new());
    let watch = |step: Step| steps.borrow_mut().push(step);
    let never = Progress::default();
    run(
        &demo(),
        &small(suites::OCTREE),
        Some(&common::context()),
        &watch,
        &never,
    )
    .unwrap();
    let steps = steps.into_inner();
    // Preparing, placing and three losses for each of two frames.
    assert_eq!(
        steps.iter().map(|step| step.done).collect::<Vec<_>>(),
        (0..10).collect::<Vec<_>>()
    );
    assert!(steps.iter().all(|step| step.total == 10));
    assert_eq!(steps[9].label, "demo frame 13 of 24: δ 50 %");
}

#[test]
fn a_cancelled_run_stops_at_the_next_step() {
    // A window measures itself, and is cancelled by closing it.
    for suite in suites::all().filter(|&suite| suite != suites::WINDOW) {
        let progress = Progress::default();
        let seen = RefCell::new(0);
        let watch = |step: Step| {
            *seen.borrow_mut() += 1;
            if step.done == 2 {
                progress.cancel();
            }
        };
        let result = run(&demo(), &small(suite), Some(&common::context()), &watch, &progress);
        assert!(matches!(result, Err(BenchError::Cancelled)), "{suite}: {result:?}");
        assert_eq!(seen.into_inner(), 3, "{suite}");
    }
}

#[test]
fn broken_frames_are_skipped_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 0\n";
    std::fs::write(folder.path().join("scan_0.xyz"), "not a cloud\n").unwrap();
    std::fs::write(folder.path().join("scan_1.xyz"), cloud).unwrap();
    let open = || Sequence::discover(&[folder.path().to_owned()]).unwrap();
    let never = Progress::default();
    let inputs = [input("scans", open())];
    let report = run(
        &inputs,
        &small(suites::OCTREE),
        Some(&common::context()),
        &|_| {},
        &never,
    )
    .unwrap();
    assert_eq!(report.sequences[0].measured_frames, 1);
    let skipped: Vec<&String> = report.notes.iter().filter(|note| note.contains("skipped")).collect();
    assert!(
        skipped.len() == 1 && skipped[0].contains("scan_0.xyz"),
        "{:?}",
        report.notes
    );

    std::fs::write(folder.path().join("scan_1.xyz"), "also not\n").unwrap();
    let inputs = [input("scans", open())];
    let error = run(
        &inputs,
        &small(suites::SURFELS),
        Some(&common::context()),
        &|_| {},
        &never,
    )
    .unwrap_err();
    assert!(
        error.to_string().contains("scan_0.xyz"),
        "the first failure is named: {error}"
    );
}

#[test]
fn nothing_to_measure_is_an_error() {
    let never = Progress::default();
    let measure = |inputs: &[Input], options: &BenchOptions| {
        run(inputs, options, Some(&common::context()), &|_| {}, &never)
            .unwrap_err()
            .to_string()
    };
    let options = small(suites::SURFELS);
    assert_eq!(
        measure(&[], &options),
        "there is nothing to measure: no sequence was named"
    );
    let empty = Sequence::with_decoder(Vec::<FrameEntry>::new(), |_| Err("never called".into()));
    let inputs = [input("empty", empty)];
    assert_eq!(
        measure(&inputs, &options),
        "there is nothing to measure: empty has no frames"
    );
    let no_viewpoints = BenchOptions {
        viewpoints: 0,
        ..options
    };
    assert_eq!(
        measure(&demo(), &no_viewpoints),
        "the number of viewpoints must be at least 1"
    );
}
