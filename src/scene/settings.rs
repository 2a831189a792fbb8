//! Every choice a person has about a picture, with the words the command line and the window use for it.

use super::{Background, Clip, EyeDome, FirstLook, Lod};
use crate::levels::octree::StopCriterion;
use crate::math::Aabb;
use crate::sequence::{ColorHints, Coloring};

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
        /// Surfels where the points sample a surface, else points; see [`super::FirstLook`]. Surfels where nobody has
        /// looked.
        Auto = "auto",
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
    /// What the software renderer draws surfels from, and as what. Effective in the splatting modes that begin with a
    /// visibility pass; the GPU draws exact disks whatever it says.
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
    /// Whether surfels are drawn whose normals point away from the eye.
    BackFaces, "choice for back faces" {
        /// Left out where the surface is closed, so that nothing is missed, else drawn, and darker where the normals
        /// are known to point outwards; see [`super::FirstLook`]. Left out where nobody has looked.
        Auto = "auto",
        /// From behind as from the front.
        Drawn = "drawn",
        /// From behind a little darker than from the front, if there is light.
        Darker = "darker",
        /// Left out.
        Culled = "culled",
    }
}

/// What was written when there were two choices: to leave them out was the default, so it says nothing.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum StoredBackFaces {
    Are(BackFaces),
    AreCulled(bool),
}

fn stored_back_faces<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<BackFaces, D::Error> {
    Ok(match serde::Deserialize::deserialize(deserializer)? {
        StoredBackFaces::Are(choice) => choice,
        StoredBackFaces::AreCulled(true) => BackFaces::Auto,
        StoredBackFaces::AreCulled(false) => BackFaces::Drawn,
    })
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

choices! {
    /// What the light of voxels falls on.
    VoxelLight, "light of voxels" {
        /// The mean normals of the points of cells, from either side; the faces of cubes where normals are not known
        /// yet.
        Normals = "normals",
        /// The faces of cubes (paper 000 §VI).
        Faces = "faces",
    }
}

/// All choices about a picture but where the camera stands.
///
/// They are kept in files of people, which outlive versions: what a file does not have is as by default, and what is
/// not known here is passed over.
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
    /// Whether what faces away is drawn.
    #[serde(rename = "cull_back_faces", deserialize_with = "stored_back_faces")]
    pub back_faces: BackFaces,
    /// Where light is evaluated.
    pub lighting: Lighting,
    /// What the light of voxels falls on.
    pub voxel_light: VoxelLight,
    /// Whether depths shade the picture as well (eye-dome lighting).
    pub eye_dome: EyeDome,
    /// How much they do; 1 is usual.
    pub eye_dome_strength: f32,
    /// Whether lines show the ground.
    pub grid: bool,
    /// What is behind the cloud.
    pub background: Background,
    /// Where colours come from, and how numbers become colours.
    pub colors: Coloring,
    /// What colours can depend on beside the frames; of one sequence, so it is kept in no file.
    #[serde(skip)]
    pub color_hints: ColorHints,
    /// Edge of a drawn point in pixels.
    pub point_size_px: f32,
    /// How deep the octree goes: as far as voxels are closed, or as is said; a loss δ is offered from 0 to 0.6.
    pub stop: StopCriterion,
    /// Which of its cells are drawn.
    pub lod: Lod,
    /// Surfels stand for cells of the octree, as [`Settings::lod`] says, where they are small; else all points are
    /// drawn.
    pub surfel_lod: bool,
    /// Edge of the picture that is drawn, as a share of the one that is shown: below 1 fewer pixels are drawn and
    /// scaled up.
    pub resolution: f32,
    /// What the software renderer draws surfels from.
    pub footprint: Footprint,
    /// Precision of normals drawn from byte codes.
    pub normal_bits: NormalBits,
    /// Precision of offsets along normals drawn from byte codes.
    pub offset_bits: OffsetBits,
    /// What the ground is below, relative to the origin; all points of a frame if `None`. Kept in no file, as it is of
    /// one sequence.
    #[serde(skip)]
    pub ground_box: Option<Aabb>,
    /// What of the cloud is drawn; all if `None`. Its numbers belong to one sequence, so it is kept in no file.
    #[serde(skip)]
    pub clip: Option<Clip>,
}

impl Settings {
    /// Largest δ offered.
    pub const MAX_DELTA: f32 = 0.6;
    /// Values of [`Settings::eye_dome_strength`] that are offered.
    pub const EYE_DOME_STRENGTHS: std::ops::RangeInclusive<f32> = 0.0..=4.0;
    /// Values of [`Settings::resolution`] that are offered.
    pub const RESOLUTIONS: std::ops::RangeInclusive<f32> = 0.25..=1.0;

    /// Width and height that are drawn for a picture of `shown_px`; at least 1.
    pub fn drawn_px(&self, shown_px: [u32; 2]) -> [u32; 2] {
        shown_px.map(|edge| ((edge as f32 * self.resolution).round() as u32).max(1))
    }

    /// These settings, but drawn as `way` is: the colours, the background and the grid stay, what is clipped, and
    /// whether back faces are left out. Eye-dome lighting is that of `way` where that decides, which ways to draw that
    /// are measured do not.
    #[must_use]
    pub fn drawn_as(&self, way: &Self) -> Self {
        let decides = way.eye_dome != EyeDome::Auto;
        let light = if decides { way } else { self };
        Self {
            eye_dome: light.eye_dome,
            eye_dome_strength: light.eye_dome_strength,
            colors: self.colors,
            color_hints: self.color_hints,
            background: self.background,
            back_faces: self.back_faces,
            grid: self.grid,
            ground_box: self.ground_box,
            clip: self.clip,
            ..*way
        }
    }

    /// These settings, with what was guessed in place of every choice that is left open.
    #[must_use]
    pub fn resolved(&self, look: &FirstLook) -> Self {
        let primitive = match self.primitive {
            Primitive::Auto => look.primitive,
            chosen => chosen,
        };
        let back_faces = match self.back_faces {
            BackFaces::Auto if look.is_closed => BackFaces::Culled,
            BackFaces::Auto if look.knows_outside => BackFaces::Darker,
            BackFaces::Auto => BackFaces::Drawn,
            chosen => chosen,
        };
        // Of points that sample no surface, normals are noise.
        let shows_shape = primitive != Primitive::Point && look.primitive == Primitive::Surfel;
        let eye_dome = match self.eye_dome {
            EyeDome::Auto if shows_shape => EyeDome::Off,
            EyeDome::Auto => EyeDome::On,
            chosen => chosen,
        };
        Self {
            primitive,
            back_faces,
            eye_dome,
            // Whoever has chosen points has chosen their size.
            point_size_px: if self.primitive == Primitive::Auto {
                self.point_size_px.max(look.point_size_px)
            } else {
                self.point_size_px
            },
            background: if look.is_dark && self.background == Background::default() {
                Background::BEHIND_DARK
            } else {
                self.background
            },
            ground_box: Some(look.trimmed),
            color_hints: ColorHints {
                up: Some(look.up.direction().as_vec3()),
                prefers_height: Some(look.prefers_height()),
            },
            ..*self
        }
    }

    /// Whether surfels are left out that face away.
    pub fn culls_back_faces(&self) -> bool {
        matches!(self.back_faces, BackFaces::Auto | BackFaces::Culled)
    }

    /// Whether the light shows which side of a surfel is seen.
    pub fn darkens_back_faces(&self) -> bool {
        self.back_faces == BackFaces::Darker && self.lighting != Lighting::Unlit
    }

    /// Whether points are drawn as surfels.
    pub fn draws_surfels(&self) -> bool {
        matches!(self.primitive, Primitive::Auto | Primitive::Surfel)
    }

    /// Whether what is drawn are cells of an octree.
    pub fn draws_cells(&self) -> bool {
        match self.primitive {
            // Who draws codes draws no cut of the tree; by itself the machine may decide for the GPU.
            Primitive::Auto | Primitive::Surfel => {
                self.surfel_lod && !(self.draws_codes() && self.renderer == RendererChoice::Cpu)
            }
            Primitive::Voxel => true,
            Primitive::Point => false,
        }
    }

    /// Whether voxels are drawn whose light falls on normals.
    pub fn lights_voxels_by_normals(&self) -> bool {
        self.primitive == Primitive::Voxel
            && self.voxel_light == VoxelLight::Normals
            && self.lighting != Lighting::Unlit
    }

    /// What the octree is to be divided for: surfels that it is drawn as have no use for leaves as large as the
    /// spacing.
    pub fn octree_stop(&self) -> StopCriterion {
        match self.primitive {
            Primitive::Auto | Primitive::Surfel => self.stop.of_surfels(),
            Primitive::Voxel | Primitive::Point => self.stop,
        }
    }

    /// Whether surfels are drawn from the byte code of an octree, if the processor draws; [`Settings::lod`] says how
    /// finely. While something is clipped the same surfels are drawn as disks: a code cannot be cut.
    pub fn draws_codes(&self) -> bool {
        self.draws_surfels()
            && self.footprint != Footprint::Disks
            && self.renderer != RendererChoice::Gpu
            && !matches!(self.splatting, Splatting::Regular | Splatting::NoDepth)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            primitive: Primitive::Auto,
            renderer: RendererChoice::Auto,
            splatting: Splatting::TwoPass,
            strategy: Strategy::Storage,
            splat_scale: 1.0,
            enlargement: 2.0,
            back_faces: BackFaces::Auto,
            lighting: Lighting::PerFragment,
            voxel_light: VoxelLight::Normals,
            eye_dome: EyeDome::Auto,
            eye_dome_strength: 1.0,
            grid: false,
            background: Background::default(),
            colors: Coloring::default(),
            color_hints: ColorHints::default(),
            point_size_px: 2.0,
            stop: StopCriterion::default(),
            lod: Lod::default(),
            surfel_lod: false,
            resolution: 1.0,
            footprint: Footprint::Disks,
            normal_bits: NormalBits::Thirteen,
            offset_bits: OffsetBits::Three,
            ground_box: None,
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
            "`cone` is no primitive: expected auto, surfel, voxel, point"
        );
    }

    #[test]
    fn ways_to_draw_take_over_eye_dome_lighting_that_they_decide() {
        let settings = |eye_dome, eye_dome_strength| Settings {
            eye_dome,
            eye_dome_strength,
            ..Settings::default()
        };
        let (on, auto) = (settings(EyeDome::On, 2.0), settings(EyeDome::Auto, 0.5));
        assert_eq!(on.drawn_as(&auto), on);
        assert_eq!(auto.drawn_as(&on), on);
        let grid = Settings { grid: true, ..on };
        assert!(grid.drawn_as(&auto).grid);
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
}
