//! Usual filters report the pixels they drop, and never drop most of an image.

use super::open_with;
use super::recording::{HEIGHT, WIDTH, gray};
use image::ImageFormat;
use pointreel::rgbd::Filters;
use pointreel::sequence::Sequence;
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::Path;

/// A wall at 2 m with `far` of ten rows at 12 m; no file states the units, which are given.
fn open(folder: &Path, far: u32, is_automatic: bool) -> Sequence {
    fs::create_dir_all(folder.join("depth")).unwrap();
    for frame in 0..3 {
        let depth = |at: u32| {
            if at / WIDTH * 10 < far * HEIGHT {
                12_000
            } else {
                2000 + frame
            }
        };
        let samples: Vec<u16> = (0..WIDTH * HEIGHT).map(depth).collect();
        fs::write(
            folder.join(format!("depth/{frame}.png")),
            gray(&samples, ImageFormat::Png),
        )
        .unwrap();
    }
    let options = RgbdOptions {
        filters: Filters::USUAL,
        filters_are_automatic: is_automatic,
        depth_scale: Some(1000.0),
        ..RgbdOptions::default()
    };
    open_with(folder, options).unwrap()
}

fn said(sequence: &Sequence) -> String {
    let cloud = sequence.decode(1).unwrap();
    let assumptions = sequence.assumptions();
    let lines = assumptions.iter().map(ToString::to_string).chain(cloud.warnings);
    lines
        .filter(|line| line.contains("filter"))
        .collect::<Vec<_>>()
        .join("\n")
}

fn count(sequence: &Sequence) -> usize {
    sequence.decode(1).unwrap().positions.finite_bounds().0
}

#[test]
fn a_default_filter_that_drops_little_is_a_convention() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = open(folder.path(), 1, true);
    assert!(count(&sequence) < (WIDTH * HEIGHT) as usize);
    let said = said(&sequence);
    assert!(
        said.lines().count() == 1 && said.contains("are applied") && said.contains("; convention"),
        "{said}"
    );
}

#[test]
fn a_default_filter_that_drops_a_fifth_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = open(folder.path(), 4, true);
    assert!(count(&sequence) < (WIDTH * HEIGHT) as usize * 2 / 3);
    let said = said(&sequence);
    assert!(
        said.contains("`near` drops 4") && said.contains("change with --rgbd-filters"),
        "{said}"
    );
}

#[test]
fn a_default_filter_that_would_drop_most_is_not_applied() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = open(folder.path(), 8, true);
    // All except the eight corners of its two rectangles, which the flying-pixel filter drops.
    assert_eq!(count(&sequence), (WIDTH * HEIGHT) as usize - 8);
    assert_eq!(
        sequence.source().filters().unwrap().near,
        None,
        "the window shows what is applied"
    );
    let said = said(&sequence);
    assert!(said.contains("`near` is not applied"), "{said}");
}

#[test]
fn filters_chosen_by_the_user_are_applied() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = open(folder.path(), 8, false);
    assert!(count(&sequence) < (WIDTH * HEIGHT) as usize / 3);
    assert_eq!(said(&sequence), "");
}
