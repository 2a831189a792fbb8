//! Time to decode files to clouds, compared with moving the same bytes.
//!
//! Each format is a group of three rows over the same 100,000 points, and criterion's `thrpt` is bytes of the file a
//! second in all of them, so that they divide into each other:
//!
//! - `decode`: [`pointreel::io::read_bytes`] on bytes in memory: the time added to reading;
//! - `copy`: the same bytes into a fresh allocation: no decoder can beat this;
//! - `read file`: [`std::fs::read`] of the same bytes from the system's cache: a player waits for it in any case.
//!
//! Not measured: a cold disk, memory that the process touches for the first time (the loops reuse theirs), the check
//! into a `Frame`, normals and radii (`benches/normals.rs`, `benches/prepare.rs`). All on one thread. Target: the
//! binary PLY in well under 5 ms; the other two rows show the distance from the floor.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use pointreel::io;
use pointreel::memory::Allocator;
use std::f32::consts::TAU;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

// As in the program.
#[global_allocator]
static ALLOCATOR: Allocator = Allocator::new();

const POINTS: usize = 100_000;

struct Point {
    position: [f32; 3],
    normal: [f32; 3],
    color: [u8; 3],
}

/// A dented sphere: coordinates with all their digits, as a scanner has them.
fn points() -> impl Iterator<Item = Point> {
    (0..POINTS).map(|i| {
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / POINTS as f32;
        // The golden angle spreads points evenly over a sphere.
        let angle = (i as f64 * 0.618_033_988_749_895).fract() as f32 * TAU;
        let ring = (1.0 - z * z).sqrt();
        let normal = [ring * angle.cos(), ring * angle.sin(), z];
        let distance = 1.0 + 0.05 * (6.0 * angle).sin() * ring;
        Point {
            position: normal.map(|component| component * distance),
            normal,
            color: normal.map(|component| (127.0 * (component + 1.0)) as u8),
        }
    })
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {POINTS}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    )
}

fn ply_binary(big_endian: bool) -> Vec<u8> {
    let mut file = ply_header(if big_endian {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    })
    .into_bytes();
    for point in points() {
        for component in point.position.into_iter().chain(point.normal) {
            file.extend(if big_endian {
                component.to_be_bytes()
            } else {
                component.to_le_bytes()
            });
        }
        file.extend(point.color);
    }
    file
}

fn ply_ascii() -> Vec<u8> {
    let mut file = ply_header("ascii");
    for Point {
        position: [x, y, z],
        normal: [nx, ny, nz],
        color: [r, g, b],
    } in points()
    {
        writeln!(file, "{x} {y} {z} {nx} {ny} {nz} {r} {g} {b}").expect("text grows");
    }
    file.into_bytes()
}

fn xyz() -> Vec<u8> {
    let mut file = String::new();
    for Point {
        position: [x, y, z],
        color: [r, g, b],
        ..
    } in points()
    {
        writeln!(file, "{x:.6} {y:.6} {z:.6} {r} {g} {b}").expect("text grows");
    }
    file.into_bytes()
}

fn pcd_header(data: &str) -> Vec<u8> {
    format!(
        "VERSION .7\nFIELDS x y z rgb normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4\nTYPE F F F U F F F\n\
         COUNT 1 1 1 1 1 1 1\nWIDTH {POINTS}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {POINTS}\nDATA {data}\n"
    )
    .into_bytes()
}

/// The seven fields of a point, four bytes each.
fn pcd_fields(point: &Point) -> [[u8; 4]; 7] {
    let [x, y, z] = point.position.map(f32::to_le_bytes);
    let [nx, ny, nz] = point.normal.map(f32::to_le_bytes);
    let [red, green, blue] = point.color;
    [x, y, z, [blue, green, red, 0], nx, ny, nz]
}

fn pcd_binary() -> Vec<u8> {
    let mut file = pcd_header("binary");
    for point in points() {
        file.extend(pcd_fields(&point).concat());
    }
    file
}

/// Rounded, as a depth camera's numbers are: digits without end do not compress at all.
fn pcd_compressed() -> Vec<u8> {
    let rounded = |vector: [f32; 3]| vector.map(|component| (component * 256.0).round() / 256.0);
    let mut columns: [Vec<u8>; 7] = Default::default();
    for point in points() {
        let point = Point {
            position: rounded(point.position),
            normal: rounded(point.normal),
            ..point
        };
        for (column, field) in columns.iter_mut().zip(pcd_fields(&point)) {
            column.extend(field);
        }
    }
    let block = columns.concat();
    let mut packed = vec![0; lzf_rust::max_compressed_size(block.len())];
    let count = lzf_rust::compress(&block, &mut packed).expect("there is room for it");
    packed.truncate(count);
    let mut file = pcd_header("binary_compressed");
    file.extend((packed.len() as u32).to_le_bytes());
    file.extend((block.len() as u32).to_le_bytes());
    file.extend(packed);
    file
}

fn bench(criterion: &mut Criterion) {
    pointreel::memory::keep_freed_pages();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = [
        ("binary.ply", ply_binary(false)),
        ("big_endian.ply", ply_binary(true)),
        ("ascii.ply", ply_ascii()),
        ("binary.pcd", pcd_binary()),
        ("compressed.pcd", pcd_compressed()),
        ("text.xyz", xyz()),
    ];
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).expect("the temporary folder takes files");
        let decoded = io::read(&path).expect("a good file");
        assert_eq!(decoded.positions.len(), POINTS, "{name}");
        assert!(decoded.attributes.colors.is_some(), "{name}");

        let mut group = criterion.benchmark_group(format!("decode 100k/{name}"));
        group
            .sample_size(20)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(2))
            .throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function("decode", |bencher| {
            bencher.iter(|| io::read_bytes(Path::new(name), &bytes).expect("a good file"));
        });
        group.bench_function("copy", |bencher| {
            bencher.iter(|| black_box(bytes.as_slice()).to_vec());
        });
        group.bench_function("read file", |bencher| {
            bencher.iter(|| std::fs::read(&path).expect("the file was written"));
        });
        group.finish();
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
