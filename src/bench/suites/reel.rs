//! Sequence files: bits a point, time and distortion.
//!
//! How it works: some frames that follow each other are written to memory as a sequence file ([`crate::reel`]) and read
//! back, with one choice of options after the other. Bits are those of all bytes, the directory included. Times are
//! those of one thread, so that they hold for any number of them. The distortion is that of the first frame, point to
//! point, as MPEG measures it.

use crate::bench::report::{Cell, Column, Row};
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::bench::{BenchError, Quantiles};
use crate::cloud::RawCloud;
use crate::math::Aabb;
use crate::measure::GeometryError;
use crate::progress::Progress;
use crate::reel::{Coding, NewFrame, Precision, ReelDecoder, ReelError, ReelFile, ReelOptions, ReelWriter, StreamKind};
use glam::Vec3;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Columns, in the order in which [`ReelSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("options", "options"),
    Column::number("frames", "frames", 0),
    Column::number("points", "points kept", 0),
    Column::number("bits_per_point", "bits a point", 3),
    Column::number("geometry_bits", "geometry", 3),
    Column::number("position_bits", "position", 3),
    Column::number("color_bits", "colour", 3),
    Column::number("normal_bits", "normal", 3),
    Column::number("offset_bits", "offset", 3),
    Column::number("alpha_bits", "alpha", 3).hidden(),
    Column::number("radius_bits", "radius", 3),
    Column::number("scalar_bits", "scalar", 3),
    Column::number("ellipse_bits", "ellipse", 3).hidden(),
    Column::number("order_bits", "order", 3),
    Column::number("encode_ms", "encode ms", 2),
    Column::number("decode_ms", "decode ms", 2),
    Column::number("encode_mpoints_per_s", "M points/s in", 2),
    Column::number("decode_mpoints_per_s", "M points/s out", 2),
    Column::number("d1_psnr", "D1 dB", 2),
    Column::number("bytes", "bytes", 0).hidden(),
];

/// Sequence files of consecutive frames.
pub const REEL: &Suite = &Suite {
    name: "reel",
    brief: "sequence files",
    title: "Sequence files",
    hint: "Bits a point, times and errors of sequence files with several options",
    description: "bits a point of sequence files by stream, times to encode and decode, distortion",
    measured: "encoding and decoding frames that follow each other, on one thread, in memory; a frame's share of the \
        time of its group; PSNR of the first frame, point to point, both ways, with 3 p²",
    not_measured: "reading the frames, disks, drawing",
    covered_by: "points",
    defaults: Defaults {
        viewport_px: [1280, 720],
        viewpoints: 1,
        frames: 8,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "bits_per_point",
    bars_title: "Bits a point",
    bar_labels: 2,
};

/// The ways to keep a sequence that are compared.
fn ways() -> Vec<(&'static str, ReelOptions)> {
    let voxels = |bits| ReelOptions {
        precision: Precision::Bits(bits),
        ..ReelOptions::default()
    };
    let fast = |options: ReelOptions| ReelOptions {
        coding: Coding::Fast,
        ..options
    };
    vec![
        ("sampling density", ReelOptions::default()),
        ("sampling density, fast", fast(ReelOptions::default())),
        (
            "sampling density, each frame by itself",
            ReelOptions {
                keyframes: 1,
                ..ReelOptions::default()
            },
        ),
        ("10 bits", voxels(10)),
        ("10 bits, fast", fast(voxels(10))),
        ("lossless", ReelOptions::lossless()),
    ]
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let ways = ways();
    for subject in run.subjects(ways.len())? {
        let frames = consecutive(&subject)?;
        let mut rows = Vec::new();
        for (words, options) in &ways {
            run.begin_step(format!("{}: {words}", subject.name))?;
            let (repeats, progress) = (run.options.repeat, run.progress);
            let samples = one_thread(|| ReelSamples::of(&frames, options, repeats, progress))??;
            rows.push(samples.row(subject.name, words));
        }
        let points: Vec<f64> = frames.iter().map(|frame| frame.cloud.positions.len() as f64).collect();
        run.finish(&subject, &points, &[], rows);
    }
    Ok(())
}

/// A frame that was decoded, and its name.
struct Decoded {
    cloud: RawCloud,
    name: String,
}

/// As many frames as were chosen, but one behind the other: what follows is foretold by what came before.
fn consecutive(subject: &Subject<'_>) -> Result<Vec<Decoded>, BenchError> {
    let frames = subject.sequence.frames().take(subject.chosen.len());
    let decoded = frames.filter_map(|index| {
        let cloud = subject.sequence.decode(index).ok()?;
        let name = subject.sequence.entry(index).name.clone();
        Some(Decoded { cloud, name })
    });
    let frames: Vec<Decoded> = decoded.filter(|frame| !frame.cloud.positions.is_empty()).collect();
    if frames.is_empty() {
        return Err(BenchError::Nothing(format!(
            "{} has no frame with points",
            subject.name
        )));
    }
    Ok(frames)
}

fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, BenchError> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work))
}

/// What was measured of one way to keep frames.
struct ReelSamples {
    frames: usize,
    points: usize,
    bytes: usize,
    bytes_by_stream: [u64; StreamKind::ALL.len()],
    encode_ms: Vec<f64>,
    decode_ms: Vec<f64>,
    d1_psnr_db: Option<f64>,
}

impl ReelSamples {
    /// Writes `frames` and reads them back `repeats` times.
    fn of(frames: &[Decoded], options: &ReelOptions, repeats: usize, progress: &Progress) -> Result<Self, BenchError> {
        let (mut encode_ms, mut decode_ms) = (Vec::new(), Vec::new());
        let mut bytes = Vec::new();
        let mut first = None;
        for _ in 0..repeats {
            BenchError::check_cancelled(progress)?;
            let start = Instant::now();
            bytes = written(frames, options)?;
            let per_frame = milliseconds(start) / frames.len() as f64;
            let file = opened(&bytes)?;
            let mut decoder = ReelDecoder::new(Arc::new(file), u64::MAX);
            let start = Instant::now();
            for index in 0..frames.len() {
                let decoded = decoder.decode(index, usize::MAX, &Progress::default())?;
                first.get_or_insert(decoded.cloud);
            }
            encode_ms.push(per_frame);
            decode_ms.push(milliseconds(start) / frames.len() as f64);
        }
        let file = opened(&bytes)?;
        let infos = || (0..file.frame_count()).filter_map(|index| file.frame(index));
        let mut bytes_by_stream = [0; StreamKind::ALL.len()];
        for info in infos() {
            for (sum, bytes) in bytes_by_stream.iter_mut().zip(info.bytes_by_stream) {
                *sum += bytes;
            }
        }
        Ok(Self {
            frames: frames.len(),
            points: infos().map(|info| info.points).sum(),
            bytes: bytes.len(),
            bytes_by_stream,
            encode_ms,
            decode_ms,
            d1_psnr_db: first.and_then(|first| d1_psnr_db(&frames[0].cloud, &first)),
        })
    }

    fn row(&self, sequence: &str, words: &str) -> Row {
        let bits = |bytes: u64| 8.0 * bytes as f64 / self.points.max(1) as f64;
        let points_per_frame = self.points as f64 / self.frames as f64;
        let times = [&self.encode_ms, &self.decode_ms].map(|times| Quantiles::of(times).map(|times| times.median));
        let rate = |ms: f64| points_per_frame / (1e3 * ms);
        let mut cells = vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(words.to_owned()),
            Cell::Number(self.frames as f64),
            Cell::Number(points_per_frame),
            Cell::Number(bits(self.bytes as u64)),
        ];
        cells.extend(self.bytes_by_stream.map(|bytes| Cell::Number(bits(bytes))));
        cells.extend(times.map(Cell::maybe));
        cells.extend(times.map(|ms| Cell::maybe(ms.map(rate))));
        cells.push(Cell::maybe(self.d1_psnr_db));
        cells.push(Cell::Number(self.bytes as f64));
        Row::new(cells)
    }
}

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

const NAME: &str = "memory";

fn written(frames: &[Decoded], options: &ReelOptions) -> Result<Vec<u8>, ReelError> {
    let mut writer = ReelWriter::new(Vec::new(), Path::new(NAME), options.clone())?;
    for group in frames.chunks(options.keyframes as usize) {
        let group: Vec<NewFrame<'_>> = group
            .iter()
            .map(|frame| NewFrame {
                cloud: &frame.cloud,
                name: &frame.name,
                time: None,
            })
            .collect();
        writer.write_group(&group)?;
    }
    writer.finish()
}

fn opened(bytes: &[u8]) -> Result<ReelFile, ReelError> {
    ReelFile::open(Arc::new(bytes.to_vec()), Path::new(NAME))
}

/// Point to point, both ways, in dB of the diagonal of the box around the reference; `None` where all is equal.
fn d1_psnr_db(reference: &RawCloud, test: &RawCloud) -> Option<f64> {
    let (_, bounds) = reference.positions.finite_bounds();
    let (min, _) = bounds?;
    let near = |cloud: &RawCloud| -> Vec<Vec3> {
        let all = 0..cloud.positions.len();
        let points = all.map(|index| (cloud.positions.get(index) - min).as_vec3());
        points.filter(|point| point.is_finite()).collect()
    };
    let (reference, test) = (near(reference), near(test));
    let peak = Aabb::from_points(&reference).extent().max_element();
    let error = GeometryError::of(&reference, None, &test).ok()?;
    error
        .point_to_point
        .psnr_db(f64::from(peak))
        .filter(|psnr| psnr.is_finite())
}
