//! `pointreel info`: contents of the frames of a sequence, in the coordinates of the files.

use crate::assumption::Assumption;
use crate::check::changed_attributes;
use crate::cli::info_parts::camera_info::CameraInfo;
use crate::cli::info_parts::photo_info::PhotoInfo;
use crate::cli::info_parts::reel_info::ReelInfo;
use crate::cli::options::arguments::ReadArgs;
use crate::cli::session::{OpenedInputs, SessionInfo, open_inputs_and_tell};
use crate::cli::terminal::output::answer;
use crate::cli::terminal::{assumptions, warnings};
use crate::cloud::ImageGrid;
use crate::scene::{BackFaces, CaptureKind, FirstLook, Primitive, Settings};
use crate::sequence::{Recording, Sequence};
use anyhow::{Context as _, bail};
use clap::Args;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Arguments of `pointreel info`.
#[derive(Debug, Args)]
pub(in crate::cli) struct InfoArgs {
    /// Folder, pattern or files; `demo:` and `example:lidar`, `depth` or `model` are built in
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

#[derive(Serialize)]
struct Info {
    /// Session information; only for a session.
    #[serde(skip_serializing_if = "Option::is_none")]
    session: Option<SessionInfo>,
    frames: Vec<FrameInfo>,
    origin: [f64; 3],
    /// At normal speed, for most of the time.
    fps: f64,
    /// Assumptions made on the user's behalf, by subject.
    assumptions: Vec<Assumption>,
    /// Guess of how the sequence is shown where nothing is chosen; absent where no frame has a point.
    #[serde(skip_serializing_if = "Option::is_none")]
    guess: Option<Guess>,
    /// Recording information; only for recordings.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    recordings: Vec<RecordingInfo>,
    /// Sequence file information; only for a sequence file.
    #[serde(skip_serializing_if = "Option::is_none")]
    reel: Option<ReelInfo>,
    /// Camera information; only for depth images.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cameras: Vec<CameraInfo>,
    /// Calibrated images; only for those.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    photographs: Vec<PhotoInfo>,
}

/// Initial appearance of the sequence in `view` and `render`, with the reasons.
#[derive(Serialize)]
struct Guess {
    up: &'static str,
    up_because: &'static str,
    from: &'static str,
    azimuth_deg: f64,
    elevation_deg: f64,
    kind: CaptureKind,
    primitive: Primitive,
    primitive_because: &'static str,
    planar_share: f32,
    spacing_spread: f32,
    back_faces: BackFaces,
    /// Bounds without outliers, in file coordinates.
    trimmed_min: [f64; 3],
    trimmed_max: [f64; 3],
}

#[derive(Serialize)]
struct RecordingInfo {
    file: String,
    /// Those with point clouds.
    topics: Vec<TopicInfo>,
}

#[derive(Serialize)]
struct TopicInfo {
    name: String,
    clouds: usize,
    /// True if its point clouds are the frames.
    read: bool,
}

#[derive(Serialize)]
struct FrameInfo {
    index: usize,
    file: String,
    /// The frame's own name: the file, and the part where it has several.
    name: String,
    /// The file with its normals, where they are in a separate one.
    #[serde(skip_serializing_if = "Option::is_none")]
    normals_file: Option<String>,
    /// By the time stamp of the file or its name.
    time_s: Option<f64>,
    /// Number of images that show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    photographs: Option<usize>,
    #[serde(flatten)]
    content: FrameReport,
}

#[derive(Serialize)]
#[serde(untagged)]
enum FrameReport {
    Read {
        points: usize,
        finite_points: usize,
        /// Null without a finite point.
        min: Option<[f64; 3]>,
        max: Option<[f64; 3]>,
        attributes: Vec<String>,
        /// Image grid; only for organised clouds.
        #[serde(skip_serializing_if = "Option::is_none")]
        grid: Option<ImageGrid>,
        /// Triangles of a mesh.
        faces: usize,
        /// Contents of the file that nothing uses.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        not_read: Vec<String>,
        /// Warnings about other parts of the file that could not be read.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        warnings: Vec<String>,
    },
    Failed {
        error: String,
    },
}

pub(in crate::cli) fn run(arguments: &InfoArgs) -> anyhow::Result<()> {
    let OpenedInputs { sequence, session } = open_inputs_and_tell(&arguments.inputs, &arguments.read.open_options())?;
    // Decodes the first frame, which is cached for its line.
    let origin = sequence.origin();
    // Rayon decodes as many frames at once as there are cores, and retains none.
    let frames: Vec<FrameInfo> = (0..sequence.len())
        .into_par_iter()
        .map(|index| frame_info(&sequence, index))
        .collect();
    let failures: Vec<&String> = frames
        .iter()
        .filter_map(|frame| match &frame.content {
            FrameReport::Failed { error } => Some(error),
            FrameReport::Read { .. } => None,
        })
        .collect();
    if let (true, Some(first)) = (failures.len() == frames.len(), failures.first()) {
        match failures.len() {
            1 => bail!("{first}"),
            count => bail!("none of the {count} frames can be read; the first: {first}"),
        }
    }
    for frame in &frames {
        let said = match &frame.content {
            FrameReport::Failed { error } => std::slice::from_ref(error),
            FrameReport::Read { warnings, .. } => warnings,
        };
        for warning in said {
            warnings::warn_of_frame(warning);
        }
    }
    let look = assumptions::first_look(&sequence);
    let info = Info {
        session: session.as_ref().map(SessionInfo::of),
        frames,
        assumptions: assumptions::of(&sequence, look.as_ref()),
        guess: look.map(|look| guess(&look, sequence.origin())),
        origin: origin.to_array(),
        fps: sequence.fps(),
        recordings: sequence.source().recordings().iter().map(recording_info).collect(),
        reel: sequence.source().reel().map(|file| ReelInfo::of(&file)),
        cameras: CameraInfo::of(&sequence),
        photographs: sequence
            .source()
            .posed_images(0)
            .map_or_else(Vec::new, |set| PhotoInfo::of(&set)),
    };
    if arguments.json {
        answer(&serde_json::to_string_pretty(&info).context("the answer cannot be written as JSON")?);
    } else {
        answer(table(&info).trim_end());
    }
    Ok(())
}

fn guess(look: &FirstLook, origin: DVec3) -> Guess {
    let in_file = |corner: Vec3| (origin + corner.as_dvec3()).to_array();
    let style = Settings::default().resolved(look);
    Guess {
        up: look.up.name(),
        up_because: look.up_why,
        from: look.from.why,
        azimuth_deg: look.from.azimuth_deg,
        elevation_deg: look.from.elevation_deg,
        kind: look.kind,
        primitive: style.primitive,
        primitive_because: look.primitive_why,
        planar_share: look.planar_share,
        spacing_spread: look.spacing_spread,
        back_faces: style.surfels.back_faces,
        trimmed_min: in_file(look.trimmed.min),
        trimmed_max: in_file(look.trimmed.max),
    }
}

fn recording_info(recording: &Recording) -> RecordingInfo {
    let topics = recording.topics.iter().map(|topic| TopicInfo {
        name: topic.name.clone(),
        clouds: topic.cloud_count,
        read: topic.is_read,
    });
    RecordingInfo {
        file: recording.path.display().to_string(),
        topics: topics.collect(),
    }
}

fn frame_info(sequence: &Sequence, index: usize) -> FrameInfo {
    let content = match sequence.take_decoded(index) {
        Ok(raw) => {
            let (finite_points, bounds) = raw.positions.finite_bounds();
            FrameReport::Read {
                points: raw.positions.len(),
                finite_points,
                min: bounds.map(|(min, _)| min.to_array()),
                max: bounds.map(|(_, max)| max.to_array()),
                attributes: raw.point_names(),
                grid: raw.grid,
                faces: raw.faces.len(),
                not_read: raw
                    .dropped
                    .into_iter()
                    .filter(|entry| entry.is_noted)
                    .map(|entry| entry.what)
                    .collect(),
                warnings: raw.warnings,
            }
        }
        Err(error) => FrameReport::Failed {
            error: error.to_string(),
        },
    };
    let entry = sequence.entry(index);
    let set = sequence.source().posed_images(index);
    FrameInfo {
        index,
        file: entry.path.display().to_string(),
        name: entry.name.clone(),
        normals_file: entry.normals.as_ref().map(|path| path.display().to_string()),
        time_s: entry.time.map(|time| time.as_secs_f64()),
        photographs: set.map(|set| set.photos.iter().filter(|photo| photo.has_file()).count()),
        content,
    }
}

/// Formats the answer as text: one line per frame, then facts about all of them.
fn table(info: &Info) -> String {
    let mut text = info.session.as_ref().map_or_else(String::new, SessionInfo::lines);
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{:>6} {:>10} {:>10}  {:<52} attributes, file",
        "index", "points", "finite", "bounds"
    );
    let lines = info.frames.iter().map(frame_line);
    let attributes = info.frames.iter().filter_map(|frame| match &frame.content {
        FrameReport::Read { attributes, .. } => Some((frame.index, attributes.as_slice())),
        FrameReport::Failed { .. } => None,
    });
    let findings = changed_attributes(attributes).into_iter();
    let lines = lines
        .chain(findings.map(|finding| finding.message))
        .chain(not_read_lines(&info.frames))
        .chain(info.recordings.iter().map(recording_line))
        .chain(info.reel.as_ref().map(ReelInfo::line))
        .chain(info.cameras.iter().map(CameraInfo::line))
        .chain(PhotoInfo::line(&info.photographs))
        .chain(info.guess.as_ref().map(guess_line))
        .chain(
            info.assumptions
                .iter()
                .map(|assumption| format!("assumed {assumption}")),
        )
        .chain(assumptions::options_elsewhere::<InfoArgs>(&info.assumptions));
    for line in lines {
        text.push_str(&line);
        text.push('\n');
    }
    let [x, y, z] = info.origin;
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{} frames, {:.3} a second, origin {x} {y} {z}",
        info.frames.len(),
        info.fps
    );
    text
}

fn frame_line(frame: &FrameInfo) -> String {
    match &frame.content {
        FrameReport::Read {
            points,
            finite_points,
            min,
            max,
            attributes,
            grid,
            faces,
            ..
        } => {
            let bounds = match (min, max) {
                (Some(min), Some(max)) => (0..3)
                    .map(|axis| format!("{}..{}", short(min[axis]), short(max[axis])))
                    .collect::<Vec<_>>()
                    .join(" "),
                _ => "none".to_owned(),
            };
            let grid = grid.map_or_else(String::new, |grid| format!(", organised {grid}"));
            let faces = match faces {
                0 => String::new(),
                faces => format!(" {faces} faces"),
            };
            format!(
                "{:>6} {points:>10} {finite_points:>10}  {bounds:<52} {}{faces}{grid}, {}",
                frame.index,
                attributes.join(" "),
                place(frame)
            )
        }
        FrameReport::Failed { error } => format!("{:>6} cannot be read: {error}", frame.index),
    }
}

/// Returns the contents of the files that nothing uses, each once.
fn not_read_lines(frames: &[FrameInfo]) -> Vec<String> {
    let of_frames = frames.iter().filter_map(|frame| match &frame.content {
        FrameReport::Read { not_read, .. } => Some(not_read),
        FrameReport::Failed { .. } => None,
    });
    let mut lines: Vec<String> = of_frames.flatten().cloned().collect();
    lines.sort_unstable();
    lines.dedup();
    lines
}

fn recording_line(recording: &RecordingInfo) -> String {
    let topics = recording.topics.iter().map(|topic| {
        let read = if topic.read { ", read" } else { "" };
        format!("{} ({} clouds{read})", topic.name, topic.clouds)
    });
    let topics: Vec<String> = topics.collect();
    format!("{}: topics {}", recording.file, topics.join(", "))
}

fn guess_line(guess: &Guess) -> String {
    format!(
        "shown as {}: {} is up ({}), seen {}; as {} ({})",
        guess.kind.name(),
        guess.up,
        guess.up_because,
        guess.from,
        plural(guess.primitive),
        guess.primitive_because
    )
}

fn plural(primitive: Primitive) -> String {
    match primitive {
        Primitive::Mesh => "a mesh".to_owned(),
        other => format!("{other}s"),
    }
}

/// The file, which part of it where it has several, and the file with its normals.
fn place(frame: &FrameInfo) -> String {
    match (frame.name.split_once(": "), &frame.normals_file) {
        (Some((_, part)), _) => format!("{}: {part}", frame.file),
        (None, Some(normals)) => format!("{} with {normals}", frame.file),
        (None, None) => frame.file.clone(),
    }
}

/// A coordinate with the number of digits that fit a column.
fn short(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e7) {
        format!("{value:.3e}")
    } else {
        format!("{value:.3}")
    }
}
