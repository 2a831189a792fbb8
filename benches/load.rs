//! Time to read a million coloured points from a file, compared with a plain read of the same file.
//!
//! - *threads*: [`pointreel::io::read`], the file's bytes from the system's cache included;
//! - *read*: [`std::fs::read`] of the same file, which no reader of all bytes can beat.
//!
//! The three take turns, so that a machine that slows down meanwhile slows all; medians. Not criterion, which measures
//! one after the other: on a shared machine ratios over minutes are unreliable.
//! `cargo bench --bench load -- ply` measures one format.
//!
//! Targets: binary PLY at 60 % of the plain read, text at 100 MB/s per core. Not measured: a cold disk.

use pointreel::cloud::{Positions, RawCloud, ScalarField};
use pointreel::io::{self, WriteFormat};
use pointreel::memory::Allocator;
use std::fs::File;
use std::hint::black_box;
use std::time::{Duration, Instant};

#[path = "shapes/turns.rs"]
mod turns;

use turns::{median, time_ms};

// As in the program.
#[global_allocator]
static ALLOCATOR: Allocator = Allocator::new();

const POINTS: usize = 1_000_000;

/// A terrain with millimetres, as a survey has it, of which the text has about ten characters per number.
fn cloud(has_scalars: bool) -> RawCloud {
    let position = |index: usize| {
        let (x, y) = ((index % 1000) as f32, (index / 1000) as f32);
        let z = 20.0 * (x * 0.013).sin() * (y * 0.017).cos();
        [x, y, z].map(|value| (value * 1000.0).round() / 1000.0)
    };
    let color = |index: usize| [(index % 256) as u8, (index / 256 % 256) as u8, 77, 255];
    let mut cloud = RawCloud::from_positions(Positions::F32((0..POINTS).map(position).collect()));
    cloud.attributes.colors = Some((0..POINTS).map(color).collect());
    if has_scalars {
        let values = (0..POINTS).map(|index| (index % 4096) as f32).collect();
        cloud.attributes.scalars = vec![ScalarField::new("intensity", values)];
    }
    cloud
}

/// Measuring time per format.
const MEASURED: Duration = Duration::from_secs(4);

#[expect(clippy::print_stdout, reason = "the table is what this program is for")]
fn main() {
    // `cargo bench` passes arguments of its own.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let folder = tempfile::tempdir().expect("a folder for files that are read");
    let pools = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("threads to measure with")
    });
    println!(
        "format         MB    read ms   1 thread ms (of the read, MB/s)   2 threads ms (of the read, MB/s)   rounds"
    );
    for format in WriteFormat::all() {
        let name = format.to_string();
        if !wanted.is_empty() && !wanted.contains(&name) {
            continue;
        }
        let path = folder.path().join(format!("{name}.{}", format.extension()));
        let has_scalars = ["las", "laz"].contains(&name.as_str());
        let file = File::create(&path).expect("the folder is writable");
        io::write(file, format, &cloud(has_scalars)).expect("the disk has room");
        let megabytes = std::fs::metadata(&path).expect("it was just written").len() as f64 / 1e6;
        let mut times_ms = [const { Vec::new() }; 3];
        let begin = Instant::now();
        while begin.elapsed() < MEASURED {
            times_ms[0].push(time_ms(|| {
                std::fs::read(black_box(&path)).expect("it was just written")
            }));
            for (pool, times_ms) in pools.iter().zip(&mut times_ms[1..]) {
                let load = || io::read(black_box(&path)).expect("it was just written");
                times_ms.push(pool.install(|| time_ms(load)));
            }
        }
        let rounds = times_ms[0].len();
        let [read_ms, one_ms, two_ms] = times_ms.map(median);
        let column = |ms: f64| {
            format!(
                "{ms:8.2} ({:5.1} %, {:6.0})",
                100.0 * read_ms / ms,
                1e3 * megabytes / ms
            )
        };
        println!(
            "{name:12} {megabytes:5.1} {read_ms:9.2} {:>36} {:>36} {rounds:8}",
            column(one_ms),
            column(two_ms)
        );
    }
}
