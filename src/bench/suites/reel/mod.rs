//! Sequence files: bits per point, time and distortion.
//!
//! How it works: some consecutive frames are written to memory as a sequence file ([`crate::reel`]) and read back, with
//! one choice of options after the other. Bits count all bytes, the directory included. Times are per thread, so that
//! they hold for any number of them. The distortion is measured on the last frame ([`judge`]). Draco's results for the
//! same points are listed next to them ([`draco`]).

mod draco;
mod judge;
mod original;
mod rate;
mod samples;

use crate::bench::BenchError;
use crate::bench::report::Column;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::bench::suite::{Defaults, Suite};
use crate::reel::{Coding, Precision, ReelOptions};
use draco::{Coder, DracoCells};
use judge::Judge;
use original::consecutive;
use samples::{Measured, RetainedSamples};

pub use rate::RATE;
pub(super) use rate::measure as measure_rates;

/// Columns, in the order in which [`RetainedSamples::row`] fills them.
const COLUMNS: &[Column] = &[
    Column::text("sequence", "sequence"),
    Column::text("options", "options"),
    Column::number("frames", "frames", 0),
    Column::number("points", "points kept", 0),
    Column::number("bits_per_point", "bits per point", 3),
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
    Column::number("motion_bits", "motion", 3),
    Column::number("encode_ms", "encode ms", 2),
    Column::number("decode_ms", "decode ms", 2),
    Column::number("encode_mpoints_per_s", "M points/s in", 2),
    Column::number("decode_mpoints_per_s", "M points/s out", 2),
    Column::number("d1_psnr", "D1 dB", 2),
    Column::number("d2_psnr", "D2 dB", 2),
    Column::number("color_psnr", "colour dB", 2),
    Column::number("normal_error_deg", "normal °", 2),
    Column::number("flip", "FLIP", 4),
    Column::number("bytes", "bytes", 0).hidden(),
];

/// Sequence files of consecutive frames.
pub const REEL: &Suite = &Suite {
    name: "reel",
    brief: "size and decoding of sequence files",
    title: "Sequence files",
    hint: "Bits per point, times and errors of sequence files with several options",
    description: "bits per point of sequence files by stream, times to encode and decode, distortion; Draco for \
                  comparison",
    measured: "encoding and decoding frames that follow each other, on one thread, in memory; a frame's share of the \
        time of its group; PSNR of the last frame from point to point (D1) and along normals (D2), both ways, with 3 \
        p², and of its colours; mean angle of its normals; FLIP of its image against that of the original, over the \
        pixels that show either",
    not_measured: "reading the frames, disks, the time to draw",
    covered_by: "points",
    defaults: Defaults {
        viewport_px: [1280, 720],
        viewpoints: 2,
        frames: 8,
    },
    takes: &[],
    is_of_paper: false,
    has_paper_layout: false,
    columns: COLUMNS,
    headline: "bits_per_point",
    bars_title: "Bits per point",
    bar_labels: 2,
};

/// The cells that Draco is given: it has no others.
const CELLS: Precision = Precision::Bits(10);

/// The compared encodings of a sequence.
fn variants() -> Vec<(&'static str, ReelOptions)> {
    let voxels = ReelOptions {
        precision: CELLS,
        ..ReelOptions::default()
    };
    let fast = |options: ReelOptions| ReelOptions {
        coding: Coding::Fast,
        ..options
    };
    vec![
        ("every point", ReelOptions::default()),
        ("sampling density", ReelOptions::merged()),
        ("sampling density, fast", fast(ReelOptions::merged())),
        (
            "sampling density, each frame by itself",
            ReelOptions {
                keyframes: 1,
                ..ReelOptions::merged()
            },
        ),
        ("10 bits", voxels.clone()),
        ("10 bits, fast", fast(voxels)),
        ("lossless", ReelOptions::lossless()),
    ]
}

pub(super) fn measure(run: &mut Run<'_>) -> Result<(), BenchError> {
    let variants = variants();
    // One step to draw the original, one per row.
    for subject in run.subjects(1 + variants.len() + Coder::ALL.len())? {
        measure_sequence(run, &subject, &variants)?;
    }
    Ok(())
}

fn measure_sequence(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    variants: &[(&'static str, ReelOptions)],
) -> Result<(), BenchError> {
    let frames = consecutive(subject)?;
    run.begin_step(format!("{}: the original", subject.name))?;
    // The last frame is encoded relative to all before it, wherever any is.
    let last = frames.len() - 1;
    let mut judge = Judge::new(run.options, subject, frames[last].index, &frames[last].cloud)?;
    let (repeats, progress) = (run.options.repeat, run.progress);
    let mut rows = Vec::new();
    let mut cells = None;
    for (words, options) in variants {
        run.begin_step(format!("{}: {words}", subject.name))?;
        let Measured { samples, decoded } =
            one_thread(|| RetainedSamples::of_reel(&frames, options, repeats, progress))??;
        let distortion = judge.judge(&decoded[last].cloud)?;
        rows.push(samples.row(subject.name, words, &distortion));
        if options.precision == CELLS {
            cells = Some(DracoCells::of(&decoded));
        }
    }
    for coder in Coder::ALL {
        let words = coder.words();
        run.begin_step(format!("{}: {words}", subject.name))?;
        let Some(cells) = &cells else { continue };
        let Measured { samples, decoded } = one_thread(|| cells.measure(coder, repeats, progress))??;
        let distortion = judge.judge(&decoded[last].cloud)?;
        rows.push(samples.row(subject.name, words, &distortion));
    }
    let points: Vec<f64> = frames.iter().map(|frame| frame.cloud.positions.len() as f64).collect();
    run.finish(subject, &points, &[], rows);
    Ok(())
}

fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, BenchError> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work))
}
