//! User settings, which may be left open and are persisted between runs.

use super::describe::{Described, Label, Place, Section, Setting as _, Shorthand, Value, Values, Word};
use super::{
    Backdrop, Choice, CodeStyle, DrawingSettings, EstimationStyle, LevelStyle, LightSettings, OfSequence, PhotoStyle,
    PointStyle, Primitive, RendererChoice, SplatFilter, Style, SurfelSettings, VoxelStyle, coloring,
};
use crate::scene::Clip;
use crate::sequence::Coloring;

/// All choices about an image except the camera.
///
/// They are stored in users' files, which outlive versions: missing values get the default, and unknown ones are
/// skipped. Files know no groups.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Primitive that points are rendered as.
    pub primitive: Choice<Primitive>,
    /// Colour source, and the mapping of numbers to colours.
    pub colors: Coloring,
    /// Drawing settings: the renderer, and the number of pixels.
    #[serde(flatten)]
    pub drawing: DrawingSettings,
    /// Surfel settings.
    #[serde(flatten)]
    pub surfels: SurfelSettings,
    /// Rendering settings of points that stay points.
    #[serde(flatten)]
    pub points: PointStyle,
    /// Voxel settings.
    #[serde(flatten)]
    pub voxels: VoxelStyle,
    /// Level-of-detail settings: the octree depth, and the selection of its cells that are drawn.
    #[serde(flatten)]
    pub levels: LevelStyle,
    /// Rendering settings of surfels from byte codes of the octree.
    #[serde(flatten)]
    pub codes: CodeStyle,
    /// Light that falls on surfaces, and light from depths.
    #[serde(flatten)]
    pub light: LightSettings,
    /// View-dependent texturing settings.
    #[serde(flatten)]
    pub photos: PhotoStyle,
    /// Estimation settings.
    #[serde(flatten)]
    pub estimation: EstimationStyle,
    /// Backdrop: the surroundings of the cloud.
    #[serde(flatten)]
    pub backdrop: Backdrop,
    /// Clip region: the part of the cloud that is drawn; all if `None`. It belongs to one sequence, and is stored with
    /// that.
    #[serde(skip)]
    pub clip: Option<Clip>,
}

impl Settings {
    /// The description of `primitive`.
    pub const PRIMITIVE: Described = Described {
        key: "primitive",
        flag: "primitive",
        value_name: "PRIMITIVE",
        help: "Draw points as this primitive (auto: surfels where they sample a surface)",
        everyday: true,
        title: "Primitive",
        hint: "Render mode of the points",
        section: Section::Own,
        label: Label::Always(Place::What, "{}"),
        also: &[
            "hide points",
            "show points",
            "visibility",
            "render mode",
            "representation",
            "draw as",
            "renderer",
        ],
        values: Values::Words(Choice::<Primitive>::WORDS),
        shorthands: &[Shorthand {
            word: Word {
                word: "ewa",
                title: "EWA",
                hint: "Surfels that are filtered to the pixels: far surfaces are smooth and still",
                also: &["anti-aliased splats", "smooth splats"],
            },
            given: &[
                ("primitive", Value::Word(Primitive::Surfel as usize + 1)),
                (SurfelSettings::FILTER.key, Value::Word(SplatFilter::Ewa as usize)),
            ],
        }],
        ..Described::USUAL
    };

    /// These settings with a change.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Shows each setting with its description to `edit`, and takes the edited value. The order is that of options in
    /// the help, and of rows in a section of the panel.
    pub fn edit(&mut self, edit: &mut dyn FnMut(&'static Described, Value) -> Value) {
        self.primitive.edit(&Self::PRIMITIVE, edit);
        self.surfels.edit(edit);
        self.estimation.edit(edit);
        self.codes.edit(edit);
        self.photos.edit(edit);
        self.light.edit(edit);
        self.levels.edit(edit);
        self.voxels.edit(edit);
        self.points.edit(edit);
        self.drawing.edit(edit);
        self.backdrop.edit(edit);
        self.colors.edit(&coloring::COLORS, edit);
    }

    /// Each setting with its description, as [`Settings::edit`] shows them.
    pub fn settings(&self) -> Vec<(&'static Described, Value)> {
        let mut settings = Vec::new();
        let mut unchanged = *self;
        unchanged.edit(&mut |described, value| {
            settings.push((described, value));
            value
        });
        settings
    }

    /// The nearest settings that files may hold.
    #[must_use]
    pub fn nearest(mut self) -> Self {
        self.edit(&mut |described, value| described.nearest(value));
        self
    }

    /// Resolves these settings to a style where nothing is known of the scene: every choice left open takes its
    /// default.
    pub fn decided(&self) -> Style {
        Style {
            primitive: self.primitive.decided(),
            colors: self.colors,
            drawing: self.drawing.decided(),
            surfels: self.surfels.decided(),
            points: self.points,
            voxels: self.voxels,
            levels: self.levels,
            codes: self.codes,
            light: self.light.with_rig().decided(),
            photos: self.photos,
            estimation: self.estimation,
            backdrop: self.backdrop,
            of_sequence: OfSequence {
                clip: self.clip,
                ..OfSequence::default()
            },
        }
    }

    /// Returns these settings as drawn by the CPU or by a GPU.
    #[must_use]
    pub fn drawn_by(&self, is_processor: bool) -> Self {
        self.with(|settings| settings.drawing.renderer = RendererChoice::of(is_processor).into())
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            primitive: Choice::Auto,
            colors: Coloring::default(),
            drawing: DrawingSettings::default(),
            surfels: SurfelSettings::default(),
            points: PointStyle::default(),
            voxels: VoxelStyle::default(),
            levels: LevelStyle::default(),
            codes: CodeStyle::default(),
            light: LightSettings::default(),
            photos: PhotoStyle::default(),
            estimation: EstimationStyle::default(),
            backdrop: Backdrop::default(),
            clip: None,
        }
    }
}

impl Default for Style {
    fn default() -> Self {
        Settings::default().decided()
    }
}
