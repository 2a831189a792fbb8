//! Sequence files: bits per point by stream, and times of encoding and decoding.
//!
//! Measured, in memory: a bumpy torus at 10 bits, geometry alone (lossless voxels); the same surface sampled so densely
//! that most cells are occupied; the torus with normals and colours at the sampling density, and lossless; and, where
//! the folder is there, the walking man of `../shared/data/sequences`. Encoding begins with clouds as they were decoded
//! and ends with bytes; decoding begins with bytes and ends with a cloud. Not measured: reading and writing of disks,
//! validation of frames. Both codings are measured. Next to them are the figures of G-PCC's reference coder tmc13 for
//! the first.
//!
//! `cargo bench --bench reel [THREADS]`

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench prints, and fails by panicking"
)]

mod shapes;

use glam::Vec3;
use pointreel::cloud::{Positions, RawCloud};
use pointreel::progress::Progress;
use pointreel::reel::{Coding, NewFrame, Precision, ReelDecoder, ReelFile, ReelOptions, ReelWriter, StreamKind};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Frames of a cloud that is measured alone are decoded so often; the fastest counts.
const ROUNDS: usize = 5;

fn torus(count: usize) -> RawCloud {
    let (positions, _) = shapes::bumpy_torus(count);
    RawCloud::from_positions(Positions::F32(positions.iter().map(Vec3::to_array).collect()))
}

/// With normals, and colours in soft waves.
fn painted_torus(count: usize) -> RawCloud {
    let (positions, _) = shapes::bumpy_torus(count);
    let color = |position: &Vec3| {
        let waves = (*position * Vec3::new(7.0, 6.0, 5.0)).to_array().map(f32::sin);
        let pattern = waves[0] * waves[1] + waves[1] * waves[2] + waves[2] * waves[0];
        let channel = |phase: f32| (140.0 + 90.0 * (1.5 * pattern + phase).sin()) as u8;
        [channel(0.0), channel(2.1), channel(4.2), 255]
    };
    let mut cloud = torus(count);
    cloud.attributes.colors = Some(positions.iter().map(color).collect());
    cloud.attributes.normals = Some(shapes::bumpy_torus_normals(count).iter().map(Vec3::to_array).collect());
    cloud
}

/// Whole coordinates below 2ᵇ.
fn voxelised(mut cloud: RawCloud, bits: u32) -> RawCloud {
    if let Positions::F32(positions) = &mut cloud.positions {
        let points = || positions.iter().map(|point| Vec3::from_array(*point));
        let min = points().fold(Vec3::INFINITY, Vec3::min);
        let edge = (points().fold(Vec3::NEG_INFINITY, Vec3::max) - min).max_element();
        let cells = (1u32 << bits) as f32;
        for point in positions {
            let cell = ((Vec3::from_array(*point) - min) * (cells / edge)).floor();
            *point = cell.min(Vec3::splat(cells - 1.0)).to_array();
        }
    }
    cloud
}

/// The compact coding, and the fast one.
fn measure(title: &str, clouds: &[RawCloud], options: &ReelOptions) {
    for (coding, word) in [(Coding::Compact, "compact"), (Coding::Fast, "fast")] {
        let options = ReelOptions {
            coding,
            ..options.clone()
        };
        measure_coding(&format!("{title}, {word}"), clouds, &options);
    }
}

fn measure_coding(title: &str, clouds: &[RawCloud], options: &ReelOptions) {
    let names: Vec<String> = (0..clouds.len()).map(|index| index.to_string()).collect();
    let frames: Vec<NewFrame<'_>> = clouds
        .iter()
        .zip(&names)
        .map(|(cloud, name)| NewFrame {
            cloud,
            name,
            time: None,
        })
        .collect();
    let mut encoding = Duration::MAX;
    let mut bytes = Vec::new();
    for _ in 0..2 {
        let begin = Instant::now();
        let mut writer = ReelWriter::new(Vec::new(), Path::new("bench.reel"), options.clone()).unwrap();
        for group in frames.chunks(options.keyframes as usize) {
            writer.write_group(group).unwrap();
        }
        bytes = writer.finish().unwrap();
        encoding = encoding.min(begin.elapsed());
    }
    let size = bytes.len();
    let file = Arc::new(ReelFile::open(Arc::new(bytes), Path::new("bench.reel")).unwrap());
    let mut decoder = ReelDecoder::new(Arc::clone(&file), u64::MAX);
    let mut decoding = Duration::MAX;
    let mut decoded = 0;
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        decoded = (0..clouds.len())
            .map(|index| decoder.decode(index, usize::MAX, &Progress::default()).unwrap())
            .map(|frame| frame.cloud.positions.len())
            .sum();
        decoding = decoding.min(begin.elapsed());
    }
    let points: usize = clouds.iter().map(|cloud| cloud.positions.len()).sum();
    let per = |bytes: u64, points: usize| bytes as f64 * 8.0 / points as f64;
    let mut streams = [0; StreamKind::ALL.len()];
    for index in 0..clouds.len() {
        let of_frame = file.frame(index).unwrap().bytes_by_stream;
        streams.iter_mut().zip(of_frame).for_each(|(sum, bytes)| *sum += bytes);
    }
    let by_stream: Vec<String> = StreamKind::ALL
        .iter()
        .zip(streams)
        .filter(|(_, bytes)| *bytes > 0)
        .map(|(kind, bytes)| format!("{} {:.2}", kind.name(), per(bytes, decoded)))
        .collect();
    println!(
        "{title}: {points} points, {decoded} decoded; {:.2} bits a point of the cloud, {:.2} a decoded one ({}); \
         encoded in {:.1} ms ({:.2} M/s), decoded in {:.1} ms ({:.2} M/s)",
        per(size as u64, points),
        per(size as u64, decoded),
        by_stream.join(", "),
        encoding.as_secs_f64() * 1e3,
        points as f64 / encoding.as_secs_f64() / 1e6,
        decoding.as_secs_f64() * 1e3,
        decoded as f64 / decoding.as_secs_f64() / 1e6,
    );
}

/// The frames of a folder; none where it is not there.
fn sequence(folder: &str) -> Vec<RawCloud> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        println!("{folder} is not there: passed over");
        return Vec::new();
    };
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| pointreel::io::read(path).unwrap();
    paths.iter().map(read).collect()
}

fn main() {
    let threads = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(1);
    println!("{threads} threads");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let voxels = ReelOptions {
            precision: Precision::Bits(10),
            ..ReelOptions::default()
        };
        measure("bumpy torus, 10 bits", &[voxelised(torus(1_000_000), 10)], &voxels);
        println!("  tmc13, octree: 4.03 bits a voxel, 590 ms and 450 ms (of 813k voxels)");
        measure("dense torus, 10 bits", &[voxelised(torus(5_000_000), 10)], &voxels);
        println!("  tmc13, octree: 1.53 bits a voxel (of 2.19 M voxels)");
        let painted = [painted_torus(1_000_000)];
        measure("torus with normals and colours", &painted, &ReelOptions::default());
        measure("the same, merged", &painted, &ReelOptions::merged());
        measure("the same, lossless", &painted, &ReelOptions::lossless());
        let man = sequence("../shared/data/sequences/cesiumman_24fps");
        if !man.is_empty() {
            measure("walking man", &man, &ReelOptions::default());
            measure("walking man, merged", &man, &ReelOptions::merged());
            measure("walking man, lossless", &man, &ReelOptions::lossless());
        }
    });
}
