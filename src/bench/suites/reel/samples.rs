//! Cost of storing frames: bytes, bits by stream, times.

use super::judge::Distortion;
use super::original::Original;
use crate::bench::report::{Cell, Row};
use crate::bench::{BenchError, Quantiles};
use crate::progress::Progress;
use crate::reel::{DecodedFrame, NewFrame, ReelDecoder, ReelFile, ReelOptions, StreamKind, write_to_memory};
use crate::stopwatch::milliseconds_since;
use std::sync::Arc;
use std::time::Instant;

/// Measurements of one storage method for frames.
pub(super) struct RetainedSamples {
    pub(super) frames: usize,
    /// Points of all of them, once they are read back.
    pub(super) points: usize,
    pub(super) bytes: usize,
    /// False where only positions are stored.
    pub(super) has_attributes: bool,
    /// `None` of a format without streams.
    pub(super) bytes_by_stream: Option<[u64; StreamKind::ALL.len()]>,
    /// A frame's share, of each repetition.
    pub(super) encode_ms: Vec<f64>,
    pub(super) decode_ms: Vec<f64>,
}

/// The numbers, and the frames that came back.
pub(super) struct Measured {
    pub(super) samples: RetainedSamples,
    pub(super) decoded: Vec<DecodedFrame>,
}

impl RetainedSamples {
    /// Writes `frames` as a sequence file and reads them back `repeats` times.
    pub(super) fn of_reel(
        frames: &[Original],
        options: &ReelOptions,
        repeats: usize,
        progress: &Progress,
    ) -> Result<Measured, BenchError> {
        let new: Vec<NewFrame<'_>> = frames.iter().map(Original::as_new).collect();
        let (mut encode_ms, mut decode_ms) = (Vec::new(), Vec::new());
        let mut bytes = Vec::new();
        let mut decoded = Vec::new();
        for _ in 0..repeats {
            BenchError::check_cancelled(progress)?;
            let start = Instant::now();
            bytes = write_to_memory(&new, options)?;
            encode_ms.push(milliseconds_since(start) / frames.len() as f64);
            let mut decoder = ReelDecoder::new(Arc::new(ReelFile::of_bytes(bytes.clone())?), u64::MAX);
            decoded.clear();
            let start = Instant::now();
            for index in 0..frames.len() {
                decoded.push(decoder.decode(index, usize::MAX, &Progress::default())?);
            }
            decode_ms.push(milliseconds_since(start) / frames.len() as f64);
        }
        let byte_count = bytes.len();
        let file = ReelFile::of_bytes(bytes)?;
        let mut bytes_by_stream = [0; StreamKind::ALL.len()];
        let infos = (0..file.frame_count()).filter_map(|index| file.frame(index));
        let mut points = 0;
        for info in infos {
            points += info.points;
            for (sum, bytes) in bytes_by_stream.iter_mut().zip(info.bytes_by_stream) {
                *sum += bytes;
            }
        }
        let samples = Self {
            frames: frames.len(),
            points,
            bytes: byte_count,
            has_attributes: true,
            bytes_by_stream: Some(bytes_by_stream),
            encode_ms,
            decode_ms,
        };
        Ok(Measured { samples, decoded })
    }

    /// A row of the report.
    pub(super) fn row(&self, sequence: &str, words: &str, distortion: &Distortion) -> Row {
        let bits = |bytes: u64| 8.0 * bytes as f64 / self.points.max(1) as f64;
        let points_per_frame = self.points as f64 / self.frames as f64;
        let times = [&self.encode_ms, &self.decode_ms].map(|times| Quantiles::of(times).map(|times| times.median));
        let rate = |ms: f64| points_per_frame / (1e3 * ms);
        let error = &distortion.error;
        let finite = |number: Option<f64>| Cell::maybe(number.filter(|number| number.is_finite()));
        let mut cells = vec![
            Cell::Text(sequence.to_owned()),
            Cell::Text(words.to_owned()),
            Cell::Number(self.frames as f64),
            Cell::Number(points_per_frame),
            Cell::Number(bits(self.bytes as u64)),
        ];
        let streams = (0..StreamKind::ALL.len()).map(|place| self.bytes_by_stream.map(|bytes| bits(bytes[place])));
        cells.extend(streams.map(Cell::maybe));
        cells.extend(times.map(Cell::maybe));
        cells.extend(times.map(|ms| Cell::maybe(ms.map(rate))));
        cells.extend([error.d1_psnr_db(), error.d2_psnr_db(), error.color_psnr_db()].map(finite));
        cells.push(Cell::maybe(error.normals.map(|normals| normals.mean_deg)));
        // An image in other colours does not measure the loss.
        let flip = self.has_attributes.then_some(distortion.flip);
        cells.push(Cell::maybe(flip));
        cells.push(Cell::Number(self.bytes as f64));
        Row::new(cells)
    }
}
