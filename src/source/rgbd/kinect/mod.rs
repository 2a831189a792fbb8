//! Recordings of an Azure Kinect and compatible cameras: the `.mkv` of `k4arecorder`.
//!
//! A Matroska file with one track per camera: depths in millimetres (16 bits, the high byte first), colours as JPEG or
//! as bare pixels, infrared images, which are ignored, and motion samples. Tags identify the tracks and the mode of the
//! depth camera; the calibration of the device is attached as JSON. (Azure Kinect DK documentation, *Recording file
//! format*.)

mod device;
mod modes;

use super::calibration::{Calibration, Intrinsics};
use super::depth_code::DepthCode;
use super::depth_scale::Units;
use super::error::RgbdError;
use super::layouts::{FoundRecording, FrameImages};
use super::options::RgbdOptions;
use super::pairs::nearest;
use super::recorder::Recorder;
use super::stored_image::{BlockImage, BlockPixels, StoredImage};
use crate::io::ReadOptions;
use crate::io::recordings::matroska::{self, Block, Matroska, Track};
use crate::messages::grouped;
use device::Device;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Units of the depths.
const UNITS_PER_METRE: f64 = 1000.0;

/// A calibration has twenty thousand bytes.
const MAX_CALIBRATION_BYTES: u64 = 16 << 20;

/// The extension of its recordings.
const EXTENSION: &str = "mkv";

/// Recorder for Matroska videos.
pub(super) const RECORDER: Recorder = Recorder {
    extensions: &[EXTENSION],
    can_read: is_one,
    find: |path, options| Ok(Some(("Azure Kinect", find(path, &options.rgbd, &options.read)?))),
};

/// Returns true if the file at `path` is a Matroska file by its first bytes, or claims to be one by its name.
fn is_one(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = crate::regular_file::open(path).and_then(|file| file.take(4).read_to_end(&mut start));
    let is_named = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION));
    read.is_ok() && (is_named || matroska::is_one(&start))
}

/// The recording in the Matroska file at `path`.
fn find(path: &Path, options: &RgbdOptions, read: &ReadOptions) -> Result<FoundRecording, RgbdError> {
    let wrong = |problem: String| RgbdError::Matroska {
        path: path.to_owned(),
        problem,
    };
    let file = Matroska::read(path).map_err(|error| wrong(error.to_string()))?;
    let recording = KinectRecording { path, file: &file };
    let depth = recording.depth().map_err(wrong)?;
    let mut notes = Vec::new();
    let mut color = recording.color(&mut notes);
    let calibration = if options.intrinsics.is_some() {
        // If the user specifies the camera, none is needed.
        Calibration::of_depth(Intrinsics::pinhole([1.0, 1.0, 0.0, 0.0], None), "--intrinsics")
    } else {
        let device = recording.device(read.max_memory_bytes).map_err(wrong)?;
        let mode = modes::of_depth(file.tag("K4A_DEPTH_MODE"), depth.size_px).map_err(wrong)?;
        let lens = color.as_ref().map(|color| device.color(color.track.size_px));
        if let Some(Err(problem)) = &lens {
            notes.push(format!(
                "colours are skipped, as the calibration does not describe their camera: {problem}"
            ));
            color = None;
        }
        Calibration {
            color: lens.and_then(Result::ok).map(|lens| (lens, device.color_from_depth())),
            ..Calibration::of_depth(
                device.depth(&mode),
                format!("the calibration of the device, for {}", mode.name),
            )
        }
    };
    let mut found = recording.found(depth, color.as_ref(), calibration, notes);
    if file.is_truncated {
        found.damage.push(format!(
            "{}: the recording ends early: what is before its end is read",
            path.display()
        ));
    }
    Ok(found)
}

/// The track with the colours, and the kind of its frames.
struct Colors<'a> {
    track: &'a Track,
    pixels: BlockPixels,
}

struct KinectRecording<'a> {
    path: &'a Path,
    file: &'a Matroska,
}

impl KinectRecording<'_> {
    /// Returns the track whose number the tag gives, otherwise the one of this name.
    fn track(&self, tag: &str, name: &str) -> Option<&Track> {
        let uid: Option<u64> = self.file.tag(tag).and_then(|value| value.trim().parse().ok());
        let tracks = || self.file.tracks.iter();
        tracks()
            .find(|track| Some(track.uid) == uid)
            .or_else(|| tracks().find(|track| track.name == name))
    }

    fn depth(&self) -> Result<&Track, String> {
        let Some(track) = self.track("K4A_DEPTH_TRACK", "DEPTH") else {
            let is_passive = self.file.tag("K4A_DEPTH_MODE") == Some("PASSIVE_IR");
            let names: Vec<String> = self
                .file
                .tracks
                .iter()
                .map(|track| format!("`{}` ({})", track.name.escape_default(), track.codec.escape_default()))
                .collect();
            return Err(if is_passive {
                "the camera was in the mode PASSIVE_IR, which takes infrared images and no depths: record in another \
                 mode"
                    .to_owned()
            } else {
                format!(
                    "no track has depths: expected a recording of an Azure Kinect with a track DEPTH, found {}",
                    names.join(", ")
                )
            });
        };
        let is_depth = track.fourcc() == Some(*b"b16g");
        if !is_depth || track.is_packed {
            return Err(format!(
                "the depths of track {} are written as {}{}, and grey of 16 bits (b16g) was expected as k4arecorder \
                 writes it: open the recording as it was before it was converted",
                track.number,
                codec_of(track),
                if track.is_packed { ", packed once more" } else { "" }
            ));
        }
        if track.laced > 0 || track.size_px.contains(&0) {
            return Err(format!(
                "track {} has {} blocks of several depth images of {} × {} pixels: one image a block was expected",
                track.number, track.laced, track.size_px[0], track.size_px[1]
            ));
        }
        Ok(track)
    }

    /// Colours, if they can be read; a note says why not.
    fn color(&self, notes: &mut Vec<String>) -> Option<Colors<'_>> {
        let track = self.track("K4A_COLOR_TRACK", "COLOR")?;
        let pixels = match track.fourcc().as_ref() {
            Some(b"MJPG") => Some(BlockPixels::File),
            Some(b"NV12") => Some(BlockPixels::Bare("nv12")),
            Some(b"YUY2") => Some(BlockPixels::Bare("yuyv")),
            Some(b"BGRA") => Some(BlockPixels::Bare("bgra8")),
            _ => None,
        };
        let pixels = pixels.filter(|_| !track.is_packed && track.laced == 0 && !track.size_px.contains(&0));
        if pixels.is_none() {
            notes.push(format!(
                "colours of track {} are skipped: they are encoded as {}, and only single images (MJPG, NV12, YUY2, \
                 BGRA) are read, as k4arecorder writes them; export them as images, and open those with the depths",
                track.number,
                codec_of(track)
            ));
        }
        Some(Colors { track, pixels: pixels? })
    }

    /// The calibration that is attached.
    fn device(&self, max_bytes: u64) -> Result<Device, String> {
        let name = self.file.tag("K4A_CALIBRATION_FILE").unwrap_or("calibration.json");
        let named = self.file.attachments.iter().find(|file| file.name == name);
        let Some(attached) = named else {
            return Err(format!(
                "no file `{}` is attached, which says what the cameras are: name the depth camera by --intrinsics \
                 fx,fy,cx,cy or a file",
                name.escape_default()
            ));
        };
        let json = attached.content.read(self.path, max_bytes.min(MAX_CALIBRATION_BYTES));
        let device = json.and_then(|json| Device::of_json(&json));
        device.map_err(|problem| format!("the attached file `{}`: {problem}", name.escape_default()))
    }

    /// Returns the delay of depths relative to colours; signed, in nanoseconds.
    fn depth_delay_ns(&self) -> i64 {
        let tag = self.file.tag("K4A_DEPTH_DELAY_NS");
        tag.and_then(|value| value.trim().parse().ok()).unwrap_or(0)
    }

    fn image(&self, track: &Track, pixels: BlockPixels, block: Block) -> StoredImage {
        StoredImage::Block(BlockImage {
            path: self.path.into(),
            track: track.name.as_str().into(),
            size_px: track.size_px,
            pixels,
            block,
        })
    }

    fn found(
        &self,
        depth: &Track,
        color: Option<&Colors<'_>>,
        calibration: Calibration,
        mut notes: Vec<String>,
    ) -> FoundRecording {
        let calibration = Arc::new(calibration);
        let delay_ns = self.depth_delay_ns();
        let frames: Vec<FrameImages> = depth
            .frames
            .iter()
            .map(|&block| FrameImages {
                depth: self.image(depth, BlockPixels::Bare("16UC1"), block),
                color: color.and_then(|color| {
                    let frames = &color.track.frames;
                    let at = nearest(frames.len(), |at| frames[at].time, earlier(block.time, delay_ns))?;
                    Some(self.image(color.track, color.pixels, frames[at]))
                }),
                time: Some(block.time),
                world_from_camera: None,
                calibration: Arc::clone(&calibration),
            })
            .collect();
        let alone = frames.iter().filter(|frame| frame.color.is_none()).count();
        if color.is_some() && alone > 0 {
            notes.push(format!(
                "{} of {} depth images have no colour image within 20 ms: their points have no colours",
                grouped(alone),
                grouped(frames.len())
            ));
        }
        FoundRecording {
            frames,
            code: DepthCode::per_metre(UNITS_PER_METRE),
            units: Units::Certain,
            assumptions: Vec::new(),
            notes,
            damage: Vec::new(),
        }
    }
}

/// The given number of nanoseconds before `time`, but not before the first.
fn earlier(time: Duration, by_ns: i64) -> Duration {
    let by = Duration::from_nanos(by_ns.unsigned_abs());
    if by_ns < 0 {
        time.saturating_add(by)
    } else {
        time.saturating_sub(by)
    }
}

/// Returns a human-readable codec name for the frames of a track.
fn codec_of(track: &Track) -> String {
    let kind = track.fourcc().map(|kind| kind.escape_ascii().to_string());
    kind.unwrap_or_else(|| track.codec.escape_default().to_string())
}
