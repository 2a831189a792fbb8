//! How fast a million coloured points come from a file, beside a plain read of the same file.
//!
//! Each format is a group over the same points; criterion's `thrpt` is bytes of the file a second in all rows:
//!
//! - `load`: [`pointreel::io::read`], the file's bytes from the system's cache included, on all cores and on one;
//! - `read file`: [`std::fs::read`] of the same file, which nobody can beat who needs all bytes.
//!
//! Targets: binary PLY at 60 % of the plain read, text at 100 MB/s a core. Not measured: a cold disk.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use pointreel::cloud::{Positions, RawCloud, ScalarField};
use pointreel::io::{self, WriteFormat};
use pointreel::memory::MiMalloc;
use std::fs::File;
use std::hint::black_box;
use std::time::Duration;

// As in the program.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

const POINTS: usize = 1_000_000;

/// A terrain with millimetres, as a survey has it, of which the text has about ten characters a number.
fn cloud(has_scalars: bool) -> RawCloud {
    let position = |index: usize| {
        let (x, y) = ((index % 1000) as f32, (index / 1000) as f32);
        let z = 20.0 * (x * 0.013).sin() * (y * 0.017).cos();
        [x, y, z].map(|value| (value * 1000.0).round() / 1000.0)
    };
    let color = |index: usize| [(index % 256) as u8, (index / 256 % 256) as u8, 77, 255];
    let mut cloud = RawCloud::from_positions(Positions::F32((0..POINTS).map(position).collect()));
    cloud.colors = Some((0..POINTS).map(color).collect());
    if has_scalars {
        let values = (0..POINTS).map(|index| (index % 4096) as f32).collect();
        cloud.scalars = vec![ScalarField::new("intensity", values)];
    }
    cloud
}

fn benches(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for files that are read");
    for format in [
        WriteFormat::PlyBinary,
        WriteFormat::PlyAscii,
        WriteFormat::Pcd,
        WriteFormat::Las,
        WriteFormat::Laz,
        WriteFormat::Xyz,
        WriteFormat::Npy,
    ] {
        let path = folder
            .path()
            .join(format!("{format}.{}", format.extension()));
        let has_scalars = matches!(format, WriteFormat::Las | WriteFormat::Laz);
        let file = File::create(&path).expect("the folder is writable");
        io::write(file, format, &cloud(has_scalars)).expect("the disk has room");
        let file_bytes = std::fs::metadata(&path).expect("it was just written").len();
        let mut group = criterion.benchmark_group(format!("load/{format}"));
        group.throughput(Throughput::Bytes(file_bytes));
        group.sample_size(10);
        group.measurement_time(Duration::from_secs(3));
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads to measure with");
            group.bench_function(format!("load, {threads} threads"), |bencher| {
                pool.install(|| {
                    bencher.iter(|| io::read(black_box(&path)).expect("it was just written"));
                });
            });
        }
        group.bench_function("read file", |bencher| {
            bencher.iter(|| std::fs::read(black_box(&path)).expect("it was just written"));
        });
        group.finish();
    }
}

criterion_group!(load, benches);
criterion_main!(load);
