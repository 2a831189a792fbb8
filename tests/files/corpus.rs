//! Files that other programs wrote, compared with the results of other readers. Prints the score.
//!
//! The files are next to the project, not in it.

#![allow(
    clippy::print_stdout,
    reason = "what was compared, and the score, is for who runs the test"
)]

use crate::data::shared;
use pointreel::cloud::RawCloud;
use pointreel::io;
use serde_json::Value;
use std::path::Path;

/// Formats that are read.
const READ: [&str; 11] = [
    "PLY", "PCD", "XYZ", "PTS", "PTX", "TXT", "LAS", "LAZ", "COPC", "E57", "DRC",
];

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn vector(value: &Value) -> Option<[f64; 3]> {
    let numbers = value.as_array()?;
    Some([
        numbers.first()?.as_f64()?,
        numbers.get(1)?.as_f64()?,
        numbers.get(2)?.as_f64()?,
    ])
}

/// Differences between a cloud and the expected values.
fn differences(cloud: &RawCloud, expected: &Value, points: &str, finite: &str) -> Vec<String> {
    let (finite_points, bounds) = cloud.positions.finite_bounds();
    let mut differences = Vec::new();
    let mut check_count = |what: &str, found: usize, expected: &Value| {
        if let Some(expected) = expected.as_u64().filter(|&expected| expected != found as u64) {
            differences.push(format!("{found} {what}, expected {expected}"));
        }
    };
    check_count("points", cloud.positions.len(), &expected[points]);
    check_count("finite points", finite_points, &expected[finite]);
    for (name, found) in [("min", bounds.map(|(min, _)| min)), ("max", bounds.map(|(_, max)| max))] {
        let Some(expected) = vector(&expected[name]) else {
            continue;
        };
        let Some(found) = found else {
            differences.push(format!("no {name}, expected {expected:?}"));
            continue;
        };
        let is_near = |(found, expected): (f64, f64)| (found - expected).abs() <= 1e-6 * (1.0 + expected.abs());
        if !found.to_array().into_iter().zip(expected).all(is_near) {
            differences.push(format!("{name} {found}, expected {expected:?}"));
        }
    }
    for (name, found) in [
        ("has_color", cloud.attributes.colors.is_some()),
        ("has_normals", cloud.attributes.normals.is_some()),
        (
            "has_intensity",
            cloud.attributes.scalars.iter().any(|field| field.name == "intensity"),
        ),
    ] {
        // Fields that the other readers do not recognise (upper-case fields, text columns) are not errors of ours.
        if expected[name] == true && !found {
            differences.push(format!("{name} is false, expected true"));
        }
    }
    differences
}

#[test]
fn the_corpus_reads_like_other_readers() {
    let Some(corpus) = shared("corpus") else {
        return;
    };
    let expected = json(&corpus.join("expected.json"));
    let mut wrong = Vec::new();
    let mut tried = 0;
    for entry in expected.as_array().unwrap() {
        let format = entry["format"].as_str().unwrap_or("");
        if !READ.contains(&format.split(' ').next().unwrap_or("")) {
            continue;
        }
        tried += 1;
        let file = entry["file"].as_str().unwrap();
        let differences = match (io::read(&corpus.join(file)), entry["expect"].as_str()) {
            (Ok(cloud), Some("ok")) => differences(&cloud, entry, "points", "finite_points"),
            (Ok(_), Some("error")) => vec!["read, expected an error".to_owned()],
            (Err(error), Some("ok")) => vec![error.to_string()],
            _ => Vec::new(),
        };
        if !differences.is_empty() {
            wrong.push(format!("{file} ({format}): {}", differences.join("; ")));
        }
    }
    println!("corpus: {} of {tried} files as expected", tried - wrong.len());
    assert!(tried > 100, "only {tried} files were tried");
    assert!(
        wrong.is_empty(),
        "{} of {tried} files differ:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn other_formats_are_rejected_with_a_reason() {
    let Some(picture) = shared("models/Fox/Texture.png") else {
        return;
    };
    let error = io::read(&picture).unwrap_err();
    assert!(
        error.to_string().contains("is an image: a single image has no depth"),
        "{error}"
    );
}

#[test]
fn the_sequences_read_like_other_readers() {
    let Some(folder) = shared("sequences") else {
        return;
    };
    let mut tried = 0;
    for (name, sequence) in json(&folder.join("expected.json")).as_object().unwrap() {
        for frame in sequence["per_frame"].as_array().unwrap() {
            let path = folder.join(name).join(frame["file"].as_str().unwrap());
            let cloud = io::read(&path).unwrap();
            let differences = differences(&cloud, frame, "points", "finite");
            assert!(differences.is_empty(), "{}: {}", path.display(), differences.join("; "));
            tried += 1;
        }
    }
    println!("sequences: {tried} frames as expected");
    assert!(tried > 30, "only {tried} frames were tried");
}
