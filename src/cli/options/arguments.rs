//! Arguments shared by several subcommands.

use super::colors::ColorArgs;
use super::known_values::KnownValues;
use super::rgbd_arguments::RgbdArgs;
use super::style_arguments::{StyleArgs, with_default};
use super::values::number_in;
pub(in crate::cli) use super::values::{FrameRange, positive_f64};
use crate::cli::session::open_inputs_and_tell;
use crate::cloud::{ColorDepth, NoData};
use crate::io::{ColumnMap, ReadOptions};
use crate::render::matcher_of_machine;
use crate::rgbd::Filters;
use crate::scene::{BackFaces, Backdrop, Background, Clip, ClipShape, ParseChoiceError, Settings, SurfelSettings};
use crate::sequence::{ColorSource, OpenOptions, Sequence};
use crate::source::SessionReach;
use clap::{Args, ValueEnum};
use glam::DVec3;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

/// Headings of the help.
pub(in crate::cli) const VIEW: &str = "View";

/// Opens the inputs that the user named, or a session, and warns of skipped files; without inputs, the built-in
/// sequence.
pub(in crate::cli) fn open_sequence_and_tell(inputs: &[PathBuf], options: &OpenOptions) -> anyhow::Result<Sequence> {
    open_inputs_and_tell(inputs, options).map(|opened| opened.sequence)
}

/// Options for reading files.
#[derive(Debug, Clone, Default, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[command(next_help_heading = "Reading")]
pub(in crate::cli) struct ReadArgs {
    /// Limit the memory for reading one frame, such as 2GB [default: half of all]
    #[arg(long, value_name = "SIZE", value_parser = byte_count, hide_short_help = true)]
    max_memory: Option<u64>,

    /// Sample N points uniformly on meshes; of clouds, take N at most [default: 100000 on meshes that are shown]
    #[arg(long, value_name = "N")]
    sample: Option<NonZeroUsize>,

    /// Columns of text and .bin files by number or name, such as x=3,y=4,z=5,intensity=7; counted from 0, of .bin files
    /// also their count, such as 7 or 7:x=0,y=1,z=2; frame=2 for a column of frames, frame=none for one frame
    /// [default: by names and values]
    #[arg(long, value_name = "COLUMNS")]
    columns: Option<ColumnMap>,

    /// Ignore points with this value: auto (constants such as 0 0 0 or -9999 far from the rest), none, a number that
    /// stands for a missing coordinate, or the position of missing points, such as -1,-1,-1
    #[arg(
        long,
        value_name = "VALUE|X,Y,Z|auto|none",
        default_value_t = NoData::Auto,
        allow_hyphen_values = true,
        hide_short_help = true
    )]
    no_data: NoData,

    /// Range of ambiguous colours: unit (0 to 1), 8 (0 to 255) or 16 (0 to 65535), or more if there are larger values
    /// [default: by the values of all frames]
    #[arg(long, value_name = "unit|8|16", hide_short_help = true)]
    color_depth: Option<ColorDepth>,

    /// Merge the scans of an E57 file into one frame instead of one frame per scan
    #[arg(long, hide_short_help = true)]
    merge_scans: bool,

    /// Read this topic of a recording (MCAP, ROS bag); `pointreel info` lists them
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    topic: Option<String>,

    /// Read only the files of a folder that match, such as 'body_*'
    #[arg(long, value_name = "PATTERN", hide_short_help = true)]
    only: Option<String>,

    /// Limit the bandwidth for a remote sequence file (http://), in Mbit/s
    #[arg(long, value_name = "MBIT", value_parser = positive_f64, hide_short_help = true)]
    bandwidth: Option<f64>,

    /// Reconstruct a dense cloud from posed images by stereo, even if they have a sparse one
    #[arg(long, hide_short_help = true)]
    dense: bool,

    /// Seconds of live stream (tcp://) to keep for rewinding [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = positive_f64, hide_short_help = true)]
    live_seconds: Option<f64>,

    /// Request whole frames from a live stream (tcp://), or only the surfels that the window shows
    #[arg(long, value_name = "frames|surfels", value_enum, default_value_t = StreamOf::Frames, hide_short_help = true)]
    stream: StreamOf,

    /// Allow a session (.pointreel) to connect to the addresses that it names, and to listen on its ports
    #[arg(long, hide_short_help = true)]
    allow_network: bool,

    /// Allow a session (.pointreel) to open files outside its own folder
    #[arg(long, hide_short_help = true)]
    allow_outside: bool,

    #[command(flatten)]
    rgbd: RgbdArgs,
}

/// Content requested from a live stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum StreamOf {
    /// All of each frame.
    #[default]
    Frames,
    /// Surfels of what the window shows of it.
    Surfels,
}

/// Default number of points on the surface of a mesh for images.
const MESH_POINTS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(99_999);

impl ReadArgs {
    /// [`Self::open_options`] for images: meshes are shown by their surface, depth images are filtered.
    pub(in crate::cli) fn picture_options(&self) -> OpenOptions {
        let options = self.open_options();
        OpenOptions {
            read: options.read.with_mesh_sample_count(Some(MESH_POINTS)),
            rgbd: self.rgbd.options(Filters::USUAL),
            ..options
        }
    }

    /// The options that change the content of frames, as they are typed; empty where none is given.
    pub(in crate::cli) fn in_words(&self) -> String {
        let mut words: Vec<String> = Vec::new();
        let mut add = |option: &str, value: Option<String>| {
            words.extend(value.map(|value| format!("--{option} {value}").trim_end().to_owned()));
        };
        let given = |is_given: bool| is_given.then(String::new);
        add("columns", self.columns.map(|columns| columns.to_string()));
        let no_data = self.no_data.to_string();
        add(
            "no-data",
            Some(no_data).filter(|no_data| *no_data != NoData::Auto.to_string()),
        );
        add("color-depth", self.color_depth.map(|depth| depth.to_string()));
        add("merge-scans", given(self.merge_scans));
        add("dense", given(self.dense));
        words.extend(self.rgbd.in_words());
        words.join(" ")
    }

    pub(in crate::cli) fn open_options(&self) -> OpenOptions {
        let default = ReadOptions::default();
        let max_memory_bytes = self.max_memory.unwrap_or(default.max_memory_bytes);
        OpenOptions {
            read: default
                .with_max_memory(max_memory_bytes)
                .with_sample_count(self.sample)
                .with_columns(self.columns),
            no_data: self.no_data,
            color_depth: self.color_depth,
            fps: None,
            merge_scans: self.merge_scans,
            topic: self.topic.as_deref().map(Arc::from),
            only: self.only.as_deref().map(Arc::from),
            waits_for_first: false,
            max_bits_per_s: self.bandwidth.map(|mbit| 1e6 * mbit),
            dense: self.dense,
            live_seconds: self.live_seconds,
            live_surfels: self.stream == StreamOf::Surfels,
            rgbd: self.rgbd.options(Filters::NONE),
            matcher: matcher_of_machine(),
            session_reach: SessionReach {
                network: self.allow_network,
                outside: self.allow_outside,
            },
        }
    }
}

/// Appearance of an image; options not given keep their defaults: in a window as it was left, else as in a new one.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Rendering")]
pub(in crate::cli) struct PictureArgs {
    #[command(flatten)]
    style: StyleArgs,

    #[arg(
        long,
        alias = "bg",
        value_name = Backdrop::BACKGROUND.value_name,
        help = with_default(Backdrop::BACKGROUND.help, Some(Background::PRESETS[0].0)),
        value_parser = KnownValues::<Behind>::of(backgrounds()),
    )]
    background: Option<Behind>,

    /// Short for --back-faces drawn
    #[arg(long, conflicts_with = SurfelSettings::BACK_FACES.flag, hide_short_help = true)]
    two_sided: bool,

    #[command(flatten)]
    clip: ClipArgs,

    #[command(flatten)]
    colors: ColorArgs,
}

/// Options for a part of the space.
#[derive(Debug, Clone, Default, Args)]
pub(in crate::cli) struct ClipArgs {
    /// Crop to a bounding box: minimum and maximum, in file coordinates
    #[arg(long, alias = "crop", value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true, value_parser = clip_box)]
    clip_box: Option<ClipShape>,

    /// Keep the points outside --clip-box instead
    #[arg(long, requires = "clip_box", hide_short_help = true)]
    clip_outside: bool,
}

impl ClipArgs {
    /// The clip that is asked for.
    pub(in crate::cli) fn clip(&self) -> Option<Clip> {
        self.clip_box.map(|shape| Clip {
            keeps_outside: self.clip_outside,
            ..Clip::to(shape)
        })
    }
}

/// Background behind the cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Behind {
    Colors(Background),
    /// The image is transparent there.
    Nothing,
}

/// The words for a background.
fn backgrounds() -> impl Iterator<Item = &'static str> {
    let presets = Background::PRESETS.iter().map(|(word, ..)| *word);
    presets.chain(["transparent"])
}

impl FromStr for Behind {
    type Err = ParseChoiceError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "transparent" => Ok(Self::Nothing),
            _ => text.parse().map(Self::Colors),
        }
    }
}

impl PictureArgs {
    /// Returns true if the background behind the cloud is to be transparent.
    pub(in crate::cli) fn is_transparent(&self) -> bool {
        self.background == Some(Behind::Nothing)
    }

    /// The source of colours that was named.
    pub(in crate::cli) fn color_source(&self) -> Option<ColorSource> {
        self.colors.source()
    }

    /// `default`, except for given options.
    pub(in crate::cli) fn style_over(&self, default: Settings) -> Settings {
        let mut style = self.style.over(default);
        style.colors = self.colors.over(default.colors);
        if self.two_sided {
            style.surfels.back_faces = BackFaces::Drawn.into();
        }
        if let Some(Behind::Colors(background)) = self.background {
            style.backdrop.background = background;
        }
        style.clip = self.clip.clip().or(style.clip);
        style
    }
}

/// `WxH` in pixels.
pub(in crate::cli) fn size_px(text: &str) -> Result<[u32; 2], String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        let size = [width.parse().ok()?, height.parse().ok()?];
        size.iter().all(|&edge: &u32| edge > 0).then_some(size)
    };
    parse().ok_or_else(|| "expected WIDTHxHEIGHT in pixels, such as 1280x720".to_owned())
}

pub(in crate::cli) fn finite(text: &str) -> Result<f64, String> {
    number_in(text, |value: &f64| value.is_finite(), "degrees")
}

pub(super) fn elevation(text: &str) -> Result<f64, String> {
    number_in(text, |value| (-90.0..=90.0).contains(value), "degrees from -90 to 90")
}

pub(super) fn field_of_view(text: &str) -> Result<f64, String> {
    number_in(text, |value| (1.0..=170.0).contains(value), "degrees from 1 to 170")
}

fn clip_box(text: &str) -> Result<ClipShape, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let corners = numbers.and_then(|numbers| <[f64; 6]>::try_from(numbers).ok());
    corners
        .map(|[a, b, c, d, e, f]| (DVec3::new(a, b, c), DVec3::new(d, e, f)))
        .filter(|(min, max)| min.is_finite() && max.is_finite() && min.cmple(*max).all())
        .map(|(min, max)| ClipShape::Box { min, max })
        .ok_or_else(|| {
            "expected six numbers, the smallest x,y,z and then the largest, such as 0,0,0,1.5,2,1".to_owned()
        })
}

/// Parses a frame rate that a clock accepts, in frames per second.
pub(in crate::cli) fn frame_rate(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|fps| (0.1..=1000.0).contains(fps))
        .ok_or_else(|| "expected frames per second, from 0.1 to 1000".to_owned())
}

/// `1500000000`, `1.5GB` (10⁹) or `2GiB` (2³⁰).
pub(in crate::cli) fn byte_count(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 8] = [
        ("kib", 1024.0),
        ("mib", 1_048_576.0),
        ("gib", 1_073_741_824.0),
        ("kb", 1e3),
        ("mb", 1e6),
        ("gb", 1e9),
        ("b", 1.0),
        ("", 1.0),
    ];
    let lower = text.trim().to_ascii_lowercase();
    let parsed = UNITS.iter().find_map(|(unit, factor)| {
        let number: f64 = lower.strip_suffix(unit)?.trim().parse().ok()?;
        (number > 0.0 && number * factor < u64::MAX as f64).then_some((number * factor) as u64)
    });
    parsed.ok_or_else(|| "expected a size such as 2GB, 512MiB or 1500000000".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_bounded() {
        assert_eq!(frame_rate("29.97"), Ok(29.97));
        for wrong in ["0", "-3", "1001", "nan", "fast"] {
            assert!(frame_rate(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_read_with_their_units() {
        assert_eq!(byte_count("1500"), Ok(1500));
        assert_eq!(byte_count("2GB"), Ok(2_000_000_000));
        assert_eq!(byte_count("1.5 GiB"), Ok(3 << 29));
        assert_eq!(byte_count("64kib"), Ok(65536));
        for wrong in ["", "GB", "-1GB", "nan", "inf", "1e40", "5%", "0"] {
            assert!(byte_count(wrong).is_err(), "{wrong}");
        }
    }
}
