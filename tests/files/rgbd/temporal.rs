//! Frames are the same whatever was decoded before them, and with any number of threads.

use super::open_with;
use super::recording::{HEIGHT, WIDTH, gray};
use image::ImageFormat;
use pointreel::cloud::{Positions, RawCloud};
use pointreel::sequence::Sequence;
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::Path;

/// More frames than a group has, of a wall that trembles.
const FRAMES: usize = 40;

fn write(folder: &Path) {
    for frame in 0..FRAMES as u32 {
        let depth = |at: u32| 1500 + ((at * 7919 + frame * 5) % 13) as u16;
        let samples: Vec<u16> = (0..WIDTH * HEIGHT).map(depth).collect();
        fs::write(folder.join(format!("d{frame}.png")), gray(&samples, ImageFormat::Png)).unwrap();
    }
}

fn open(folder: &Path, filters: &str) -> Sequence {
    let options = RgbdOptions {
        filters: filters.parse().unwrap(),
        depth: Some("d*.png".to_owned()),
        intrinsics: Some("52.5,52.5,31.5,23.5".to_owned()),
        ..RgbdOptions::default()
    };
    open_with(folder, options).unwrap()
}

/// The bits of all coordinates.
fn bits(cloud: &RawCloud) -> Vec<[u32; 3]> {
    let Positions::F32(positions) = &cloud.positions else {
        panic!("single precision");
    };
    positions.iter().map(|at| at.map(f32::to_bits)).collect()
}

#[test]
fn random_access_matches_sequential_filtering() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    for filters in [
        "near,median,bilateral,flying",
        "temporal",
        "near,median,bilateral,flying,temporal",
    ] {
        let sequence = open(folder.path(), filters);
        let played: Vec<_> = (0..FRAMES)
            .map(|frame| bits(&sequence.decode(frame).unwrap()))
            .collect();
        for frame in [39, 0, 33, 32, 31, 5, 12] {
            let alone = bits(&open(folder.path(), filters).decode(frame).unwrap());
            assert!(alone == played[frame], "{filters}: frame {frame} alone differs");
            let again = bits(&sequence.decode(frame).unwrap());
            assert!(again == played[frame], "{filters}: frame {frame} differs after others");
        }
    }
}

#[test]
fn a_jittering_wall_is_stabilised() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let [raw, rests] = ["none", "temporal"].map(|filters| open(folder.path(), filters));
    let spread = |sequence: &Sequence| {
        let depths: Vec<f64> = (30..FRAMES)
            .map(|frame| sequence.decode(frame).unwrap().positions.get(1000).z)
            .collect();
        let mean = depths.iter().sum::<f64>() / depths.len() as f64;
        (depths.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / depths.len() as f64).sqrt()
    };
    let (before, after) = (spread(&raw), spread(&rests));
    assert!(after < 0.7 * before, "{before} became {after}");
}

#[test]
fn filters_are_the_same_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let sequence = open(folder.path(), "near,median,bilateral,flying");
    let by_threads = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bits(&sequence.decode(7).unwrap()))
    });
    assert!(by_threads[0] == by_threads[1]);
}
