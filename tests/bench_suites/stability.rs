//! The suite of cases that break numerics: each is what it must be, on both renderers and on the CPU alone.

use super::{assert_files_agree, common, demo, numbers, small};
use pointreel::bench::{BenchOptions, Cell, Report, Row, run, suites};
use pointreel::progress::Progress;

fn options() -> BenchOptions {
    BenchOptions {
        viewport_px: [80, 60],
        frames: 1,
        warmup: 0,
        repeat: 1,
        ..small(suites::STABILITY)
    }
}

fn text<'a>(report: &'a Report, row: &'a Row, key: &str) -> &'a str {
    match report.value(row, key) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}

/// Rows of the GPU and the CPU that differ by what is known: of an image this small, one point that is rounded to
/// another pixel is more than 40 dB; and sums of 3000 splats in one pixel exceed the half floats of the GPU's targets.
fn is_known(report: &Report, row: &Row) -> bool {
    let of = |key| text(report, row, key);
    of("result") == "red: CPU and GPU differ" && (of("primitive") == "point" || of("case") == "all points equal")
}

/// Every row that is not as it must be.
fn red(report: &Report) -> Vec<String> {
    let is_red = |row: &&Row| !text(report, row, "result").starts_with("ok") && !is_known(report, row);
    let rows = report.rows.iter().filter(is_red);
    rows.map(|row| format!("{}: {}", report.cells(row).join(" | "), text(report, row, "message")))
        .collect()
}

#[test]
fn no_case_is_red_on_either_renderer() {
    let report = run(
        &demo(),
        &options(),
        Some(&common::context()),
        &|_| {},
        &Progress::default(),
    )
    .unwrap();
    assert_files_agree(&report);
    assert!(red(&report).is_empty(), "{:#?}", red(&report));
    let of = |case: &str, key: &str| -> Vec<String> {
        let rows = report.rows.iter().filter(|row| text(&report, row, "case") == case);
        rows.map(|row| text(&report, row, key).to_owned()).collect()
    };
    assert_eq!(of("× 1e30", "result"), ["ok: refused"]);
    assert!(of("× 1e-30", "message")[0].contains("1e-12 to 1e12"));
    assert_eq!(of("one point", "renderer"), ["cpu", "gpu"].repeat(5));
    // The demo as it is, too.
    assert!(
        report
            .rows
            .iter()
            .any(|row| text(&report, row, "case").starts_with("demo"))
    );
}

#[test]
fn the_cpu_renderer_is_judged_alone() {
    let report = run(&demo(), &options(), None, &|_| {}, &Progress::default()).unwrap();
    assert!(red(&report).is_empty(), "{:#?}", red(&report));
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
        assert!(report.value(row, "draw_ms_median").and_then(Cell::number) > Some(0.0));
    }
    assert!(numbers(&report, "points").len() == report.rows.len());
}
