//! `pointreel render`: frames to images, or to a video, with the code that draws the window.

use super::video::render_video;
use crate::assumption::Subject;
use crate::cli::options::arguments::FrameRange;
use crate::cli::options::colors::check_source;
use crate::cli::options::render_arguments::RenderArgs;
use crate::cli::options::sources::{OutputKind, check_outputs, check_replaced, write_text};
use crate::cli::options::values::FrameChoice;
use crate::cli::session::{OpenedInputs, open_inputs_and_tell};
use crate::cli::terminal::output::{BytesAnswer, note};
use crate::cli::terminal::{assumptions, warnings};
use crate::document::Document;
use crate::export::{FRAME_PLACEHOLDER, Picture, PictureFormat, has_placeholder, numbered, write_picture, write_png};
use crate::headless::{Headless, PictureStats};
use crate::messages::{frame_with_index, grouped};
use crate::render::AnyRenderer;
use crate::scene::{Camera, Primitive, Settings, Style};
use crate::sequence::{ColorSource, Loader, LoaderOptions};
use crate::temporary::Temporary;
use anyhow::{Context as _, bail};
use serde::Serialize;
use std::io::{IsTerminal as _, Write as _};
use std::path::Path;
use std::sync::Arc;

#[derive(Serialize)]
struct Stats {
    adapter: String,
    size: [u32; 2],
    primitive: String,
    splatting: String,
    instancing: String,
    frames: Vec<PictureStats>,
}

/// Fills missing `arguments` of `render` from a session, for a sequence of `frame_count` frames.
pub(super) fn fill(arguments: &mut RenderArgs, session: &Document, frame_count: usize) {
    let last = frame_count.saturating_sub(1);
    arguments.camera.take_view(session.view, session.up);
    if arguments.video.video.is_none() {
        let frame = session.frame.min(last);
        arguments.frame.get_or_insert(FrameRange::one(frame).into());
        return;
    }
    let moves_by_itself = arguments.video.path.is_some() || arguments.video.turntable.is_some();
    if !moves_by_itself && arguments.frame.is_none() {
        arguments.video.path_of_session = session.path.path().cloned();
        let range = session.range.of(frame_count);
        if session.path.path().is_none() && !range.is_empty() {
            let range = FrameRange {
                first: range.start,
                last: range.end - 1,
            };
            arguments.frame = Some(range.into());
        }
    }
}

pub(in crate::cli) fn run(arguments: &RenderArgs) -> anyhow::Result<()> {
    if let Some(output) = &arguments.output {
        check_picture(arguments, output)?;
    }
    let OpenedInputs { sequence, session } =
        open_inputs_and_tell(&arguments.inputs, &arguments.read.picture_options())?;
    let sequence = Arc::new(sequence);
    let session = session.map(|read| read.document);
    let mut arguments = arguments.clone();
    if let Some(session) = &session {
        fill(&mut arguments, session, sequence.len());
    }
    let arguments = &arguments;
    let choice = arguments.frame.unwrap_or(FrameRange::one(0).into());
    let range = choice.of("--frame", sequence.len())?;
    if let Some(output) = &arguments.output {
        let names = range.bounds().map(|frame| numbered(output, frame, sequence.len()));
        let names = names.filter(|name| name.as_os_str() != STDOUT);
        check_outputs(&sequence, names, OutputKind::Picture)?;
    }
    check_outputs(&sequence, arguments.stats.clone().into_iter(), OutputKind::Json)?;
    let of_session = session.as_ref().map_or_else(Settings::default, Document::style);
    let style = arguments.picture.style_over(of_session);
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default())?;
    let renderer = AnyRenderer::open(style.drawing.renderer)?;
    let mut headless = Headless::new(Arc::clone(&sequence), loader, renderer);
    if let Some(session) = session {
        headless.set_labels(session.labels);
    }
    let look = headless.first_look()?;
    if let Some(lack) = style.primitive.chosen().and_then(|primitive| look.lack_of(primitive)) {
        warnings::warn(&lack);
    }
    let chooses_primitive = !style.primitive.is_open();
    let chooses_colors = style.colors.source != ColorSource::Auto;
    let style = style.resolved(&look);
    if let Some(source) = arguments.picture.color_source() {
        let frame = headless.frame(range.first, &style).ok();
        let fields = frame.as_ref().map(|prepared| prepared.frame.scalar_fields());
        check_source(source, &sequence, range.first, fields)?;
    }
    let mut stats = Stats {
        adapter: headless.renderer().summary(),
        size: arguments.size_px(),
        primitive: style.primitive.to_string(),
        splatting: style.surfels.splatting.to_string(),
        instancing: style.drawing.strategy.to_string(),
        frames: Vec::new(),
    };
    let (failed, asked) = if let Some(output) = &arguments.output {
        let failed = render_frames(arguments, output, range, &style, &mut headless, &mut stats)?;
        (failed, range.last - range.first + 1)
    } else {
        let failed = render_video(arguments, &style, &mut headless, &mut stats.frames)?;
        (failed, sequence.len())
    };
    if let Some(path) = &arguments.stats {
        // It may have become the image or video in the meantime, under any name.
        check_replaced(path, OutputKind::Json)?;
        let json = serde_json::to_string_pretty(&stats).context("the statistics cannot be written as JSON")?;
        write_text(path, &json)?;
    }
    let sets_up = arguments.camera.sets_up() || arguments.video.has_path();
    let primitive = chooses_primitive.then_some(Subject::Primitive);
    let up = sets_up.then_some(Subject::UpAxis);
    let colors = chooses_colors.then_some(Subject::Colors);
    // An image has no frame rate.
    let times = arguments.output.is_some().then_some(Subject::FrameTimes);
    let chosen: Vec<Subject> = [primitive, up, colors, times].into_iter().flatten().collect();
    assumptions::print_guesses(headless.sequence(), Some(&look), &chosen);
    match failed.as_slice() {
        [] => Ok(()),
        [(_, error)] if asked == 1 => bail!("{error}"),
        failed => bail!(
            "{} of {} frames could not be rendered",
            grouped(failed.len()),
            grouped(asked)
        ),
    }
}

/// The image name that stands for stdout.
const STDOUT: &str = "-";

/// Refuses images that cannot be written, before anything is read.
fn check_picture(arguments: &RenderArgs, output: &Path) -> anyhow::Result<()> {
    if let Some(frames) = arguments.frame {
        check_names(output, frames)?;
    }
    if output.as_os_str() == STDOUT {
        if std::io::stdout().is_terminal() {
            bail!("-o - writes a PNG to stdout, which is a terminal: send it to a file or a program");
        }
        return Ok(());
    }
    let format = PictureFormat::of_name(output)?;
    let size = arguments.picture_size();
    Ok(format.check(size.size_px, size.is_transparent)?)
}

/// Several frames need several names.
fn check_names(output: &Path, frames: FrameChoice) -> anyhow::Result<()> {
    if !frames.is_one() && !has_placeholder(output) {
        bail!(
            "frames {frames} would all be written to {}: put {FRAME_PLACEHOLDER} into its name, or make a \
             --video",
            output.display()
        );
    }
    Ok(())
}

/// Creates the folder for images of several frames; it is removed again if nothing is written to it.
fn make_folder(output: &Path, frame_count: usize) -> anyhow::Result<Option<Temporary>> {
    if !has_placeholder(output) {
        return Ok(None);
    }
    let first = numbered(output, 0, frame_count);
    let folder = first.parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() || folder.is_dir() {
        return Ok(None);
    }
    let new = Temporary::folder(folder);
    std::fs::create_dir_all(folder)
        .with_context(|| format!("the folder {} for the images cannot be created", folder.display()))?;
    Ok(Some(new))
}

/// Renders every frame that can be; returns those that cannot, with the reason.
fn render_frames(
    arguments: &RenderArgs,
    output: &Path,
    range: FrameRange,
    style: &Style,
    headless: &mut Headless,
    stats: &mut Stats,
) -> anyhow::Result<Vec<(usize, String)>> {
    let sequence = Arc::clone(headless.sequence());
    let count = sequence.len();
    let _new_folder = make_folder(output, count)?;
    let look = headless.first_look()?;
    let FrameRange { first, last } = range;
    let options = arguments.poses.options(range, headless, style)?;
    let mut failed = Vec::new();
    // One camera for the whole range, so that poses are comparable.
    let mut camera: Option<Camera> = None;
    for index in first..=last {
        let frame = match headless.frame(index, style) {
            Ok(frame) => frame,
            Err(error) => {
                if first != last {
                    warnings::warn_of_frame(&format!("{} is skipped: {error}", frame_with_index(index, count)));
                }
                failed.push((index, error.to_string()));
                continue;
            }
        };
        let camera = match &mut camera {
            Some(camera) => camera,
            none => none.insert(arguments.camera.camera(&look, &sequence, index, arguments.size_px())?),
        };
        if style.primitive == Primitive::Mesh && !frame.frame.has_faces() {
            let named = frame_with_index(index, count);
            warnings::warn_of_frame(&format!("{named} has no triangles: its points are drawn"));
        }
        let (composed, problems) = headless.compose(&frame, &options, style)?;
        let frame = composed.frame;
        for problem in problems {
            warnings::warn_of_frame(&problem);
        }
        let path = numbered(output, index, count);
        let picture = Picture {
            frame: &frame,
            camera,
            style,
            size: arguments.picture_size(),
        };
        if output.as_os_str() == STDOUT {
            write_png(headless, &picture, BytesAnswer, Path::new("stdout"))?;
            // Output of the encoder that remains in the buffer of stdout.
            note(std::io::stdout().lock().flush());
        } else {
            write_picture(headless, &picture, &path)?;
        }
        stats.frames.push(headless.stats(&frame));
    }
    Ok(failed)
}
