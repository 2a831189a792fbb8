//! `pointreel render --video`: a camera path, a turntable, or a fixed camera while the sequence plays.

use crate::cli::options::arguments::FrameRange;
use crate::cli::options::render_arguments::RenderArgs;
use crate::cli::options::sources::{OutputKind, check_outputs};
use crate::cli::options::video_arguments::VideoArgs;
use crate::cli::terminal::output::answer;
use crate::cli::terminal::progress::Bar;
use crate::cli::terminal::warnings;
use crate::export::{Video, VideoFormat, export_video, numbered, picture_names};
use crate::headless::{Headless, PictureStats};
use crate::messages::frame_with_index;
use crate::progress::Progress;
use crate::scene::{CameraPath, Style};
use anyhow::bail;
use std::collections::HashSet;

/// Default frame rate of a path or a turntable, in frames per second.
const DEFAULT_RATE: f64 = 30.0;

/// Renders the video; returns the frames that could not be read, with the reason.
pub(super) fn render_video(
    arguments: &RenderArgs,
    style: &Style,
    headless: &mut Headless,
    stats: &mut Vec<PictureStats>,
) -> anyhow::Result<Vec<(usize, String)>> {
    let Some(output) = &arguments.video.video else {
        bail!("name the output: -o for images, --video for a video");
    };
    let (path, per_second, speed) = match (&arguments.video.path, &arguments.video.path_of_session) {
        (Some(file), _) => written_path(&arguments.video, &CameraPath::read(file)?)?,
        (None, Some(path)) => written_path(&arguments.video, path)?,
        (None, None) => path_around(arguments, headless)?,
    };
    let frame_count = headless.sequence().len();
    let last = frame_count - 1;
    let range = frames(arguments, frame_count)?.unwrap_or(FrameRange { first: 0, last });
    let options = arguments.poses.options(range, headless, style)?;
    let video = Video {
        path: &path,
        style,
        options: &options,
        size: arguments.picture_size(),
        per_second,
        speed,
    };
    let outputs = if VideoFormat::of_name(output)? == VideoFormat::PngFiles {
        let (name, count) = (picture_names(output), video.picture_count());
        (0..count).map(|picture| numbered(&name, picture, count)).collect()
    } else {
        vec![output.clone()]
    };
    check_outputs(headless.sequence(), outputs.into_iter(), OutputKind::Picture)?;
    let mut told = HashSet::new();
    let bar = Bar::new(video.picture_count());
    // A signal ends the process and removes what has been written so far.
    let progress = Progress::default();
    let exported = export_video(headless, &video, output, &progress, &mut |picture| {
        bar.set(picture.done);
        for problem in &picture.problems {
            // A loop shows a frame more than once.
            if told.insert(problem.clone()) {
                warnings::warn_of_frame(problem);
            }
        }
        stats.push(picture.stats.clone());
    });
    bar.clear();
    let failed = exported?;
    for (frame, error) in &failed {
        let named = frame_with_index(*frame, frame_count);
        warnings::warn_of_frame(&format!("{named} is not shown, the one before it stays: {error}"));
    }
    answer(&format!(
        "{} frames written to {}, {per_second:.5} per second",
        video.picture_count(),
        output.display()
    ));
    Ok(failed
        .into_iter()
        .map(|(frame, error)| (frame, error.to_string()))
        .collect())
}

/// The frames that are chosen, in a sequence of `count`.
fn frames(arguments: &RenderArgs, count: usize) -> anyhow::Result<Option<FrameRange>> {
    arguments.frame.map(|frames| frames.of("--frame", count)).transpose()
}

/// Returns a path read from a file, its frames per second, and its speed.
fn written_path(video: &VideoArgs, path: &CameraPath) -> anyhow::Result<(CameraPath, f64, f64)> {
    let speed = match video.seconds {
        Some(_) if path.duration_s() == 0.0 => {
            bail!("a path with one keyframe has no duration: omit --seconds")
        }
        Some(seconds) => path.duration_s() / seconds,
        None => video.speed.unwrap_or(1.0),
    };
    Ok((path.clone(), video.fps.unwrap_or(DEFAULT_RATE), speed))
}

/// A turntable, or a fixed camera, by the arguments.
fn path_around(arguments: &RenderArgs, headless: &Headless) -> anyhow::Result<(CameraPath, f64, f64)> {
    let video = &arguments.video;
    let sequence = headless.sequence();
    if video.fps.is_some() && video.seconds.is_some() {
        bail!("--fps and --seconds contradict each other here: the number of frames is given");
    }
    let range = frames(arguments, sequence.len())?;
    let speed = video.speed.unwrap_or(1.0);
    let first = range.map_or(0, |range| range.first);
    let last = range.map_or(sequence.len() - 1, |range| range.last);
    let pictures = match video.turntable {
        Some(_) if range.is_some() && first != last => {
            bail!("--turntable plays the whole sequence or holds one frame: --frame takes one number here")
        }
        Some(pictures) => f64::from(pictures),
        None => (last - first + 1) as f64,
    };
    let usual = match video.turntable {
        Some(_) => DEFAULT_RATE,
        None => sequence.fps() * speed,
    };
    let per_second = video
        .seconds
        .map_or(video.fps.unwrap_or(usual), |seconds| pictures / seconds);
    let frames_per_picture = match video.turntable {
        Some(_) if range.is_some() || sequence.len() == 1 => 0.0,
        Some(_) => sequence.fps() * speed / per_second,
        None => 1.0,
    };
    let turns = match video.turntable {
        Some(_) => video.turns.unwrap_or(1.0),
        None => 0.0,
    };
    let look = headless.first_look()?;
    let size_px = arguments.picture_size().size_px;
    let camera = arguments.camera.camera(&look, sequence, first, size_px)?;
    let path = CameraPath::turntable(
        camera,
        turns,
        [pictures, per_second],
        [first as f64, frames_per_picture],
    )?;
    Ok((path, per_second, 1.0))
}
