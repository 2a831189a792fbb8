//! Arguments that several verbs share.

use super::colors::ColorArgs;
use super::warnings;
use crate::io::ReadOptions;
use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{
    BackFaces, Backdrop, Background, Clip, ClipShape, CodeStyle, EyeDome, Footprint, LevelStyle,
    LightStyle, Lighting, NormalBits, OfSequence, OffsetBits, ParseChoiceError, PointStyle,
    Primitive, RendererChoice, Splatting, Strategy, Style, SurfelStyle, VoxelLight, VoxelStyle,
};
use crate::sequence::{OpenOptions, Sequence, SequenceError};
use clap::Args;
use glam::DVec3;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

/// The name of the built-in sequence where an INPUT is expected.
pub(super) const DEMO_INPUT: &str = "demo:";

/// Headings of the help.
pub(super) const VIEW: &str = "View";
const LEVEL_OF_DETAIL: &str = "Level of detail";

/// Opens what a person named; nothing is the built-in sequence.
pub(super) fn open_sequence(
    inputs: &[PathBuf],
    options: &OpenOptions,
) -> Result<Sequence, SequenceError> {
    match inputs {
        [] => Sequence::open(&[DEMO_INPUT.into()], options),
        _ => Sequence::open(inputs, options),
    }
}

/// [`open_sequence`], which warns of what is left out. A window says that itself.
pub(super) fn open_sequence_and_tell(
    inputs: &[PathBuf],
    options: &OpenOptions,
) -> Result<Sequence, SequenceError> {
    let sequence = open_sequence(inputs, options)?;
    for note in sequence.source().notes() {
        warnings::warn(note);
    }
    Ok(sequence)
}

/// How files are read.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Reading")]
pub(super) struct ReadArgs {
    /// Most memory that reading one frame may take, such as 2GB (usually half of all)
    #[arg(long, value_name = "SIZE", value_parser = byte_count)]
    max_memory: Option<u64>,

    /// Sample so many points evenly from the faces of a mesh (in pictures usually 100,000)
    #[arg(long, value_name = "N")]
    sample: Option<NonZeroUsize>,

    /// Numbers a point in .bin files, 3 to 6 (usually told by statistics)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(3..=6))]
    columns: Option<u8>,

    /// All scans of an E57 file are one frame, not a frame each
    #[arg(long)]
    merge_scans: bool,

    /// Topic of a recording (MCAP, ROS bag) that has the frames; `info` lists them
    #[arg(long, value_name = "NAME")]
    topic: Option<String>,
}

/// Points on the surface of a mesh where pictures are made and nobody said how many.
const MESH_POINTS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(99_999);

impl ReadArgs {
    /// [`Self::open_options`] for pictures: meshes are shown by their surface.
    pub(super) fn picture_options(&self) -> OpenOptions {
        let options = self.open_options();
        OpenOptions {
            read: options.read.with_mesh_sample_count(Some(MESH_POINTS)),
            ..options
        }
    }

    pub(super) fn open_options(&self) -> OpenOptions {
        let default = ReadOptions::default();
        let max_memory_bytes = self.max_memory.unwrap_or(default.max_memory_bytes);
        OpenOptions {
            read: default
                .with_max_memory(max_memory_bytes)
                .with_sample_count(self.sample)
                .with_bin_columns(self.columns),
            fps: None,
            merge_scans: self.merge_scans,
            topic: self.topic.as_deref().map(Arc::from),
        }
    }
}

/// How a picture looks; what is not given is as usual: in a window as it was left, else as in a new one.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureArgs {
    /// What points become: surfel, voxel or point
    #[arg(long, value_name = "PRIMITIVE")]
    primitive: Option<Primitive>,

    /// Who draws: auto (a real GPU, else the processor), gpu or cpu
    #[arg(long, value_name = "RENDERER")]
    renderer: Option<RendererChoice>,

    /// regular, no-depth, visibility, two-pass, enlarged or two-pass-enlarged
    #[arg(long, value_name = "MODE")]
    splatting: Option<Splatting>,

    /// Factor on every splat radius
    #[arg(long, value_name = "S", value_parser = positive)]
    splat_scale: Option<f32>,

    /// Further factor of the enlarged passes
    #[arg(long, value_name = "S", value_parser = positive)]
    enlargement: Option<f32>,

    /// storage, uniform, texture, vertex or compute
    #[arg(long, value_name = "STRATEGY")]
    instancing: Option<Strategy>,

    /// Edge of a point in pixels
    #[arg(long, value_name = "PX", value_parser = positive)]
    point_size: Option<f32>,

    /// Where light is evaluated: none, surfel, vertex or fragment
    #[arg(long, value_name = "WHERE")]
    lighting: Option<Lighting>,

    /// What the light of voxels falls on: normals (the surface in them) or faces
    #[arg(long, value_name = "WHAT")]
    voxel_light: Option<VoxelLight>,

    /// dusk, black, gray, white, sky, transparent (in files), #rrggbb or #rrggbb-#rrggbb
    #[arg(long, value_name = "COLOR")]
    background: Option<Behind>,

    /// Surfels that face away: auto (left out if closed), drawn, darker or culled
    #[arg(long, value_name = "FACES")]
    back_faces: Option<BackFaces>,

    /// The same as --back-faces drawn
    #[arg(long, conflicts_with = "back_faces")]
    two_sided: bool,

    /// Draw surfels of octree cells, as --lod… says, instead of all points
    #[arg(long, help_heading = LEVEL_OF_DETAIL)]
    surfel_lod: bool,

    /// Draw a picture of this share of its edges, 0.25 to 1, and scale it up
    #[arg(long, value_name = "SHARE", value_parser = resolution)]
    resolution: Option<f32>,

    /// What the processor draws surfels from: disks, or byte codes as masks or pixels
    #[arg(long, value_name = "FOOTPRINT")]
    footprint: Option<Footprint>,

    /// Bits of the normals of byte codes: 13, 15 or 17
    #[arg(long, value_name = "BITS")]
    normal_bits: Option<NormalBits>,

    /// Bits of the offsets along normals of byte codes: 0, 2 or 3
    #[arg(long, value_name = "BITS")]
    offset_bits: Option<OffsetBits>,

    /// Draw only points from the first to the second corner, coordinates of the file
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true, value_parser = clip_box)]
    clip_box: Option<ClipShape>,

    /// Draw what is outside of --clip-box instead
    #[arg(long, requires = "clip_box")]
    clip_outside: bool,

    #[command(flatten)]
    colors: ColorArgs,

    #[command(flatten)]
    shown: ShownArgs,

    #[command(flatten)]
    stop: StopArgs,

    #[command(flatten)]
    lod: LodArgs,
}

/// What is behind the cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Behind {
    Colors(Background),
    /// The picture is transparent there.
    Nothing,
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
    /// Whether nothing is to be behind the cloud.
    pub(super) fn is_transparent(&self) -> bool {
        self.background == Some(Behind::Nothing)
    }

    /// What was chosen for points to become.
    pub(super) fn primitive(&self) -> Option<Primitive> {
        self.primitive
    }

    /// `default`, but for what is given.
    pub(super) fn settings_over(&self, default: Style) -> Style {
        Style {
            primitive: self.primitive.unwrap_or(default.primitive),
            renderer: self.renderer.unwrap_or(default.renderer),
            strategy: self.instancing.unwrap_or(default.strategy),
            colors: self.colors.over(default.colors),
            resolution: self.resolution.unwrap_or(default.resolution),
            surfels: SurfelStyle {
                splatting: self.splatting.unwrap_or(default.surfels.splatting),
                splat_scale: self.splat_scale.unwrap_or(default.surfels.splat_scale),
                enlargement: self.enlargement.unwrap_or(default.surfels.enlargement),
                back_faces: self
                    .back_faces
                    .or(self.two_sided.then_some(BackFaces::Drawn))
                    .unwrap_or(default.surfels.back_faces),
            },
            points: PointStyle {
                size_px: self.point_size.unwrap_or(default.points.size_px),
            },
            voxels: VoxelStyle {
                light: self.voxel_light.unwrap_or(default.voxels.light),
            },
            levels: LevelStyle {
                stop: self.stop.criterion().unwrap_or(default.levels.stop),
                lod: self.lod.choice().unwrap_or(default.levels.lod),
                surfel_lod: default.levels.surfel_lod || self.surfel_lod,
            },
            codes: CodeStyle {
                footprint: self.footprint.unwrap_or(default.codes.footprint),
                normal_bits: self.normal_bits.unwrap_or(default.codes.normal_bits),
                offset_bits: self.offset_bits.unwrap_or(default.codes.offset_bits),
            },
            light: LightStyle {
                lighting: self.lighting.unwrap_or(default.light.lighting),
                eye_dome: self.shown.eye_dome.unwrap_or(default.light.eye_dome),
                eye_dome_strength: (self.shown.eye_dome_strength)
                    .unwrap_or(default.light.eye_dome_strength),
            },
            backdrop: Backdrop {
                grid: default.backdrop.grid || self.shown.grid,
                background: match self.background {
                    Some(Behind::Colors(background)) => background,
                    Some(Behind::Nothing) | None => default.backdrop.background,
                },
            },
            of_sequence: OfSequence {
                color_hints: default.of_sequence.color_hints,
                ground_box: default.of_sequence.ground_box,
                clip: self.clip_box.map_or(default.of_sequence.clip, |shape| {
                    Some(Clip {
                        keeps_outside: self.clip_outside,
                        ..Clip::to(shape)
                    })
                }),
            },
        }
    }
}

/// What else shows shape and place.
#[derive(Debug, Clone, Default, Args)]
struct ShownArgs {
    /// Shade by depths (eye-dome lighting): auto, on or off
    #[arg(long, value_name = "WHETHER")]
    eye_dome: Option<EyeDome>,

    /// How much --eye-dome shades (usually 1)
    #[arg(long, value_name = "FACTOR", value_parser = not_negative)]
    eye_dome_strength: Option<f32>,

    /// Draw lines on the ground
    #[arg(long)]
    grid: bool,
}

/// When the octree's cells are no longer divided: one of these.
#[derive(Debug, Clone, Default, Args)]
#[group(multiple = false)]
#[command(next_help_heading = LEVEL_OF_DETAIL)]
struct StopArgs {
    /// Divide the octree down to the spacing of the points: closed surfaces (usual)
    #[arg(long)]
    spacing: bool,

    /// Divide it until this share of the points has no leaf of its own (paper: 0.05)
    #[arg(long, value_name = "D", value_parser = delta)]
    delta: Option<f32>,

    /// Divide the octree down to this level, 0 to 21
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=21))]
    depth: Option<u32>,

    /// Divide cells of the octree that hold more than so many points
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    octant_points: Option<u32>,
}

impl StopArgs {
    fn criterion(&self) -> Option<StopCriterion> {
        let spacing = self.spacing.then_some(StopCriterion::Spacing);
        let delta = self.delta.map(StopCriterion::Loss);
        let depth = self.depth.map(StopCriterion::Depth);
        spacing
            .or(delta)
            .or(depth)
            .or(self.octant_points.map(StopCriterion::PointsPerOctant))
    }
}

/// Which cells of the octree are drawn: one of these.
#[derive(Debug, Clone, Default, Args)]
#[group(multiple = false)]
#[command(next_help_heading = LEVEL_OF_DETAIL)]
struct LodArgs {
    /// Draw octree cells below this many pixels as one (usually 1)
    #[arg(long, value_name = "PX", value_parser = not_negative)]
    lod: Option<f32>,

    /// Draw all octree cells of this level, 0 to 21
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=21))]
    lod_level: Option<u32>,

    /// Draw the finest octree cells that are at most so many
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    lod_budget: Option<u32>,

    /// Draw as many octree cells as this many milliseconds allow
    #[arg(long, value_name = "MS", value_parser = positive)]
    lod_time: Option<f32>,
}

impl LodArgs {
    fn choice(&self) -> Option<Lod> {
        let threshold = self.lod.map(Lod::ThresholdPx);
        let level = self.lod_level.map(Lod::Level);
        let budget = self.lod_budget.map(Lod::Budget);
        let time = self.lod_time.map(Lod::FrameTimeMs);
        threshold.or(level).or(budget).or(time)
    }
}

/// `WxH` in pixels.
pub(super) fn size_px(text: &str) -> Result<[u32; 2], String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        let size = [width.parse().ok()?, height.parse().ok()?];
        size.iter().all(|&edge: &u32| edge > 0).then_some(size)
    };
    parse().ok_or_else(|| "expected WIDTHxHEIGHT in pixels, such as 1280x720".to_owned())
}

fn number_in<T>(text: &str, is_valid: impl Fn(&T) -> bool, expected: &str) -> Result<T, String>
where
    T: std::str::FromStr,
{
    text.parse()
        .ok()
        .filter(is_valid)
        .ok_or_else(|| format!("expected {expected}"))
}

fn positive(text: &str) -> Result<f32, String> {
    number_in(
        text,
        |value: &f32| value.is_finite() && *value > 0.0,
        "a number above 0",
    )
}

fn resolution(text: &str) -> Result<f32, String> {
    number_in(
        text,
        |value: &f32| Style::RESOLUTIONS.contains(value),
        "a share from 0.25 to 1",
    )
}

pub(super) fn positive_f64(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value: &f64| value.is_finite() && *value > 0.0,
        "a number above 0",
    )
}

fn not_negative(text: &str) -> Result<f32, String> {
    number_in(
        text,
        |value: &f32| value.is_finite() && *value >= 0.0,
        "a number from 0 up",
    )
}

pub(super) fn not_negative_f64(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value: &f64| value.is_finite() && *value >= 0.0,
        "a number from 0 up",
    )
}

fn delta(text: &str) -> Result<f32, String> {
    number_in(
        text,
        |value| (0.0..=Style::MAX_DELTA).contains(value),
        "a number from 0 to 0.6, such as 0.05",
    )
}

pub(super) fn finite(text: &str) -> Result<f64, String> {
    number_in(text, |value: &f64| value.is_finite(), "degrees")
}

pub(super) fn elevation(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value| (-90.0..=90.0).contains(value),
        "degrees from -90 to 90",
    )
}

pub(super) fn field_of_view(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value| (1.0..=170.0).contains(value),
        "degrees from 1 to 170",
    )
}

fn clip_box(text: &str) -> Result<ClipShape, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|number| number.trim().parse().ok())
        .collect();
    let corners = numbers.and_then(|numbers| <[f64; 6]>::try_from(numbers).ok());
    corners
        .map(|[a, b, c, d, e, f]| (DVec3::new(a, b, c), DVec3::new(d, e, f)))
        .filter(|(min, max)| min.is_finite() && max.is_finite() && min.cmple(*max).all())
        .map(|(min, max)| ClipShape::Box { min, max })
        .ok_or_else(|| {
            "expected six numbers, the smallest x,y,z and then the largest, such as 0,0,0,1.5,2,1"
                .to_owned()
        })
}

/// Frames `first` to `last`, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameRange {
    pub(super) first: usize,
    pub(super) last: usize,
}

impl FrameRange {
    /// Both ends included.
    pub(super) fn bounds(&self) -> RangeInclusive<usize> {
        self.first..=self.last
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parse = |number: &str| number.parse::<usize>().ok();
        let range = match text.split_once("..") {
            Some((first, last)) => parse(first).zip(parse(last)),
            None => parse(text).map(|frame| (frame, frame)),
        };
        match range {
            Some((first, last)) if first <= last => Ok(Self { first, last }),
            _ => Err(
                "expected a frame such as 0, or a range such as 0..23 with both ends included"
                    .to_owned(),
            ),
        }
    }
}

/// Frames a second that a clock takes.
pub(super) fn frame_rate(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|fps| (0.1..=1000.0).contains(fps))
        .ok_or_else(|| "expected frames a second from 0.1 to 1000".to_owned())
}

/// `1500000000`, `1.5GB` (10⁹) or `2GiB` (2³⁰).
pub(super) fn byte_count(text: &str) -> Result<u64, String> {
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

    #[test]
    fn ranges_include_both_ends() {
        assert_eq!("7".parse(), Ok(FrameRange { first: 7, last: 7 }));
        assert_eq!("2..5".parse(), Ok(FrameRange { first: 2, last: 5 }));
        for wrong in ["", "a", "5..2", "1..", "..3", "-1", "1...3"] {
            assert!(wrong.parse::<FrameRange>().is_err(), "{wrong}");
        }
    }
}
