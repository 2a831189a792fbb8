//! The window of a benchmark.

use super::{click, window};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Benchmark, BenchmarkJob, BenchmarkTable, Progress, State};
use pointreel::bench::Table;
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
    while matches!(harness.state().benchmark, Benchmark::Running(_)) {
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "the benchmark does not end"
        );
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
        report(Progress {
            done: 3,
            total: 6,
            label: "storage".to_owned(),
        });
        reached.send(()).unwrap();
        gate.recv().unwrap();
        Ok(BenchmarkTable {
            suite: "surfels".to_owned(),
            adapter: "Test adapter".to_owned(),
            tables: vec![
                table(
                    "",
                    [
                        ["strategy", "median"],
                        ["storage", "1.25"],
                        ["texture", "2.50"],
                    ],
                ),
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
        "Suite surfels",
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
    let patient: BenchmarkJob = Box::new(|_, cancel| {
        while !cancel.load(std::sync::atomic::Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err("cancelled".to_owned())
    });
    start(&mut harness, patient);
    click(&mut harness, "Cancel");
    finish(&mut harness);
    assert!(matches!(harness.state().benchmark, Benchmark::Cancelled));
    assert!(
        harness
            .query_by_label("The benchmark was cancelled.")
            .is_some()
    );

    start(
        &mut harness,
        Box::new(|_, _| Err("the GPU is out of memory".to_owned())),
    );
    finish(&mut harness);
    assert!(harness.query_by_label("the GPU is out of memory").is_some());
}
