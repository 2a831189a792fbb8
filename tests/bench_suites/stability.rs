//! The suite of cases that break numerics.

use super::{assert_files_agree, demo, small};
use pointreel::bench::{BenchOptions, Cell, Report, Row, run, suites};
use pointreel::progress::Progress;

fn text<'a>(report: &'a Report, row: &'a Row, key: &str) -> &'a str {
    match report.value(row, key) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}

/// On the CPU alone: an adapter draws the same cases for minutes.
#[test]
fn every_case_is_drawn_as_it_must_be() {
    let options = BenchOptions {
        viewport_px: [80, 60],
        frames: 1,
        warmup: 0,
        repeat: 1,
        ..small(suites::STABILITY)
    };
    let report = run(&demo(), &options, None, &|_| {}, &Progress::default()).unwrap();
    assert_files_agree(&report);
    let is_red = |row: &&Row| !text(&report, row, "result").starts_with("ok");
    let red: Vec<String> = report
        .rows
        .iter()
        .filter(is_red)
        .map(|row| report.cells(row).join(" | "))
        .collect();
    assert!(red.is_empty(), "{red:#?}");
    let of = |case: &str| -> Vec<&Row> {
        let rows = report.rows.iter().filter(|row| text(&report, row, "case") == case);
        rows.collect()
    };
    assert_eq!(text(&report, of("× 1e30")[0], "result"), "ok: refused");
    assert!(text(&report, of("× 1e-30")[0], "message").contains("1e-12 to 1e12"));
    let drawn: Vec<&Row> = report
        .rows
        .iter()
        .filter(|row| !text(&report, row, "renderer").is_empty())
        .collect();
    assert!(drawn.len() > 60, "{}", drawn.len());
    for row in drawn {
        assert_eq!(text(&report, row, "renderer"), "cpu");
        assert_eq!(
            report.value(row, "between_db"),
            Some(&Cell::Missing),
            "there is nothing to compare with"
        );
    }
}
