//! An export on its own thread: all of its inputs are taken when it begins, so the window stays usable.

use super::plan;
use crate::app::work::outcome::Message;
use crate::app::work::works::Progress;
use crate::composition::ComposeOptions;
use crate::export::{ExportError, Picture, PictureSize, Video, export_video, write_picture_observed};
use crate::headless::{Headless, HeadlessError};
use crate::render::AnyRenderer;
use crate::scene::{Camera, CameraPath, Choice, Label, RendererChoice, Style};
use crate::sequence::{Loader, LoaderOptions, Sequence};
use crate::timeline::Clock;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Content that is written.
#[derive(Debug)]
pub(in crate::app) enum Shows {
    /// A frame as an image.
    Picture { camera: Camera, frame: usize },
    /// A path with a frame of the sequence at each time.
    Path(Box<CameraPath>),
    /// Revolutions about the up axis in this many images while the sequence plays.
    Turntable {
        camera: Camera,
        turns: f64,
        pictures: usize,
        clock: Clock,
    },
    /// The sequence as it plays.
    Sequence { camera: Camera, clock: Clock },
}

/// All that an export needs.
#[derive(Debug)]
pub(in crate::app) struct ExportJob {
    pub(in crate::app) sequence: Arc<Sequence>,
    pub(in crate::app) style: Style,
    /// Renderer that draws.
    pub(in crate::app) renderer: Choice<RendererChoice>,
    /// Additions to each pose.
    pub(in crate::app) options: ComposeOptions,
    /// Texts at points.
    pub(in crate::app) labels: Arc<Vec<Label>>,
    pub(in crate::app) shows: Shows,
    pub(in crate::app) per_second: f64,
    pub(in crate::app) size: PictureSize,
    pub(in crate::app) output: PathBuf,
    /// The window's time when it began, for its clock.
    pub(in crate::app) now: Duration,
    /// Memory for its frames.
    pub(in crate::app) budget_bytes: usize,
}

/// Written export.
#[derive(Debug)]
pub struct Exported {
    /// The file, or with `{frame}` the files.
    pub(in crate::app) output: PathBuf,
    /// Number of images in the file.
    pub(in crate::app) pictures: usize,
    /// Why frames are not shown in it.
    pub(in crate::app) failed: Vec<String>,
}

impl Message for ExportEnded {}

/// Outcome of an export.
#[derive(Debug)]
pub struct ExportEnded(pub(in crate::app) Result<Exported, ExportError>);

/// Runs `job`, reports each image or part of one to `progress`, and stops soon after that was cancelled.
pub(in crate::app) fn run(job: ExportJob, progress: &Progress) -> Result<Exported, ExportError> {
    let ExportJob {
        sequence,
        style,
        renderer,
        options,
        labels,
        shows,
        per_second,
        size,
        output,
        now,
        budget_bytes,
    } = job;
    let defaults = LoaderOptions::default();
    let loader_options = LoaderOptions {
        // The other half is left to the window.
        workers: defaults.workers.div_ceil(2),
        budget_bytes,
        ..defaults
    };
    let loader = Loader::new(Arc::clone(&sequence), loader_options)?;
    let renderer = AnyRenderer::open(renderer)?;
    let mut headless = Headless::new(sequence, loader, renderer);
    headless.set_labels(labels);
    let path = match shows {
        Shows::Picture { camera, frame } => {
            let pose = headless.frame(frame, &style);
            let composed = pose.and_then(|pose| headless.compose(&pose, &options, &style));
            let (composed, _) = composed.map_err(HeadlessError::from)?;
            let shown = composed.frame;
            let picture = Picture {
                frame: &shown,
                camera: &camera,
                style: &style,
                size,
            };
            write_picture_observed(&mut headless, &picture, &output, progress)?;
            return Ok(Exported {
                output,
                pictures: 1,
                failed: Vec::new(),
            });
        }
        Shows::Path(path) => *path,
        Shows::Turntable {
            camera,
            turns,
            pictures,
            clock,
        } => plan::turntable(camera, turns, pictures, &clock, now, per_second)?,
        Shows::Sequence { camera, clock } => plan::sequence(camera, &clock, now, per_second)?,
    };
    let video = Video {
        path: &path,
        style: &style,
        options: &options,
        size,
        per_second,
        speed: 1.0,
    };
    let pictures = video.picture_count();
    let failed = export_video(&mut headless, &video, &output, progress, &mut |_| {})?;
    let failed = failed
        .into_iter()
        .map(|(frame, reason)| format!("Frame {} is not shown in it: {reason}", frame + 1));
    Ok(Exported {
        output,
        pictures,
        failed: failed.collect(),
    })
}
