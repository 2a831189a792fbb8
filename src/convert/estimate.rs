//! Estimate of the output of a conversion from a few sample frames: sizes and errors before anything is written.
//!
//! How it works: a frame is encoded in memory as the conversion would do it, and read back. In a sequence file it is
//! encoded in a group with neighbouring frames. Each of them represents the frames at its position in all groups; the
//! mean of those behind the first one represents positions that the sample does not cover. Bytes of directories are
//! distributed over the frames.

use super::Edit;
use super::conversion::edited;
use super::error::ConvertError;
use super::reel;
use crate::cloud::{Positions, RawCloud};
use crate::io::{self, Losses, WriteFormat};
use crate::measure::{CloudError, ReferenceCloud};
use crate::progress::Progress;
use crate::reel::{NewFrame, Precision, ReelDecoder, ReelFile, ReelOptions, StreamKind, write_to_memory};
use crate::sequence::{FrameEntry, Sequence};
use crate::source::FrameBytes;
use std::collections::HashSet;
use std::io::Cursor;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A cloud that takes more memory is judged alone, without the one before it.
const MAX_BYTES_OF_TWO: usize = 128 << 20;

/// Frames that are encoded together in this much memory: the coder keeps learning over many small frames; on large ones
/// it has learnt everything before the first one ends.
const BYTES_OF_MANY: usize = 1 << 20;

/// Frames of a group of the usual options.
const MAX_FRAMES: usize = 10;

/// Bytes of each kind of stream, in the order of [`StreamKind::ALL`].
type BytesByStream = [f64; StreamKind::ALL.len()];

/// Target format of frames.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// One sequence file.
    Reel(ReelOptions),
    /// One file per frame.
    Files(WriteFormat),
}

impl Target {
    /// Returns the losses: the data of `cloud` that the target cannot hold.
    pub fn losses(&self, cloud: &RawCloud) -> Losses {
        match self {
            Self::Reel(options) => reel::losses(cloud, options),
            Self::Files(format) => format.losses(cloud),
        }
    }

    /// For people.
    pub fn name(&self) -> String {
        match self {
            Self::Reel(_) => "reel".to_owned(),
            Self::Files(format) => format.to_string(),
        }
    }
}

/// A frame that conversions are judged by.
#[derive(Debug)]
pub struct SampleFrame {
    /// Its index.
    pub index: usize,
    /// The frame and its neighbours, in their order.
    clouds: Vec<(RawCloud, Arc<FrameEntry>)>,
    /// The place of the frame among them.
    place: usize,
    /// Frames that are converted.
    frame_count: usize,
    /// `None` of a frame without points.
    reference: Option<ReferenceCloud>,
}

/// Estimated conversion result of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleEstimate {
    /// Index of the frame.
    pub index: usize,
    /// Points that it has.
    pub points: usize,
    /// Points that are left.
    pub retained_points: usize,
    /// Bytes of such a frame in a long file.
    pub bytes: f64,
    /// Bytes per kind of stream, in the order of [`StreamKind::ALL`]; `None` for files without streams.
    pub bytes_by_stream: Option<BytesByStream>,
    /// Estimate for the alternative: keeping every point if points are merged, and vice versa; `None` where that is not
    /// a separate choice.
    pub other_way: Option<OtherWay>,
    /// Error of the remaining points compared with the original; `None` for a frame without points.
    pub error: Option<CloudError>,
    /// Losses: the data of the frame that the target cannot hold.
    pub losses: Losses,
}

/// Estimate of a frame for the alternative point treatment: points merged, or every point retained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherWay {
    /// Points that are left.
    pub points: f64,
    /// Bytes of such a frame in a long file.
    pub bytes: f64,
}

/// The alternative point treatment.
fn other_way(options: &ReelOptions) -> Option<ReelOptions> {
    let precision = match options.precision {
        Precision::PointSpacing => Precision::SamplingDensity,
        Precision::SamplingDensity => Precision::PointSpacing,
        _ => return None,
    };
    Some(ReelOptions {
        precision,
        keep_order: false,
        // Unquantised normals belong to points that are retained as they are.
        normal_bits: if options.normal_bits == 0 {
            13
        } else {
            options.normal_bits
        },
        ..options.clone()
    })
}

impl SampleFrame {
    /// Decodes frame `index` of the frames that are converted, and edits it.
    ///
    /// # Errors
    /// A frame that cannot be read or edited.
    pub fn read(
        sequence: &Sequence,
        frames: &RangeInclusive<usize>,
        index: usize,
        edit: &Edit,
    ) -> Result<Self, ConvertError> {
        let sample = Self::read_with(sequence, frames, index, |index| edited(sequence, index, edit))?;
        Ok(Self {
            reference: ReferenceCloud::new(&sample.judged().0).ok(),
            ..sample
        })
    }

    /// Reads a sample like `read`, but from frames as `decode` returns them, and without evaluating errors.
    /// Neighbouring frames that cannot be read are skipped.
    pub(super) fn read_with(
        sequence: &Sequence,
        frames: &RangeInclusive<usize>,
        index: usize,
        decode: impl Fn(usize) -> Result<RawCloud, ConvertError>,
    ) -> Result<Self, ConvertError> {
        let cloud = decode(index)?;
        let count = match cloud.byte_size() {
            0..=MAX_BYTES_OF_TWO => (BYTES_OF_MANY / cloud.byte_size().max(1)).clamp(2, MAX_FRAMES),
            _ => 1,
        };
        let (start, end) = (*frames.start(), frames.end() + 1);
        let group = start + index.saturating_sub(start) / MAX_FRAMES * MAX_FRAMES;
        let is_whole = count == MAX_FRAMES && group + 2 < end;
        // Small frames are grouped as by the default options, others follow their predecessor.
        let first = if is_whole {
            group
        } else {
            (index + 1).saturating_sub(count).max(start)
        };
        let adjacent = |range: Range<usize>| {
            let decoded = range.map(|index| (decode(index), index));
            decoded.filter_map(|(cloud, index)| Some((cloud.ok()?, sequence.entry(index))))
        };
        let mut clouds: Vec<_> = adjacent(first..index).collect();
        let place = clouds.len();
        clouds.push((cloud, sequence.entry(index)));
        clouds.extend(adjacent(index + 1..(first + count).min(end)));
        Ok(Self {
            index,
            clouds,
            place,
            frame_count: frames.clone().count(),
            reference: None,
        })
    }

    /// Longest edge of the box around the frame; 0 without points.
    pub(super) fn extent(&self) -> f64 {
        let (_, bounds) = self.judged().0.positions.finite_bounds();
        bounds.map_or(0.0, |(min, max)| (max - min).max_element())
    }

    /// The frame.
    fn judged(&self) -> &(RawCloud, Arc<FrameEntry>) {
        &self.clouds[self.place]
    }

    /// Memory that it takes.
    pub fn byte_size(&self) -> usize {
        let clouds: usize = self.clouds.iter().map(|(cloud, _)| cloud.byte_size()).sum();
        // The reference holds another copy of positions, colours and normals, and sorted positions.
        2 * clouds
    }

    /// Estimates the result of converting the sample to `target`; `None` once `progress` is cancelled.
    ///
    /// # Errors
    /// Invalid options, and data that a format cannot hold.
    pub fn judge(&self, target: &Target, progress: &Progress) -> Result<Option<SampleEstimate>, ConvertError> {
        let (cloud, entry) = self.judged();
        let mut estimate = SampleEstimate {
            index: self.index,
            points: cloud.positions.len(),
            retained_points: 0,
            bytes: 0.0,
            bytes_by_stream: None,
            other_way: None,
            error: None,
            losses: target.losses(cloud),
        };
        let retained = match target {
            Target::Reel(options) => {
                let (file, place, bytes) = self.as_reel(options)?;
                estimate.bytes = bytes.iter().sum::<f64>() + shared_bytes(&file, options, self.frame_count)?;
                estimate.bytes_by_stream = Some(bytes);
                estimate.other_way = other_way(options).map(|options| self.other(&options)).transpose()?;
                if progress.is_cancelled() {
                    return Ok(None);
                }
                let mut decoder = ReelDecoder::new(Arc::new(file), u64::MAX);
                decoder.decode(place, usize::MAX, progress)?.cloud
            }
            Target::Files(format) => {
                let write_error = |reason| ConvertError::Write {
                    path: entry.path.clone(),
                    reason,
                };
                let mut file = Cursor::new(Vec::new());
                io::write(&mut file, *format, cloud).map_err(write_error)?;
                let bytes = file.into_inner();
                estimate.bytes = bytes.len() as f64;
                if progress.is_cancelled() {
                    return Ok(None);
                }
                let name = format!("frame.{}", format.extension());
                let read = io::read_bytes(Path::new(&name), &bytes);
                read.map_err(|reason| write_error(std::io::Error::other(reason)))?
            }
        };
        if progress.is_cancelled() {
            return Ok(None);
        }
        estimate.retained_points = retained.positions.len();
        estimate.error = self
            .reference
            .as_ref()
            .and_then(|reference| reference.compare(&retained).ok());
        Ok((!progress.is_cancelled()).then_some(estimate))
    }

    /// Points and bytes with these options.
    pub(super) fn other(&self, options: &ReelOptions) -> Result<OtherWay, ConvertError> {
        let (file, place, bytes) = self.as_reel(options)?;
        Ok(OtherWay {
            points: file.frame(place).map_or(0, |frame| frame.points) as f64,
            bytes: bytes.iter().sum::<f64>() + shared_bytes(&file, options, self.frame_count)?,
        })
    }

    /// The frames as a group of a sequence file, the frame's place in it, and the bytes of each kind of stream that a
    /// frame of such a file takes.
    fn as_reel(&self, options: &ReelOptions) -> Result<(ReelFile, usize, BytesByStream), ConvertError> {
        let size = (options.keyframes as usize).clamp(1, self.clouds.len());
        let first = self.place / size * size;
        let first = first.min(self.clouds.len() - size);
        let new = self.clouds[first..first + size].iter().map(|(cloud, entry)| NewFrame {
            cloud,
            name: &entry.name,
            time: entry.time,
        });
        let new: Vec<NewFrame<'_>> = new.collect();
        let file = ReelFile::of_bytes(write_to_memory(&new, options)?)?;
        let frames = (0..size).map(|index| file.frame(index).map_or([0; _], |frame| frame.bytes_by_stream));
        let frames: Vec<[u64; StreamKind::ALL.len()]> = frames.collect();
        let group = (options.keyframes as usize).clamp(1, self.frame_count.max(1));
        let bytes = std::array::from_fn(|kind| {
            // Frames of a longer group cost as much as those that follow the first one here.
            let following: u64 = frames.iter().skip(1).map(|frame| frame[kind]).sum();
            let like_others = following as f64 / (size - 1).max(1) as f64;
            let bytes_at = |place: usize| match frames.get(place) {
                Some(frame) => frame[kind] as f64,
                None if size > 1 => like_others,
                None => frames[0][kind] as f64,
            };
            // The last group may be shorter.
            let count = self.frame_count.max(1);
            let groups_with = |place: usize| count / group + usize::from(place < count % group);
            let all = (0..group).map(|place| groups_with(place) as f64 * bytes_at(place));
            all.sum::<f64>() / count as f64
        });
        Ok((file, self.place - first, bytes))
    }
}

/// Returns the bytes of a file that do not belong to its streams.
fn other_bytes(file: &ReelFile) -> f64 {
    let frames = (0..file.frame_count()).filter_map(|index| file.frame(index));
    let of_streams: u64 = frames.flat_map(|frame| frame.bytes_by_stream).sum();
    file.byte_size().saturating_sub(of_streams) as f64
}

/// Returns the overhead of a frame in bytes in addition to its streams: its own part of directory and index, and its
/// share of data stored once per group and file. The overhead is measured on small files of zero, one and two frames.
fn shared_bytes(file: &ReelFile, options: &ReelOptions, frame_count: usize) -> Result<f64, ConvertError> {
    let point = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]]));
    let frame = NewFrame {
        cloud: &point,
        name: "",
        time: None,
    };
    let together = ReelOptions {
        keyframes: 2,
        ..options.clone()
    };
    let of_frames = |frames: &[NewFrame<'_>]| -> Result<f64, ConvertError> {
        let file = ReelFile::of_bytes(write_to_memory(frames, &together)?)?;
        Ok(other_bytes(&file))
    };
    let [none, one, two] = [&[][..], &[frame], &[frame, frame]].map(of_frames);
    let (of_file, one, two) = (none?, one?, two?);
    let of_group = (2.0 * one - two - of_file).max(0.0);
    let of_frame = (other_bytes(file) - of_file - of_group) / file.frame_count().max(1) as f64;
    let groups = groups_a_frame(options, frame_count);
    Ok(of_frame.max(0.0) + of_group * groups + of_file / frame_count.max(1) as f64)
}

/// The share of frames that begin a group.
fn groups_a_frame(options: &ReelOptions, frame_count: usize) -> f64 {
    let count = frame_count.max(1);
    count.div_ceil(options.keyframes as usize) as f64 / count as f64
}

/// Estimated conversion result of a sequence, from some of its frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Frames that it is judged by.
    pub frames: usize,
    /// Mean points of a frame.
    pub points: f64,
    /// Mean points of a frame that are left.
    pub retained_points: f64,
    /// Mean bytes of a frame.
    pub frame_bytes: f64,
    /// Bytes per kind of stream.
    pub bytes_by_stream: Option<BytesByStream>,
    /// The mean estimate of the alternative point treatment, where known for every frame.
    pub other_way: Option<OtherWay>,
    /// Errors, where a frame has points.
    pub errors: Option<EstimatedErrors>,
    /// Losses: the data of the frames that the target cannot hold, one line per kind.
    pub losses: Losses,
}

/// Errors of the frames of an [`Estimate`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedErrors {
    /// Largest distance of a point from the other cloud, in the unit of the file.
    pub largest: f64,
    /// Root of the mean square of distances.
    pub rms: f64,
    /// PSNR of distances from point to point; infinite without an error.
    pub d1_psnr_db: Option<f64>,
    /// PSNR of colours; infinite without an error. `None` without colours.
    pub color_psnr_db: Option<f64>,
    /// Mean and largest angle of normals; `None` without normals.
    pub normals_deg: Option<[f64; 2]>,
}

impl Estimate {
    /// By these frames; `None` without any.
    pub fn of(samples: &[SampleEstimate]) -> Option<Self> {
        let first = samples.first()?;
        let mean =
            |value: &dyn Fn(&SampleEstimate) -> f64| samples.iter().map(value).sum::<f64>() / samples.len() as f64;
        let of_kind = |kind: usize| mean(&|sample| sample.bytes_by_stream.map_or(0.0, |bytes| bytes[kind]));
        let errors: Vec<CloudError> = samples.iter().filter_map(|sample| sample.error).collect();
        Some(Self {
            frames: samples.len(),
            points: mean(&|sample| sample.points as f64),
            retained_points: mean(&|sample| sample.retained_points as f64),
            frame_bytes: mean(&|sample| sample.bytes),
            bytes_by_stream: first.bytes_by_stream.map(|_| std::array::from_fn(of_kind)),
            other_way: samples
                .iter()
                .all(|sample| sample.other_way.is_some())
                .then(|| OtherWay {
                    points: mean(&|sample| sample.other_way.map_or(0.0, |other| other.points)),
                    bytes: mean(&|sample| sample.other_way.map_or(0.0, |other| other.bytes)),
                }),
            errors: EstimatedErrors::of(&errors),
            losses: samples.iter().fold(Losses::default(), |mut all, sample| {
                all.merge(sample.losses.clone());
                all
            }),
        })
    }

    /// Bits of a point that is left.
    pub fn bits_per_point(&self) -> f64 {
        self.bits(self.frame_bytes)
    }

    /// Returns the bits per point of each kind of stream that takes any.
    pub fn bits_by_stream(&self) -> Vec<(StreamKind, f64)> {
        let bytes = self.bytes_by_stream.unwrap_or_default();
        let kinds = StreamKind::ALL.into_iter().zip(bytes);
        kinds
            .filter(|(_, bytes)| *bytes > 0.0)
            .map(|(kind, bytes)| (kind, self.bits(bytes)))
            .collect()
    }

    fn bits(&self, bytes: f64) -> f64 {
        8.0 * bytes / self.retained_points.max(1.0)
    }
}

impl EstimatedErrors {
    fn of(errors: &[CloudError]) -> Option<Self> {
        let count = errors.len() as f64;
        let largest = |value: &dyn Fn(&CloudError) -> f64| errors.iter().map(value).reduce(f64::max);
        let mean = |value: &dyn Fn(&CloudError) -> f64| errors.iter().map(value).sum::<f64>() / count;
        let has_colors = errors.iter().all(|error| error.color_squared.is_some());
        let has_normals = errors.iter().all(|error| error.normals.is_some());
        // From means of squares, relative to the size of each frame.
        let relative = mean(&|error| error.geometry.point_to_point.mean_squared() / error.peak.powi(2));
        Some(Self {
            largest: largest(&|error| error.geometry.point_to_point.hausdorff())?,
            rms: mean(&|error| error.geometry.point_to_point.mean_squared()).sqrt(),
            d1_psnr_db: relative.is_finite().then(|| 10.0 * (3.0 / relative).log10()),
            color_psnr_db: has_colors
                .then(|| crate::measure::psnr_db(mean(&|error| error.color_squared.unwrap_or(0.0)))),
            normals_deg: largest(&|error| error.normals.map_or(0.0, |normals| normals.max_deg))
                .filter(|_| has_normals)
                .map(|largest| {
                    [
                        mean(&|error| error.normals.map_or(0.0, |normals| normals.mean_deg)),
                        largest,
                    ]
                }),
        })
    }
}

/// A size in words.
pub(super) fn megabytes(bytes: f64) -> String {
    format!("{:.2} MB", bytes / 1e6)
}

/// Bytes of the files with some frames of a sequence; `None` if unknown.
pub fn source_bytes(sequence: &Sequence, frames: &RangeInclusive<usize>) -> Option<u64> {
    if let Some(reel) = sequence.source().reel() {
        return Some(reel.byte_size());
    }
    let mut files: HashSet<PathBuf> = HashSet::new();
    let mut sum = 0;
    for index in frames.clone().filter(|index| sequence.frames().contains(index)) {
        let entry = sequence.entry(index);
        if let FrameBytes::Embedded(bytes) = entry.content {
            sum += bytes.len() as u64;
            continue;
        }
        for path in std::iter::once(&entry.path).chain(&entry.normals) {
            if !files.contains(path) {
                sum += std::fs::metadata(path).ok()?.len();
                files.insert(path.clone());
            }
        }
    }
    Some(sum)
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;
