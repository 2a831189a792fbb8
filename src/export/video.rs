//! Video export: a camera path rendered frame by frame, and encoded in parallel.

use super::limits::MAX_PICTURES;
use super::picture::{self, Picture, PictureSize, draw_picture};
use super::{ExportError, FrameSink, VideoStream, open_sink};
use crate::composition::{ComposeOptions, Composed};
use crate::headless::{Headless, HeadlessError, PictureStats};
use crate::progress::Progress;
use crate::scene::{CameraPath, Style};
use crate::sequence::{FrameError, PreparedFrame};
use crate::timeline::Direction;
use image::RgbaImage;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// Images that wait to be encoded.
const WAITING_PICTURES: usize = 2;

/// Contents of a video and its render settings.
#[derive(Debug, Clone)]
pub struct Video<'a> {
    /// Camera path: the camera and the shown frame over time. Beyond the last frame the sequence starts again.
    pub path: &'a CameraPath,
    /// Render style of the frames.
    pub style: &'a Style,
    /// Additions to each pose.
    pub options: &'a ComposeOptions,
    /// Image size of the frames.
    pub size: PictureSize,
    /// Frame rate in frames per second.
    pub per_second: f64,
    /// Playback speed in seconds of the path per second of video: 1 for the path as it is written.
    pub speed: f64,
}

impl Video<'_> {
    /// Returns the number of frames of the video, both ends of the path included.
    pub fn picture_count(&self) -> usize {
        self.path.picture_count(self.per_second / self.speed)
    }

    /// The images, for [`open_sink`].
    pub fn stream(&self) -> VideoStream {
        VideoStream {
            size_px: self.size.size_px,
            per_second: self.per_second,
            count: self.picture_count(),
            is_transparent: self.size.is_transparent,
        }
    }
}

/// An image was drawn.
#[derive(Debug, Clone)]
pub struct PictureDone {
    /// Number of finished frames.
    pub done: usize,
    /// Total number of frames.
    pub total: usize,
    /// Statistics of the last frame.
    pub stats: PictureStats,
    /// Problems of the shown frame: parts that could not be read, and parts that other frames could not contribute; of
    /// consecutive images of the same frame only the first one reports them.
    pub problems: Vec<String>,
}

/// Draws a video to the file or files that `output` names; `progress` counts the images and may be cancelled; `tell` is
/// called for each. Frames that cannot be read are returned; the frame before is shown instead.
///
/// # Errors
/// Limits of the format, failures to read the first frame, to draw or to write, and [`ExportError::Cancelled`]. Nothing
/// is left of the video then.
pub fn export_video(
    headless: &mut Headless,
    video: &Video<'_>,
    output: &Path,
    progress: &Progress,
    tell: &mut dyn FnMut(&PictureDone),
) -> Result<Vec<(usize, FrameError)>, ExportError> {
    check(video)?;
    let sink = open_sink(output, &video.stream())?;
    render_path(headless, video, sink, progress, tell)
}

/// [`export_video`] to a sink that is open.
pub fn render_path(
    headless: &mut Headless,
    video: &Video<'_>,
    sink: Box<dyn FrameSink>,
    progress: &Progress,
    tell: &mut dyn FnMut(&PictureDone),
) -> Result<Vec<(usize, FrameError)>, ExportError> {
    check(video)?;
    // One thread draws, one encodes: the channel is bounded, so that no more than two images wait.
    let (sender, receiver) = sync_channel(WAITING_PICTURES);
    let (drawn, encoded) = thread::scope(|scope| {
        let encoder = thread::Builder::new()
            .name("video encoder".to_owned())
            .spawn_scoped(scope, move || encode(receiver, sink));
        let encoder = match encoder {
            Ok(encoder) => encoder,
            Err(reason) => return (Err(no_thread(reason)), None),
        };
        let drawn = draw_pictures(headless, video, &sender, progress, tell);
        drop(sender);
        let encoded = encoder.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        (drawn, Some(encoded))
    });
    // Drawing stops when no one receives the images any more: the encoder knows why.
    let sink = encoded.transpose()?;
    let failed = drawn?;
    sink.map_or(Ok(()), FrameSink::finish)?;
    Ok(failed)
}

fn check(video: &Video<'_>) -> Result<(), ExportError> {
    picture::check_size(video.size.size_px)?;
    match video.picture_count() {
        count if count > MAX_PICTURES => Err(ExportError::TooLong { count }),
        _ => Ok(()),
    }
}

fn no_thread(reason: io::Error) -> ExportError {
    ExportError::Write {
        path: "the video".into(),
        reason,
    }
}

fn encode(pictures: Receiver<RgbaImage>, mut sink: Box<dyn FrameSink>) -> Result<Box<dyn FrameSink>, ExportError> {
    for picture in pictures {
        sink.push(&picture)?;
    }
    Ok(sink)
}

fn draw_pictures(
    headless: &mut Headless,
    video: &Video<'_>,
    pictures: &SyncSender<RgbaImage>,
    progress: &Progress,
    tell: &mut dyn FnMut(&PictureDone),
) -> Result<Vec<(usize, FrameError)>, ExportError> {
    let total = video.picture_count();
    progress.set(0, total);
    let mut failed: Vec<(usize, FrameError)> = Vec::new();
    let mut shown: Option<Arc<PreparedFrame>> = None;
    // The drawn content of the current frame: composed once for all images that show it.
    let mut composed: Option<(Arc<PreparedFrame>, Composed)> = None;
    let at = |picture: usize| {
        let seconds = picture as f64 * video.speed / video.per_second;
        video.path.at(seconds)
    };
    for done in 0..total {
        let (camera, place) = at(done);
        let direction = if at(done + 1).1 < place {
            Direction::Backward
        } else {
            Direction::Forward
        };
        let index = place % headless.sequence().len().max(1);
        match headless.frame_on_the_way(index, direction, video.style) {
            Ok(frame) => shown = Some(frame),
            Err(error) if shown.is_none() => {
                return Err(HeadlessError::from(error).into());
            }
            Err(error) if failed.iter().all(|(known, _)| *known != index) => {
                failed.push((index, error));
            }
            Err(_) => {}
        }
        let Some(pose) = &shown else { continue };
        let (frame, problems) = match &mut composed {
            Some((of, composed)) if Arc::ptr_eq(of, pose) => (&composed.frame, Vec::new()),
            _ => {
                let new = headless.compose(pose, video.options, video.style);
                let (new, problems) = new.map_err(HeadlessError::from)?;
                let (_, new) = composed.insert((Arc::clone(pose), new));
                (&new.frame, problems)
            }
        };
        let picture = Picture {
            frame,
            camera: &camera,
            style: video.style,
            size: video.size,
        };
        let picture = draw_picture(headless, &picture)?;
        let stats = headless.stats(frame);
        if pictures.send(picture).is_err() {
            break;
        }
        let picture_done = PictureDone {
            done: done + 1,
            total,
            stats,
            problems,
        };
        tell(&picture_done);
        progress.set(done + 1, total);
        if progress.is_cancelled() {
            return Err(ExportError::Cancelled);
        }
    }
    Ok(failed)
}
