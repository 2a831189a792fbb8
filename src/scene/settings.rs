//! Every choice a person has about a picture, with the words the command line and the window use for it.

use super::{Clip, Lod};
use crate::octree::StopCriterion;
use crate::sequence::ColorSource;
use std::str::FromStr;

/// Writes an enum of unit variants once: its list, its names and how a name is read back, also in files.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident, $what:literal { $($(#[$variant_doc:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$variant_doc])* $variant,)+ }

        impl $name {
            /// Every choice, in the order the window lists them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The word for it on the command line and in reports.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text),+ }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::scene::ParseChoiceError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL.iter().copied().find(|choice| choice.name() == text).ok_or_else(|| {
                    $crate::scene::ParseChoiceError::new($what, text, Self::ALL.iter().map(|choice| choice.name()))
                })
            }
        }
    };
}
pub(crate) use choices;

/// A word that names no choice.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no {what}: expected {expected}")]
pub struct ParseChoiceError {
    what: &'static str,
    text: String,
    expected: String,
}

impl ParseChoiceError {
    pub(crate) fn new<'a>(
        what: &'static str,
        text: &str,
        expected: impl Iterator<Item = &'a str>,
    ) -> Self {
        Self {
            what,
            text: text.to_owned(),
            expected: expected.collect::<Vec<_>>().join(", "),
        }
    }
}

choices! {
    /// What a point becomes on the screen.
    Primitive, "primitive" {
        /// Oriented disks (paper 000 §V).
        Surfel = "surfel",
        /// Cubes of the octree's visible set (paper 000 §VI).
        Voxel = "voxel",
        /// Plain squares of a fixed size in pixels.
        Point = "point",
    }
}

choices! {
    /// The six ways of splatting of paper 000, Fig. 3.
    Splatting, "splatting mode" {
        /// (a) One pass, depth test and blending: square artefacts where splats cut each other.
        Regular = "regular",
        /// (b) One pass without depth: far splats shine through.
        NoDepth = "no-depth",
        /// (c) The depths that the visibility pass leaves, as grey.
        Visibility = "visibility",
        /// (d) Visibility pass, then blending of what lies at the surface.
        TwoPass = "two-pass",
        /// (e) Two passes, both with enlarged splats.
        Enlarged = "enlarged",
        /// (f) Two passes, enlarged in the second only: the paper's proposal.
        TwoPassEnlarged = "two-pass-enlarged",
    }
}

choices! {
    /// What the software renderer draws surfels from, and as what. Effective in the splatting modes that begin with a visibility
    /// pass; the GPU draws exact disks whatever it says.
    Footprint, "footprint" {
        /// Exact disks, pixel by pixel, of the records of points.
        Disks = "disks",
        /// Masks worked out once for quantised normals, from the byte code of the octree (paper 001 §5.2).
        Masks = "masks",
        /// A pixel for each cell, from the byte code of the octree (paper 001 §4).
        Pixels = "pixels",
    }
}

choices! {
    /// Bits of the normals that are drawn from byte codes (paper 001 §4.1).
    NormalBits, "number of bits of normals" {
        /// 8192 directions, up to 2.3° off: the paper's.
        Thirteen = "13",
        /// 32,768 directions.
        Fifteen = "15",
        /// 131,072 directions.
        Seventeen = "17",
    }
}

impl NormalBits {
    /// The number.
    pub fn bits(self) -> u32 {
        match self {
            Self::Thirteen => 13,
            Self::Fifteen => 15,
            Self::Seventeen => 17,
        }
    }
}

choices! {
    /// Bits of the offsets along normals with which byte codes are drawn (paper 001 §5.1).
    OffsetBits, "number of bits of offsets" {
        /// Splats stand in the middles of cells: gaps at grazing angles.
        None = "0",
        /// The paper's.
        Two = "2",
        /// All there are.
        Three = "3",
    }
}

impl OffsetBits {
    /// The number.
    pub fn bits(self) -> u32 {
        match self {
            Self::None => 0,
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

choices! {
    /// Who draws.
    RendererChoice, "renderer" {
        /// The GPU if there is a real one, else the processor.
        Auto = "auto",
        /// The adapter of the graphics library, be it a software one.
        Gpu = "gpu",
        /// The processor, without any driver.
        Cpu = "cpu",
    }
}

impl RendererChoice {
    /// Whether the processor draws, if the adapter is a program that draws there too, or a GPU.
    pub fn is_processor(self, adapter_is_software: bool) -> bool {
        match self {
            Self::Auto => adapter_is_software,
            Self::Gpu => false,
            Self::Cpu => true,
        }
    }
}

impl Splatting {
    /// Factors on the splat radius in the visibility and in the attribute pass.
    pub fn scales(self, enlargement: f32) -> [f32; 2] {
        match self {
            Self::Regular | Self::NoDepth | Self::Visibility | Self::TwoPass => [1.0, 1.0],
            Self::Enlarged => [enlargement, enlargement],
            Self::TwoPassEnlarged => [1.0, enlargement],
        }
    }
}

choices! {
    /// Whether what is farther away is smaller.
    Projection, "projection" {
        /// Through a point: the eye.
        Perspective = "perspective",
        /// By parallel rays: lengths across the view can be compared.
        Orthographic = "orthographic",
    }
}

choices! {
    /// How instances reach the vertex stage (paper 000 §IV).
    Strategy, "instancing strategy" {
        /// Records pulled from a storage buffer.
        Storage = "storage",
        /// Records in 64 KiB uniform buffers, one draw for each.
        Uniform = "uniform",
        /// Records as texels.
        Texture = "texture",
        /// Records as per-instance vertex attributes.
        Vertex = "vertex",
        /// A compute pass writes the quads: what the geometry shader did.
        Compute = "compute",
    }
}

choices! {
    /// Where the head light is evaluated (paper 000 §V-B).
    Lighting, "lighting" {
        /// Plain colours.
        Unlit = "none",
        /// Once a surfel or face.
        PerSurfel = "surfel",
        /// At each corner, interpolated.
        PerVertex = "vertex",
        /// At each pixel.
        PerFragment = "fragment",
    }
}

/// What is behind the cloud: a vertical gradient between two colours, or one colour when they are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "StoredBackground")]
pub struct Background {
    /// Red, green, blue at the top edge.
    pub top: [u8; 3],
    /// Red, green, blue at the bottom edge.
    pub bottom: [u8; 3],
}

impl Background {
    /// Names and values of the presets.
    pub const PRESETS: &'static [(&'static str, Self)] = &[
        (
            "dusk",
            Self {
                top: [44, 52, 66],
                bottom: [17, 20, 26],
            },
        ),
        ("black", Self::solid([0, 0, 0])),
        ("gray", Self::solid([119, 119, 119])),
        ("white", Self::solid([255, 255, 255])),
        (
            "sky",
            Self {
                top: [120, 165, 214],
                bottom: [235, 240, 245],
            },
        ),
    ];

    /// One colour everywhere.
    pub const fn solid(color: [u8; 3]) -> Self {
        Self {
            top: color,
            bottom: color,
        }
    }
}

/// How a background is in a file: as it is written, or as the word of the command line, which `settings.json` had once.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum StoredBackground {
    Word(String),
    Edges { top: [u8; 3], bottom: [u8; 3] },
}

impl TryFrom<StoredBackground> for Background {
    type Error = ParseChoiceError;

    fn try_from(stored: StoredBackground) -> Result<Self, Self::Error> {
        match stored {
            StoredBackground::Word(text) => text.parse(),
            StoredBackground::Edges { top, bottom } => Ok(Self { top, bottom }),
        }
    }
}

impl Default for Background {
    fn default() -> Self {
        Self::PRESETS[0].1
    }
}

impl FromStr for Background {
    type Err = ParseChoiceError;

    /// Reads a preset's name, `#rrggbb`, or `#rrggbb-#rrggbb` (top to bottom).
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let preset = Self::PRESETS
            .iter()
            .find(|(name, _)| *name == text)
            .map(|&(_, preset)| preset);
        let parsed = preset.or_else(|| match text.split_once('-') {
            Some((top, bottom)) => Some(Self {
                top: parse_hex(top)?,
                bottom: parse_hex(bottom)?,
            }),
            None => parse_hex(text).map(Self::solid),
        });
        parsed.ok_or_else(|| {
            let presets = Self::PRESETS.iter().map(|(name, _)| *name);
            ParseChoiceError::new(
                "background",
                text,
                presets.chain(["#rrggbb", "#rrggbb-#rrggbb"]),
            )
        })
    }
}

fn parse_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([(value >> 16) as u8, (value >> 8) as u8, value as u8])
}

/// All choices about a picture but where the camera stands.
///
/// They are kept in files of people, which outlive versions: what a file does not have is as by default, and what is not
/// known here is passed over.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What points become.
    pub primitive: Primitive,
    /// Who draws.
    pub renderer: RendererChoice,
    /// How surfels are splatted.
    pub splatting: Splatting,
    /// How instances reach the GPU.
    pub strategy: Strategy,
    /// Factor on every splat radius.
    pub splat_scale: f32,
    /// Further factor of the enlarged passes; the paper uses 2.
    pub enlargement: f32,
    /// Drop what faces away. Off for clouds whose normals cannot be trusted.
    pub cull_back_faces: bool,
    /// Where light is evaluated.
    pub lighting: Lighting,
    /// What is behind the cloud.
    pub background: Background,
    /// Where colours come from.
    pub colors: ColorSource,
    /// Edge of a drawn point in pixels.
    pub point_size_px: f32,
    /// How deep the octree goes; a loss δ is offered from 0 to 0.6.
    pub stop: StopCriterion,
    /// Which of its cells are drawn.
    pub lod: Lod,
    /// Surfels stand for cells of the octree, as [`Settings::lod`] says, where they are small; else all points are drawn.
    pub surfel_lod: bool,
    /// Edge of the picture that is drawn, as a share of the one that is shown: below 1 fewer pixels are drawn and scaled up.
    pub resolution: f32,
    /// What the software renderer draws surfels from.
    pub footprint: Footprint,
    /// Precision of normals drawn from byte codes.
    pub normal_bits: NormalBits,
    /// Precision of offsets along normals drawn from byte codes.
    pub offset_bits: OffsetBits,
    /// What of the cloud is drawn; all if `None`. Its numbers belong to one sequence, so it is kept in no file.
    #[serde(skip)]
    pub clip: Option<Clip>,
}

impl Settings {
    /// Largest δ offered.
    pub const MAX_DELTA: f32 = 0.6;
    /// Values of [`Settings::resolution`] that are offered.
    pub const RESOLUTIONS: std::ops::RangeInclusive<f32> = 0.25..=1.0;

    /// Width and height that are drawn for a picture of `shown_px`; at least 1.
    pub fn drawn_px(&self, shown_px: [u32; 2]) -> [u32; 2] {
        shown_px.map(|edge| ((edge as f32 * self.resolution).round() as u32).max(1))
    }

    /// These settings, but drawn as `way` is: the colours and the background stay, what is clipped, and whether back faces are left
    /// out.
    #[must_use]
    pub fn drawn_as(&self, way: &Self) -> Self {
        Self {
            colors: self.colors,
            background: self.background,
            cull_back_faces: self.cull_back_faces,
            clip: self.clip,
            ..*way
        }
    }

    /// Whether what is drawn are cells of an octree.
    pub fn draws_cells(&self) -> bool {
        match self.primitive {
            // Who draws codes draws no cut of the tree; by itself the machine may decide for the GPU.
            Primitive::Surfel => {
                self.surfel_lod && !(self.draws_codes() && self.renderer == RendererChoice::Cpu)
            }
            Primitive::Voxel => true,
            Primitive::Point => false,
        }
    }

    /// Whether surfels are drawn from the byte code of an octree, if the processor draws; [`Settings::lod`] says how finely. While
    /// something is clipped the same surfels are drawn as disks: a code cannot be cut.
    pub fn draws_codes(&self) -> bool {
        self.primitive == Primitive::Surfel
            && self.footprint != Footprint::Disks
            && self.renderer != RendererChoice::Gpu
            && !matches!(self.splatting, Splatting::Regular | Splatting::NoDepth)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            primitive: Primitive::Surfel,
            renderer: RendererChoice::Auto,
            splatting: Splatting::TwoPass,
            strategy: Strategy::Storage,
            splat_scale: 1.0,
            enlargement: 2.0,
            cull_back_faces: true,
            lighting: Lighting::PerFragment,
            background: Background::default(),
            colors: ColorSource::Auto,
            point_size_px: 1.0,
            stop: StopCriterion::default(),
            lod: Lod::default(),
            surfel_lod: false,
            resolution: 1.0,
            footprint: Footprint::Disks,
            normal_bits: NormalBits::Thirteen,
            offset_bits: OffsetBits::Three,
            clip: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_reads_back_from_its_name() {
        for &mode in Splatting::ALL {
            assert_eq!(mode.name().parse(), Ok(mode));
        }
        for &strategy in Strategy::ALL {
            assert_eq!(strategy.name().parse(), Ok(strategy));
        }
        let error = "cone".parse::<Primitive>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "`cone` is no primitive: expected surfel, voxel, point"
        );
    }

    #[test]
    fn a_picture_is_drawn_in_whole_pixels() {
        let settings = |resolution| Settings {
            resolution,
            ..Settings::default()
        };
        assert_eq!(settings(1.0).drawn_px([1921, 1080]), [1921, 1080]);
        assert_eq!(settings(0.5).drawn_px([1921, 1080]), [961, 540]);
        assert_eq!(settings(0.25).drawn_px([1, 0]), [1, 1]);
    }

    #[test]
    fn backgrounds_are_presets_colors_or_gradients() {
        assert_eq!("black".parse(), Ok(Background::solid([0, 0, 0])));
        assert_eq!("#0a10ff".parse(), Ok(Background::solid([10, 16, 255])));
        assert_eq!(
            "#000000-#ffffff".parse(),
            Ok(Background {
                top: [0; 3],
                bottom: [255; 3]
            })
        );
        for wrong in ["", "#12345", "#12345g", "#é1234", "000000", "#000000-"] {
            assert!(wrong.parse::<Background>().is_err(), "{wrong}");
        }
    }
}
