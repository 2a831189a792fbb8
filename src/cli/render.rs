//! `pointreel render`: frames to PNG files, with the code that draws the window.

use super::arguments::{CameraArgs, FrameRange, PictureArgs, ReadArgs, open_sequence, size_px};
use super::say;
use crate::headless::{Headless, PictureStats};
use crate::render::AnyRenderer;
use crate::scene::{Camera, Settings};
use crate::sequence::{Loader, LoaderOptions, Sequence};
use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where the number of the frame goes in the name of the output.
const FRAME_PLACEHOLDER: &str = "{frame}";

/// Arguments of `pointreel render`.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// A folder, a pattern, or files; `demo:` is the built-in sequence
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// PNG file to write; with a range of frames its name must contain {frame}
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,

    /// A frame, or a range A..B with both ends included; counted from 0
    #[arg(long, value_name = "N|A..B", default_value = "0")]
    frame: FrameRange,

    /// Picture size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size_px)]
    size: [u32; 2],

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    picture: PictureArgs,

    #[command(flatten)]
    camera: CameraArgs,

    /// JSON file to write counters and times to
    #[arg(long, value_name = "STATS.json")]
    stats: Option<PathBuf>,
}

#[derive(Serialize)]
struct Stats {
    adapter: String,
    size: [u32; 2],
    primitive: String,
    splatting: String,
    instancing: String,
    frames: Vec<PictureStats>,
}

pub(super) fn run(arguments: &RenderArgs) -> anyhow::Result<()> {
    let FrameRange { first, last } = arguments.frame;
    let names_frames = arguments
        .output
        .to_string_lossy()
        .contains(FRAME_PLACEHOLDER);
    if first != last && !names_frames {
        bail!(
            "frames {first}..{last} would all be written to {}: put {FRAME_PLACEHOLDER} into its name",
            arguments.output.display()
        );
    }
    let sequence = Arc::new(open_sequence(
        &arguments.inputs,
        &arguments.read.picture_options(),
    )?);
    if last >= sequence.len() {
        bail!(
            "there is no frame {last}: the sequence has {} frames, counted from 0",
            sequence.len()
        );
    }
    let settings = arguments.picture.settings_over(Settings::default());
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default())?;
    let renderer = AnyRenderer::open(settings.renderer)?;
    let mut headless = Headless::new(Arc::clone(&sequence), loader, renderer);
    let mut stats = Stats {
        adapter: headless.renderer().summary(),
        size: arguments.size,
        primitive: settings.primitive.to_string(),
        splatting: settings.splatting.to_string(),
        instancing: settings.strategy.to_string(),
        frames: Vec::new(),
    };
    let failed = render_frames(arguments, &sequence, &settings, &mut headless, &mut stats)?;
    if let Some(path) = &arguments.stats {
        let json = serde_json::to_string_pretty(&stats)
            .context("the statistics cannot be written as JSON")?;
        std::fs::write(path, json)
            .with_context(|| format!("{} cannot be written", path.display()))?;
    }
    match failed.as_slice() {
        [] => Ok(()),
        [(_, error)] if first == last => bail!("{error}"),
        failed => bail!(
            "{} of {} frames could not be rendered",
            failed.len(),
            last - first + 1
        ),
    }
}

/// Renders every frame that can be; returns those that cannot, with the reason.
fn render_frames(
    arguments: &RenderArgs,
    sequence: &Sequence,
    settings: &Settings,
    headless: &mut Headless,
    stats: &mut Stats,
) -> anyhow::Result<Vec<(usize, String)>> {
    let FrameRange { first, last } = arguments.frame;
    let mut failed = Vec::new();
    // One camera for the whole range: poses stay comparable.
    let mut camera: Option<Camera> = None;
    for index in first..=last {
        let frame = match headless.frame(index, settings) {
            Ok(frame) => frame,
            Err(error) => {
                if first != last {
                    say(&format!("warning: frame {index} is skipped: {error}"));
                }
                failed.push((index, error.to_string()));
                continue;
            }
        };
        let camera =
            camera.get_or_insert_with(|| arguments.camera.choice().camera(&frame, sequence));
        let image = headless.draw(&frame, camera, settings, arguments.size)?;
        let path = output_path(&arguments.output, index, sequence.len());
        image
            .save_with_format(&path, image::ImageFormat::Png)
            .with_context(|| format!("{} cannot be written", path.display()))?;
        stats.frames.push(headless.stats(&frame));
    }
    Ok(failed)
}

/// The output's name with `{frame}` replaced by the number, padded so that names sort.
fn output_path(output: &Path, index: usize, frame_count: usize) -> PathBuf {
    let digits = frame_count.saturating_sub(1).to_string().len().max(4);
    PathBuf::from(
        output
            .to_string_lossy()
            .replace(FRAME_PLACEHOLDER, &format!("{index:0digits$}")),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_outputs_sort() {
        assert_eq!(
            output_path(Path::new("o/{frame}.png"), 7, 24),
            Path::new("o/0007.png")
        );
        assert_eq!(
            output_path(Path::new("{frame}.png"), 7, 100_000),
            Path::new("00007.png")
        );
        assert_eq!(
            output_path(Path::new("one.png"), 7, 24),
            Path::new("one.png")
        );
    }
}
