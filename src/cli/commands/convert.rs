//! `pointreel convert`: frames in another format, moved, subsampled, with normals.

use crate::analysis::SurfaceOptions;
use crate::assumption::Subject;
use crate::cli::info_parts::reel_info::ReelInfo;
use crate::cli::options::arguments::{ClipArgs, FrameRange, ReadArgs, open_sequence_and_tell};
use crate::cli::options::reel_arguments::ReelArgs;
use crate::cli::options::values::FrameChoice;
use crate::cli::terminal::output::{answer, say};
use crate::cli::terminal::progress::Bar;
use crate::cli::terminal::{assumptions, warnings};
use crate::convert::{Conversion, Converted, Edit, MergePrice, Output, Shard, convert, join, parts_of};
use crate::io::WriteFormat;
use crate::messages::frame_with_index;
use crate::progress::Progress;
use crate::reel::ReelFile;
use crate::scene::describe::{Described, Value};
use crate::scene::{EstimationStyle, NormalFit};
use crate::sequence::Sequence;
use crate::{regular_file, signals};
use anyhow::bail;
use clap::Args;
use glam::DMat4;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `pointreel convert`.
#[derive(Debug, Args)]
pub(in crate::cli) struct ConvertArgs {
    /// Folder, pattern or files, and the OUTPUT as the last one: a file for one frame, a sequence file (.reel) for all,
    /// or a folder (a name without extension or with a slash at its end), in which files keep their names
    #[arg(required = true, num_args = 1.., value_name = "INPUT… OUTPUT")]
    paths: Vec<PathBuf>,

    /// Output format: ply, ply-ascii, pcd, las, laz, xyz or npy [default: by the extension of OUTPUT, else ply]
    #[arg(long, value_name = "FORMAT")]
    format: Option<WriteFormat>,

    /// Frame or inclusive range A..B, counted from 0; last or -1 is the last one [default: all]
    #[arg(long, value_name = "N|A..B", allow_hyphen_values = true)]
    frames: Option<FrameChoice>,

    #[command(flatten)]
    clip: ClipArgs,

    /// Voxel-downsample with this voxel size (file units)
    #[arg(long, value_name = "SIZE", value_parser = edge)]
    voxel: Option<f64>,

    /// Transform the points: a file with a 4 x 4 matrix (row by row, as `CloudCompare` writes it), or its 16 numbers
    /// separated by commas
    #[arg(long, value_name = "MATRIX", value_parser = matrix, allow_hyphen_values = true)]
    transform: Option<DMat4>,

    /// Estimate missing normals and radii
    #[arg(long)]
    estimate_normals: bool,

    /// Neighbours that normals are estimated from (auto: 12, and more where the points are noisy)
    #[arg(long, value_name = "auto|N", value_parser = neighbours, requires = "estimate_normals")]
    normals_k: Option<NeighbourCount>,

    /// Fit of estimated normals to neighbours: plain, or robust against outliers [default: plain]
    #[arg(long, value_name = "plain|robust", requires = "estimate_normals")]
    fit: Option<NormalFit>,

    /// Move the points onto the surface around them, from neighbours within RADIUS point spacings, such as 3 (moving
    /// least squares)
    #[arg(long, value_name = "RADIUS", value_parser = radius)]
    smooth: Option<f32>,

    /// Convert shard i of n (i from 1), for several machines at once; of a sequence file `walk.reel` it is written to
    /// `walk.part-i-of-n.reel`
    #[arg(long, hide_short_help = true, value_name = "i/n", value_parser = shard)]
    shard: Option<Shard>,

    /// Replace existing files in OUTPUT; without it, frames that this conversion has already written are skipped, and
    /// any other existing file is an error
    #[arg(long)]
    overwrite: bool,

    /// Concatenate sequence files, such as shards, into OUTPUT; without an INPUT, the parts next to OUTPUT
    #[arg(
        long,
        hide_short_help = true,
        conflicts_with_all = [
            "format",
            "frames",
            "clip_box",
            "voxel",
            "transform",
            "estimate_normals",
            "smooth",
            "shard",
        ],
    )]
    join: bool,

    #[command(flatten)]
    reel: ReelArgs,

    #[command(flatten)]
    read: ReadArgs,
}

/// Number of neighbours of a normal; `None` if that is chosen by the noise.
#[derive(Debug, Clone, Copy)]
struct NeighbourCount(Option<u16>);

impl ConvertArgs {
    fn surface(&self) -> SurfaceOptions {
        EstimationStyle {
            neighbours: self.normals_k.and_then(|count| count.0).map_or(0.0, f32::from),
            fit: self.fit.unwrap_or(NormalFit::Plain),
            ..EstimationStyle::default()
        }
        .surface()
    }
}

pub(in crate::cli) fn run(arguments: &ConvertArgs) -> anyhow::Result<()> {
    let Some((output, inputs)) = arguments.paths.split_last() else {
        bail!("name an input and an output");
    };
    if arguments.join {
        return run_join(inputs, output, arguments.overwrite);
    }
    if inputs.is_empty() {
        bail!("name an input and an output");
    }
    let open = arguments.read.open_options();
    let sequence = open_sequence_and_tell(inputs, &open)?;
    let frames = arguments.frames.map(|frames| frames.of("--frames", sequence.len()));
    let frames = frames.transpose()?.map(FrameRange::bounds);
    let frame_count = frames.clone().map_or(sequence.len(), Iterator::count);
    let (output, format) = outputs(arguments, output, &sequence, frame_count)?;
    let (goal, assumed) = arguments.reel.goal(&sequence);
    if let Some(assumed) = assumed {
        warnings::warn(&assumed);
    }
    let conversion = Conversion {
        frames,
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        edit: Edit {
            crop: arguments.clip.clip(),
            transform: arguments.transform,
            voxel_edge: arguments.voxel,
            sample_count: open.read.sample_count,
            smoothing: arguments.smooth,
            estimates_normals: arguments.estimate_normals,
            surface: arguments.surface(),
        },
        format,
        output,
        goal,
        overwrites: arguments.overwrite,
        reading: arguments.read.in_words(),
    };
    match MergePrice::of(&conversion, &sequence) {
        // Immediately: the user should know before anything is written.
        Ok(price) => price.iter().for_each(|price| say(&format!("warning: {price}"))),
        Err(error) => warnings::warn(&format!("what merging costs cannot be estimated: {error}")),
    }
    let bar = Arc::new(Bar::new(frame_count));
    let shown = Arc::clone(&bar);
    let progress = Progress::told_to(move |progress| shown.set(progress.done()));
    let cancelled = progress.clone();
    // Frames that are being written are completed first.
    let ends_well = signals::on_first(move || cancelled.cancel(), None);
    let converted = convert(&sequence, &conversion, &progress);
    drop(ends_well);
    bar.clear();
    // Single-frame files have no frame rate.
    let rate_is_retained = matches!(conversion.output, Output::Reel(..));
    let untouched: &[Subject] = if rate_is_retained { &[] } else { &[Subject::FrameTimes] };
    assumptions::print_guesses(&sequence, None, untouched);
    tell(&converted?, &conversion, sequence.len())
}

/// Parts must not be replaced by the file that they become, nor another file in silence.
fn check_joined(parts: &[PathBuf], output: &Path, overwrites: bool) -> anyhow::Result<()> {
    if !output.exists() {
        return Ok(());
    }
    if parts.iter().any(|part| regular_file::are_same(part, output)) {
        bail!(
            "the output {} is one of the parts: choose another name",
            output.display()
        );
    }
    if !overwrites {
        bail!(
            "{} is there already: choose another name, or --overwrite to replace it",
            output.display()
        );
    }
    Ok(())
}

fn run_join(inputs: &[PathBuf], output: &Path, overwrites: bool) -> anyhow::Result<()> {
    let found;
    let parts = if inputs.is_empty() {
        found = parts_of(output)?;
        &found
    } else {
        inputs
    };
    check_joined(parts, output, overwrites)?;
    let joined = join(parts, output)?;
    joined.notes.iter().for_each(|note| warnings::warn(note));
    let (frames, output) = (joined.frames, output.display());
    answer(&format!(
        "{frames} frames of {} files joined into {output}",
        parts.len()
    ));
    Ok(())
}

/// Returns the output paths of frames according to the name of `output`, and their format.
fn outputs(
    arguments: &ConvertArgs,
    output: &Path,
    sequence: &Sequence,
    frame_count: usize,
) -> anyhow::Result<(Output, WriteFormat)> {
    let place = NamedPlace::of(output, arguments.format)?;
    if let NamedPlace::Reel = place {
        if let Some(format) = arguments.format {
            bail!("{} is a sequence file, which has no format {format}", output.display());
        }
        let (options, assumed) = arguments.reel.options(sequence);
        if let Some(assumed) = assumed {
            warnings::warn(&assumed);
        }
        let part = arguments.shard.unwrap_or(Shard::WHOLE).part_of(output);
        return Ok((Output::Reel(part, options), WriteFormat::default()));
    }
    if arguments.reel.is_given() {
        bail!(
            "{} is not a sequence file: choose a name that ends in .reel, or omit the options for such files",
            output.display()
        );
    }
    match place {
        NamedPlace::File(_) if frame_count != 1 => bail!(
            "{} is one file, but {frame_count} frames are to be converted: name a folder, a sequence file (.reel), or \
             one frame with --frames",
            output.display()
        ),
        NamedPlace::File(format) => Ok((Output::File(output.to_owned()), format)),
        NamedPlace::Folder | NamedPlace::Reel => {
            let format = arguments.format.unwrap_or_default();
            Ok((Output::Folder(output.to_owned()), format))
        }
    }
}

/// The kind of output that a name means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NamedPlace {
    Reel,
    File(WriteFormat),
    Folder,
}

impl NamedPlace {
    /// The target by the extension of `output`. A folder exists already, or has no extension or a trailing slash. An
    /// extension of no written format, or of another one than `format`, is refused: names match contents.
    fn of(output: &Path, format: Option<WriteFormat>) -> anyhow::Result<Self> {
        let text = output.to_string_lossy();
        if text == "-" {
            bail!(
                "- is the standard output, which frames are not written to: name a file or a folder (./- if it is one)"
            );
        }
        let has_slash = text.ends_with(std::path::is_separator);
        let extension = output
            .extension()
            .map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let Some(extension) = extension.filter(|_| !output.is_dir() && !has_slash) else {
            if output.is_file() {
                bail!("{text} is an existing file, expected a folder: choose another name");
            }
            return Ok(Self::Folder);
        };
        if extension == "reel" {
            return Ok(Self::Reel);
        }
        // COPC is LAZ with an octree, which readers would miss.
        if text.to_ascii_lowercase().ends_with(".copc.laz") {
            bail!(
                "{text}: COPC files (.copc.laz) are not written. The formats of files are {}, and .reel for a sequence \
                 file",
                WriteFormat::names()
            );
        }
        let Some(by_name) = WriteFormat::of_extension(output) else {
            bail!(
                "{text}: .{extension} files are not written. The formats of files are {}, and .reel for a sequence \
                 file; \
                 for a folder of that name add a slash: {text}/",
                WriteFormat::names()
            );
        };
        match format {
            Some(format) if format.extension() != by_name.extension() => bail!(
                "{text} is named as {by_name}, but --format says {format}: name it .{}, or omit --format",
                format.extension()
            ),
            format => Ok(Self::File(format.unwrap_or(by_name))),
        }
    }
}

fn tell(converted: &Converted, conversion: &Conversion, count: usize) -> anyhow::Result<()> {
    for (frame, warning) in &converted.warnings {
        warnings::warn_of_frame(&format!("{}: {warning}", frame_with_index(*frame, count)));
    }
    for (frame, error) in &converted.failed {
        warnings::warn_of_frame(&format!("{}: {error}", frame_with_index(*frame, count)));
    }
    for note in &converted.notes {
        warnings::warn(note);
    }
    for loss in converted.losses.lines(&conversion.target_name(), converted.written) {
        warnings::lost(&loss);
    }
    let output = &conversion.output;
    let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = output;
    answer(&format!(
        "{} frames written to {}, {} were there already, {} failed",
        converted.written,
        path.display(),
        converted.left,
        converted.failed.len()
    ));
    if converted.is_cancelled {
        if conversion.overwrites {
            bail!("the conversion was interrupted: with --overwrite the same command begins again");
        }
        bail!("the conversion was interrupted: the same command goes on with the frames that are missing");
    }
    if let Output::Reel(path, _) = output
        && converted.written + converted.left > 0
    {
        let written = ReelFile::open_path(path)?;
        for damage in written.damage() {
            warnings::warn(damage);
        }
        answer(&ReelInfo::of(&written).line());
    }
    match converted.failed.len() {
        0 => Ok(()),
        failed => bail!("{failed} frames could not be converted"),
    }
}

fn edge(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|edge: &f64| edge.is_finite() && *edge > 0.0)
        .ok_or_else(|| "expected a length above 0".to_owned())
}

/// A number as the settings take it.
fn number(described: &Described, text: &str) -> Result<f64, String> {
    match described.parse(text)?.first() {
        Some(&(_, Value::Number(number))) => Ok(number),
        _ => Err("expected a number".to_owned()),
    }
}

fn neighbours(text: &str) -> Result<NeighbourCount, String> {
    let count = number(&EstimationStyle::NEIGHBOURS, text)?;
    Ok(NeighbourCount((count > 0.0).then_some(count as u16)))
}

fn radius(text: &str) -> Result<f32, String> {
    let radius = number(&EstimationStyle::SMOOTHING, text)? as f32;
    Some(radius)
        .filter(|&radius| radius > 0.0)
        .ok_or_else(|| "expected a number of point spacings from 1 to 6".to_owned())
}

/// `2/8` is the second of eight shares.
fn shard(text: &str) -> Result<Shard, String> {
    let parse = || {
        let (place, count) = text.split_once('/')?;
        let (place, count): (usize, usize) = (place.parse().ok()?, count.parse().ok()?);
        let index = place.checked_sub(1)?;
        (index < count).then_some(Shard { index, count })
    };
    parse().ok_or_else(|| "expected i/n with i from 1 to n, such as 2/8".to_owned())
}

/// 16 numbers, row by row, or 12 without the last row; or the name of a file with them.
fn matrix(text: &str) -> Result<DMat4, String> {
    let from_file;
    let numbers = if Path::new(text).is_file() {
        let read = std::fs::read_to_string(text);
        from_file = read.map_err(|reason| format!("{text} cannot be read ({reason})"))?;
        from_file.as_str()
    } else {
        text
    };
    let numbers: Option<Vec<f64>> = numbers
        .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    let mut rows = numbers.filter(|numbers| [12, 16].contains(&numbers.len()));
    if let Some(rows) = rows.as_mut()
        && rows.len() == 12
    {
        rows.extend([0.0, 0.0, 0.0, 1.0]);
    }
    rows.and_then(|rows| <[f64; 16]>::try_from(rows).ok())
        .filter(|rows| rows[12..] == [0.0, 0.0, 0.0, 1.0])
        .map(|rows| DMat4::from_cols_array(&rows).transpose())
        .ok_or_else(|| "expected 16 numbers row by row, the last four 0 0 0 1, or a file with them".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!(shard("1/1"), Ok(Shard::WHOLE));
        assert_eq!(shard("2/8"), Ok(Shard { index: 1, count: 8 }));
        for wrong in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2"] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_output_name_selects_a_file_format_or_a_folder() {
        let of = |name: &str, format: Option<&str>| {
            NamedPlace::of(Path::new(name), format.map(|format| format.parse().unwrap()))
        };
        let file = |name: &str| NamedPlace::File(name.parse().unwrap());
        for (name, format, expected) in [
            ("a.ply", None, file("ply")),
            ("a.PLY", Some("ply-ascii"), file("ply-ascii")),
            ("a.laz", None, file("laz")),
            ("a.Reel", None, NamedPlace::Reel),
            ("a", None, NamedPlace::Folder),
            ("a.glb/", None, NamedPlace::Folder),
            ("out.v2/", Some("pcd"), NamedPlace::Folder),
            ("/tmp", None, NamedPlace::Folder),
        ] {
            assert_eq!(of(name, format).unwrap(), expected, "{name}");
        }
        for name in [
            "g.copc.laz",
            "g.glb",
            "g.usd",
            "g.obj",
            "g.npz",
            "g.csv",
            "g.e57",
            "g.png",
            "g.v2",
            "g.ply.gz",
            "g.xyz~",
        ] {
            let refused = of(name, None).unwrap_err().to_string();
            assert!(refused.contains("ply, ply-ascii, pcd, las, laz, xyz, npy"), "{refused}");
            assert!(of(name, Some("ply")).is_err(), "{name}");
        }
        assert!(of("-", None).unwrap_err().to_string().contains("standard output"));
        assert!(of("a.ply", Some("pcd")).unwrap_err().to_string().contains(".pcd"));
    }

    #[test]
    fn matrices_are_read_row_by_row() {
        let moved = matrix("1,0,0,10, 0,1,0,20, 0,0,1,30, 0,0,0,1").unwrap();
        assert_eq!(moved.transform_point3(DVec3::ZERO), DVec3::new(10.0, 20.0, 30.0));
        let short = matrix("0 -1 0 0\n1 0 0 0\n0 0 1 0").unwrap();
        assert_eq!(short.transform_point3(DVec3::X), DVec3::Y);
        for wrong in ["", "1 2 3", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1", "nowhere.txt"] {
            assert!(matrix(wrong).is_err(), "{wrong}");
        }
    }
}
