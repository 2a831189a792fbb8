//! Files of strangers, through `info`, `check`, `render`, `convert` and the window: files of every format are changed,
//! and their checksums made right again. A panic, more than ten seconds or more memory than was allowed is a finding.
//!
//! `make test` tries earlier findings (`tests/data/hostile`) and a few new cases; `make fuzz` runs for a given time
//! (`rounds`).

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod cases;
mod child;
mod drive;
mod kinds;
mod machine;
mod mutate;
mod nested;
mod random;
mod repair;
mod rounds;
mod runner;
mod seeds;

use cases::retained_in;
use child::{ORDER, Order};
use repair::{Repair, repair_all};
use std::path::Path;

/// New cases of each set in `make test`: the same every time, or luck would decide whether a commit passes.
const FRESH_OF_SET: u64 = 4;
const FRESH_RUN: u64 = 1;

fn corpus() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hostile")
}

/// The work of a child; see `runner.rs`.
#[test]
#[ignore = "the other tests of this program start it"]
fn child() {
    if let Ok(order) = std::env::var(ORDER) {
        child::work(Order::of_json(&order));
    }
}

/// The work of `make fuzz`; see `rounds.rs`.
#[test]
#[ignore = "goes on for as long as it is told"]
fn rounds() {
    rounds::run();
}

fn assert_nothing_is_found(order: &Order, min_executions: u64) {
    let outcome = runner::carry_out(order);
    let told: Vec<String> = outcome.findings.iter().map(|finding| format!("{finding:?}")).collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
    let executions: u64 = outcome.executions.values().sum();
    assert!(executions >= min_executions, "{:?}", outcome.executions);
}

#[test]
fn earlier_findings_are_rejected_or_shown() {
    let scratch = tempfile::tempdir().unwrap();
    let count = retained_in(&corpus()).len() as u64;
    assert!(count > 0, "the corpus is not there");
    let order = Order {
        folder: corpus(),
        sets: Vec::new(),
        run: 0,
        numbers: 0..count,
        scratch: scratch.path().to_owned(),
    };
    assert_nothing_is_found(&order, count);
}

/// Without it the other tests would pass with a watch that sees nothing.
#[test]
fn faults_are_found_and_remaining_cases_still_tried() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("kept");
    std::fs::create_dir_all(folder.join(kinds::FAULTS)).unwrap();
    let names = ["aborts", "fills", "is_fine", "panics"];
    for name in names {
        std::fs::write(folder.join(kinds::FAULTS).join(name), "").unwrap();
    }
    let order = Order {
        folder,
        sets: Vec::new(),
        run: 0,
        numbers: 0..names.len() as u64,
        scratch: scratch.path().to_owned(),
    };
    let outcome = runner::carry_out(&order);
    let found = outcome.findings.iter().map(|finding| {
        let kind = finding.reason.split([':', ' ']).next().unwrap();
        (names[finding.number as usize], kind)
    });
    let mut expected = vec![("aborts", "died"), ("panics", "panic")];
    if machine::peak_bytes().is_some() {
        expected.insert(1, ("fills", "memory"));
    }
    assert_eq!(found.collect::<Vec<_>>(), expected, "{:?}", outcome.findings);
}

#[test]
fn new_mutations_of_every_set_are_rejected_or_shown() {
    let scratch = tempfile::tempdir().unwrap();
    let seeds = scratch.path().join("seeds");
    seeds::gather(&seeds, &[]);
    let sets: Vec<String> = kinds::sets().into_iter().map(str::to_owned).collect();
    let retained = retained_in(&seeds);
    for set in &sets {
        assert!(retained.iter().any(|seed| seed.set == *set), "no seed of {set}");
    }
    let count = FRESH_OF_SET * sets.len() as u64;
    let order = Order {
        folder: seeds,
        sets,
        run: FRESH_RUN,
        numbers: 0..count,
        scratch: scratch.path().to_owned(),
    };
    assert_nothing_is_found(&order, count);
}

/// A repair that does not know its format makes every case one of a wrong checksum.
#[test]
fn checksum_repairs_fix_only_what_is_wrong() {
    let scratch = tempfile::tempdir().unwrap();
    seeds::gather(scratch.path(), &[]);
    let mut tried = std::collections::BTreeSet::new();
    for seed in retained_in(scratch.path()) {
        let (name, bytes) = &seed.files[0];
        let kind = kinds::kind_of(&seed.set, name);
        let mut repaired = bytes.clone();
        repair_all(kind.repair, &mut repaired);
        // Checksums of packed chunks are removed.
        let is_packed = kind.repair == Repair::Mcap && !name.starts_with("none");
        assert!(repaired == *bytes || is_packed, "{name} was right before");
        // If all checksums are wrong, all are found.
        let mut spoilt = bytes.clone();
        if kind.repair == Repair::Reel {
            for place in reel_checksums(bytes) {
                spoilt[place] ^= 0x55;
            }
            repair_all(kind.repair, &mut spoilt);
            assert!(spoilt == *bytes, "{name}: a checksum is not found");
        }
        tried.insert(format!("{:?}", kind.repair));
    }
    assert!(tried.len() > 5, "{tried:?}");
}

/// Offsets of checksums in headers of chunks.
fn reel_checksums(bytes: &[u8]) -> Vec<usize> {
    let windows = bytes.windows(4).enumerate();
    let starts = windows.filter_map(|(place, window)| (window == b"\xf1rlc").then_some(place));
    starts.flat_map(|start| [start + 20, start + 24]).collect()
}
