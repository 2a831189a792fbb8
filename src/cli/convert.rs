//! `pointreel convert`: frames in another format, moved, thinned out, with normals.

use super::arguments::{FrameRange, ReadArgs, open_sequence_and_tell};
use super::assumptions;
use super::output::answer;
use super::progress::Bar;
use super::reel_arguments::ReelArgs;
use super::reel_info::ReelInfo;
use super::warnings;
use crate::convert::{Conversion, Converted, Edit, Output, Shard, convert, join};
use crate::io::WriteFormat;
use crate::messages::frame_with_index;
use crate::progress::Progress;
use crate::reel::ReelFile;
use crate::sequence::Sequence;
use anyhow::bail;
use clap::Args;
use glam::DMat4;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `pointreel convert`.
#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// A folder, a pattern, or files; `demo:` and `example:lidar` are built in; the last one is the OUTPUT: a file for
    /// one frame, a sequence file (.reel) for all, else a folder, which is made
    #[arg(required = true, num_args = 2.., value_name = "INPUT… OUTPUT")]
    paths: Vec<PathBuf>,

    /// ply, ply-ascii, pcd, las, laz, xyz or npy [default: by the extension of OUTPUT, else ply]
    #[arg(long, value_name = "FORMAT")]
    format: Option<WriteFormat>,

    /// A frame, or a range A..B with both ends included; counted from 0
    #[arg(long, value_name = "N|A..B")]
    frames: Option<FrameRange>,

    /// Join the points in each cell of this edge, in file units
    #[arg(long, value_name = "SIZE", value_parser = edge)]
    voxel: Option<f64>,

    /// Move the points: a file with 16 numbers (4 x 4, row by row, as `CloudCompare` writes it), or the numbers with
    /// commas between
    #[arg(long, value_name = "MATRIX", value_parser = matrix, allow_hyphen_values = true)]
    transform: Option<DMat4>,

    /// Estimate normals and radii of frames that have no normals
    #[arg(long)]
    estimate_normals: bool,

    /// Convert the i-th of n shares of the frames, i from 1 to n: for several machines at once
    #[arg(long, value_name = "i/n", value_parser = shard)]
    shard: Option<Shard>,

    /// Convert frames anew that are in OUTPUT already
    #[arg(long)]
    overwrite: bool,

    /// Join sequence files, those of shards, into the OUTPUT, one behind the other
    #[arg(long, conflicts_with_all = ["format", "frames", "voxel", "transform", "estimate_normals", "shard"])]
    join: bool,

    #[command(flatten)]
    reel: ReelArgs,

    #[command(flatten)]
    read: ReadArgs,
}

pub(super) fn run(arguments: &ConvertArgs) -> anyhow::Result<()> {
    let Some((output, inputs)) = arguments.paths.split_last() else {
        bail!("name an input and an output");
    };
    if arguments.join {
        let count = join(inputs, output)?;
        answer(&format!("{count} frames joined into {}", output.display()));
        return Ok(());
    }
    let open = arguments.read.open_options();
    let sequence = open_sequence_and_tell(inputs, &open)?;
    let frames = arguments.frames.as_ref().map(FrameRange::bounds);
    let frame_count = frames.clone().map_or(sequence.len(), Iterator::count);
    let (output, format) = outputs(arguments, output, &sequence, frame_count)?;
    let conversion = Conversion {
        frames,
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        edit: Edit {
            transform: arguments.transform,
            voxel_edge: arguments.voxel,
            sample_count: open.read.sample_count,
            estimates_normals: arguments.estimate_normals,
        },
        format,
        output,
        overwrites: arguments.overwrite,
    };
    let bar = Arc::new(Bar::new(frame_count));
    let shown = Arc::clone(&bar);
    let progress = Progress::told_to(move |progress| shown.set(progress.done()));
    // An interrupt ends the process; what is finished stays, and the next run goes on from there.
    let converted = convert(&sequence, &conversion, &progress);
    bar.clear();
    assumptions::print_guesses(&sequence, None, &[]);
    tell(&converted?, &conversion, sequence.len())
}

/// Where frames go by the name of `output`, and in which format.
fn outputs(
    arguments: &ConvertArgs,
    output: &Path,
    sequence: &Sequence,
    frame_count: usize,
) -> anyhow::Result<(Output, WriteFormat)> {
    let has_extension = |extension: &str| {
        output
            .extension()
            .is_some_and(|found| found.eq_ignore_ascii_case(extension))
    };
    let format_by_name = WriteFormat::of_extension(output);
    let format = arguments.format.or(format_by_name).unwrap_or_default();
    if has_extension("reel") && !output.is_dir() {
        if let Some(format) = arguments.format {
            bail!("{} is a sequence file, which has no format {format}", output.display());
        }
        let (options, assumed) = arguments.reel.options(sequence);
        if let Some(assumed) = assumed {
            warnings::warn(&assumed);
        }
        return Ok((Output::Reel(output.to_owned(), options), format));
    }
    if arguments.reel.is_given() {
        bail!(
            "{} is no sequence file: name one that ends with .reel, or leave out what only such files have",
            output.display()
        );
    }
    let is_folder = output.is_dir() || format_by_name.is_none();
    if !is_folder && frame_count != 1 {
        bail!(
            "{} is one file, but {frame_count} frames are to be converted: name a folder, a sequence file (.reel), or \
             one frame with --frames",
            output.display()
        );
    }
    let output = if is_folder {
        Output::Folder(output.to_owned())
    } else {
        Output::File(output.to_owned())
    };
    Ok((output, format))
}

fn tell(converted: &Converted, conversion: &Conversion, count: usize) -> anyhow::Result<()> {
    let output = &conversion.output;
    if !converted.lost.is_empty() {
        let lost: Vec<&str> = converted.lost.iter().copied().collect();
        warnings::warn(&format!(
            "{} files have no place for these, which are lost: {}",
            conversion.format,
            lost.join(", ")
        ));
    }
    for (frame, warning) in &converted.warnings {
        warnings::warn_of_frame(&format!("{}: {warning}", frame_with_index(*frame, count)));
    }
    for (frame, error) in &converted.failed {
        warnings::warn_of_frame(&format!("{}: {error}", frame_with_index(*frame, count)));
    }
    let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = output;
    answer(&format!(
        "{} frames written to {}, {} were there already, {} failed",
        converted.written,
        path.display(),
        converted.left,
        converted.failed.len()
    ));
    if let (Output::Reel(path, _), false) = (output, converted.is_cancelled) {
        answer(&ReelInfo::of(&ReelFile::open_path(path)?).line());
    }
    match converted.failed.len() {
        0 => Ok(()),
        count => bail!("{count} frames could not be converted"),
    }
}

fn edge(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|edge: &f64| edge.is_finite() && *edge > 0.0)
        .ok_or_else(|| "expected a length above 0".to_owned())
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
    fn shares_are_counted_from_one() {
        assert_eq!(shard("1/1"), Ok(Shard::WHOLE));
        assert_eq!(shard("2/8"), Ok(Shard { index: 1, count: 8 }));
        for wrong in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2"] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
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
