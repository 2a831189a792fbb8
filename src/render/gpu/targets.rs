//! Render targets: colour (the image), accumulation (weighted sums) and depth, all of the viewport's size.

use super::context::Context;
use super::photo_answers::{self, PhotoAnswers};
use super::photos::PhotoTextures;
use super::textures::{self, texture, view};
use crate::scene::{PhysicalTables, ScenePacket, Shadow};
use std::sync::Arc;

/// Display-referred 8-bit colour.
// Blended display-referred, not in linear light: an unlit point has exactly the colour of the file.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Reverse-Z: floats are densest near 0, where the far half of the scene is.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Light is not display-referred, and brighter than white.
const ENVIRONMENT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Floating-point precision of the sums of weighted colours, normals and reversed distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Precision {
    /// Half floats: every adapter blends them, and they hold a sum of some splats to a part in 2048.
    Half,
    /// Many small splats per pixel still add up.
    Single,
}

/// Render target of a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Target {
    /// Over the background, which is there.
    Picture,
    /// Cleared by the pass over records that draws into it.
    Sums,
    /// Three textures, cleared in the same way: sums of colours, of normals and of nearnesses, which are lit.
    Surfaces,
    /// Two textures with the view-dependent texturing result of each pixel, as colours and as normals.
    PhotoAnswers,
    /// A level of the pyramid over these colours.
    PhotoLevel,
    /// Antialiased image, which is displayed.
    Shown,
}

/// Input textures of a screen-space pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Source {
    Picture,
    /// A copy of it, for passes that draw into the image itself.
    PictureCopy,
    /// Sums of colours, and depths.
    Sums,
    Depths,
    /// Sums of colours, of normals and of nearnesses; depths; the shadow map; and the environment.
    Surfaces,
    /// Inputs as for surfaces, and the input images.
    Textured,
    /// Inputs as for surfaces and the input images, with sums of lit colours instead of the environment.
    TexturedSums,
    /// Inputs as for surfaces, the table of input images, and the view-dependent texturing result of each pixel.
    PhotoAnswers,
    /// The level of the pyramid over their results that is one finer than the one drawn into.
    FinerLevel,
    /// The next coarser one.
    CoarserLevel,
}

/// Texture binding type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TextureKind {
    /// Colours, or other numbers.
    Color,
    /// Colours or other numbers, in array layers.
    Layers,
    Depth,
}

impl TextureKind {
    /// Its type in WGSL.
    pub(super) fn wgsl(self) -> &'static str {
        match self {
            Self::Color => "texture_2d<f32>",
            Self::Layers => "texture_2d_array<f32>",
            Self::Depth => "texture_depth_2d",
        }
    }

    pub(super) fn binding_type(self) -> wgpu::BindingType {
        let not_filtered = wgpu::TextureSampleType::Float { filterable: false };
        let (sample_type, view_dimension) = match self {
            Self::Color => (not_filtered, wgpu::TextureViewDimension::D2),
            Self::Layers => (not_filtered, wgpu::TextureViewDimension::D2Array),
            Self::Depth => (wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2),
        };
        wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        }
    }
}

/// A texture by its name in WGSL.
type NamedTexture = (&'static str, TextureKind);

/// Sums, depths, and the inputs of lighting.
const SURFACE_TEXTURES: [NamedTexture; 6] = [
    ("colors", TextureKind::Color),
    ("normals", TextureKind::Color),
    ("nearnesses", TextureKind::Color),
    ("depths", TextureKind::Depth),
    ("shadow_map", TextureKind::Depth),
    // Prefiltered for the roughness, and one more row with the curve of reflected and lost light.
    ("environment", TextureKind::Color),
];

const PHOTO_TABLE: NamedTexture = ("photo_table", TextureKind::Color);
const PHOTOS: [NamedTexture; 3] = [
    PHOTO_TABLE,
    ("photo_texels", TextureKind::Layers),
    ("photo_depths", TextureKind::Layers),
];

impl Source {
    /// Its textures, in the order of [`Targets::sources`].
    pub(super) fn textures(self) -> Vec<NamedTexture> {
        match self {
            Self::Picture | Self::PictureCopy => vec![("picture", TextureKind::Color)],
            Self::Sums => vec![("accumulated", TextureKind::Color), ("depths", TextureKind::Depth)],
            Self::Depths => vec![("depths", TextureKind::Depth)],
            Self::Surfaces => SURFACE_TEXTURES.to_vec(),
            Self::Textured => [&SURFACE_TEXTURES[..], &PHOTOS].concat(),
            Self::TexturedSums => {
                let mut textures = Self::Textured.textures();
                textures[ENVIRONMENT] = ("lit_colors", TextureKind::Color);
                textures
            }
            Self::PhotoAnswers => {
                // Colours times their confidence, and the confidence; normals, and `ANSWER_*`.
                let answers = ["answered_colors", "answered_normals"].map(|name| (name, TextureKind::Color));
                [&SURFACE_TEXTURES[..], &[PHOTO_TABLE], &answers].concat()
            }
            Self::FinerLevel => vec![("finer", TextureKind::Color)],
            Self::CoarserLevel => vec![("coarser", TextureKind::Color)],
        }
    }
}

/// The place of the environment among the textures of surfaces.
const ENVIRONMENT: usize = 5;

/// Widths and heights of images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SizesPx {
    pub(super) drawn: [u32; 2],
    /// Size of the displayed image, if it is a different one.
    pub(super) shown: Option<[u32; 2]>,
}

impl Target {
    /// One for each texture.
    pub(super) fn formats(self, precision: Precision) -> &'static [wgpu::TextureFormat] {
        use wgpu::TextureFormat::{R16Float, R32Float, Rgba16Float, Rgba32Float};
        match (self, precision) {
            (Self::Picture | Self::Shown, _) => &[COLOR_FORMAT],
            (Self::PhotoAnswers, _) => &[photo_answers::FORMAT; 2],
            (Self::PhotoLevel, _) => &[photo_answers::FORMAT],
            (Self::Sums, Precision::Half) => &[Rgba16Float],
            (Self::Sums, Precision::Single) => &[Rgba32Float],
            // Reversed distances are in units of `Lights::usual_distance`, less 1.
            (Self::Surfaces, Precision::Half) => &[Rgba16Float, Rgba16Float, R16Float],
            (Self::Surfaces, Precision::Single) => &[Rgba32Float, Rgba32Float, R32Float],
        }
    }
}

/// The textures of one viewport size.
#[derive(Debug)]
pub(super) struct Targets {
    size_px: [u32; 2],
    /// The size of the image shown, if that is another texture than the one drawn into.
    shown_px: Option<[u32; 2]>,
    /// Precision of the sums.
    pub(super) precision: Precision,
    color: wgpu::Texture,
    color_view: wgpu::TextureView,
    /// Once a pass has read it.
    picture_copy: Option<(wgpu::Texture, wgpu::TextureView)>,
    shown: Option<(wgpu::Texture, wgpu::TextureView)>,
    pub(super) accumulation_view: wgpu::TextureView,
    pub(super) depth_view: wgpu::TextureView,
    /// Textures of [`Target::Surfaces`], once shading was deferred.
    surfaces: Option<Vec<wgpu::TextureView>>,
    /// The depths that the key light sees, and their inputs; a texel that is never read until then.
    shadow_map: wgpu::TextureView,
    shadow_of: Option<ScenePacket>,
    /// The environment that physical shading reads, and its inputs; a texel until then.
    environment: wgpu::TextureView,
    environment_of: Option<Arc<PhysicalTables>>,
    /// Textures of the input images, once view-dependent texturing was used.
    pub(super) posed_images: Option<PhotoTextures>,
    /// Results of view-dependent texturing for each pixel, once holes that the input images do not show were filled.
    answers: Option<PhotoAnswers>,
}

impl Targets {
    /// Precondition: all edges at least 1 and at most [`Context::max_edge_px`].
    pub(super) fn new(context: &Context, sizes_px: SizesPx, precision: Precision) -> Self {
        let SizesPx {
            drawn: size_px,
            shown: shown_px,
        } = sizes_px;
        let texture = |label, format, usage| texture(context, size_px, label, format, usage);
        let none = wgpu::TextureUsages::empty();
        let color = texture("color", COLOR_FORMAT, wgpu::TextureUsages::COPY_SRC);
        let shown = shown_px.map(|shown_px| {
            let shown = textures::texture(context, shown_px, "shown", COLOR_FORMAT, wgpu::TextureUsages::COPY_SRC);
            let view = view(&shown);
            (shown, view)
        });
        let [of_sums] = Target::Sums.formats(precision) else {
            unreachable!("sums are one texture")
        };
        Self {
            size_px,
            shown_px,
            precision,
            shown,
            color_view: view(&color),
            color,
            picture_copy: None,
            accumulation_view: view(&texture("accumulation", *of_sums, none)),
            depth_view: view(&texture("depth", DEPTH_FORMAT, none)),
            surfaces: None,
            shadow_map: view(&textures::texture(context, [1; 2], "no shadow map", DEPTH_FORMAT, none)),
            shadow_of: None,
            environment: view(&textures::texture(
                context,
                [1; 2],
                "no environment",
                ENVIRONMENT_FORMAT,
                none,
            )),
            environment_of: None,
            posed_images: None,
            answers: None,
        }
    }

    /// Makes the texture of an environment unless it is there.
    pub(super) fn ensure_environment(&mut self, context: &Context, tables: &Arc<PhysicalTables>) {
        if self
            .environment_of
            .as_ref()
            .is_some_and(|known| Arc::ptr_eq(known, tables))
        {
            return;
        }
        let size_px = [PhysicalTables::WIDTH, PhysicalTables::HEIGHT].map(|edge| edge as u32);
        let texture = texture(
            context,
            size_px,
            "environment",
            ENVIRONMENT_FORMAT,
            wgpu::TextureUsages::COPY_DST,
        );
        let rows = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size_px[0] * size_of::<[f32; 4]>() as u32),
            rows_per_image: None,
        };
        let texels = bytemuck::cast_slice(&tables.texels);
        context
            .queue
            .write_texture(texture.as_image_copy(), texels, rows, texture.size());
        self.environment = view(&texture);
        self.environment_of = Some(Arc::clone(tables));
    }

    /// The shadow map of a lamp's view; `None` if it has that already.
    pub(super) fn outdated_shadow_map(&mut self, lamp_packet: &ScenePacket) -> Option<&wgpu::TextureView> {
        if self.shadow_of.as_ref() == Some(lamp_packet) {
            return None;
        }
        self.shadow_of = Some(lamp_packet.clone());
        Some(&self.shadow_map)
    }

    /// Makes the texture of the shadow map unless it is there.
    pub(super) fn ensure_shadow_map(&mut self, context: &Context) {
        let size_px = [Shadow::EDGE_PX; 2];
        let texture = self.shadow_map.texture();
        if [texture.width(), texture.height()] != size_px {
            let none = wgpu::TextureUsages::empty();
            self.shadow_map = view(&textures::texture(context, size_px, "shadow map", DEPTH_FORMAT, none));
        }
    }

    /// Makes the texture of a copy of the image unless it is there.
    pub(super) fn ensure_picture_copy(&mut self, context: &Context) {
        self.picture_copy.get_or_insert_with(|| {
            let usage = wgpu::TextureUsages::COPY_DST;
            let copy = texture(context, self.size_px, "copy of the picture", COLOR_FORMAT, usage);
            let view = view(&copy);
            (copy, view)
        });
    }

    /// Copies the image unchanged.
    pub(super) fn copy_picture(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some((copy, _)) = &self.picture_copy {
            encoder.copy_texture_to_texture(self.color.as_image_copy(), copy.as_image_copy(), copy.size());
        }
    }

    /// Returns the sizes that the targets were created for.
    pub(super) fn sizes_px(&self) -> SizesPx {
        SizesPx {
            drawn: self.size_px,
            shown: self.shown_px,
        }
    }

    /// The image shown.
    pub(super) fn picture(&self) -> (&wgpu::Texture, &wgpu::TextureView) {
        match &self.shown {
            Some((texture, view)) => (texture, view),
            None => (&self.color, &self.color_view),
        }
    }

    /// Makes the textures of [`Target::Surfaces`] unless they are there: only deferred shading pays for them.
    pub(super) fn ensure_surfaces(&mut self, context: &Context) {
        self.surfaces.get_or_insert_with(|| {
            let formats = Target::Surfaces.formats(self.precision).iter();
            let none = wgpu::TextureUsages::empty();
            formats
                .map(|&format| view(&texture(context, self.size_px, "surfaces", format, none)))
                .collect()
        });
    }

    /// Creates the textures for the per-pixel results of view-dependent texturing unless they exist.
    pub(super) fn ensure_photo_answers(&mut self, context: &Context) {
        self.answers
            .get_or_insert_with(|| PhotoAnswers::new(context, self.size_px));
    }

    /// Returns the coarsest level of the pyramid over the view-dependent texturing results; 0 until it exists.
    pub(super) fn coarsest_photo_level(&self) -> usize {
        self.answers.as_ref().map_or(0, PhotoAnswers::coarsest)
    }

    /// Returns the texture views that a pass draws into; for a pyramid, the ones of `level`. Precondition for surfaces:
    /// [`Targets::ensure_surfaces`], for view-dependent texturing results: [`Targets::ensure_photo_answers`].
    pub(super) fn views(&self, target: Target, level: usize) -> Vec<&wgpu::TextureView> {
        match target {
            Target::Picture => vec![&self.color_view],
            Target::Sums => vec![&self.accumulation_view],
            Target::Surfaces => self.surfaces.iter().flatten().collect(),
            Target::PhotoAnswers => self.answers.iter().flat_map(PhotoAnswers::finest).collect(),
            Target::PhotoLevel => self.photo_level(level),
            Target::Shown => self.shown.iter().map(|(_, view)| view).collect(),
        }
    }

    /// Returns the texture views that a screen-space pass reads when it draws into `level`, with the same
    /// preconditions.
    pub(super) fn sources(&self, source: Source, level: usize) -> Vec<&wgpu::TextureView> {
        match source {
            Source::Picture => vec![&self.color_view],
            Source::PictureCopy => self.picture_copy.iter().map(|(_, view)| view).collect(),
            Source::Sums => vec![&self.accumulation_view, &self.depth_view],
            Source::Depths => vec![&self.depth_view],
            Source::Surfaces => self.surface_sources().collect(),
            Source::Textured => {
                let posed_images = self.posed_images.iter().flat_map(PhotoTextures::views);
                self.surface_sources().chain(posed_images).collect()
            }
            Source::TexturedSums => {
                let mut sources = self.sources(Source::Textured, level);
                sources[ENVIRONMENT] = &self.accumulation_view;
                sources
            }
            Source::PhotoAnswers => {
                let table = self.posed_images.iter().map(PhotoTextures::table);
                let answers = self.answers.iter().flat_map(PhotoAnswers::finest);
                self.surface_sources().chain(table).chain(answers).collect()
            }
            Source::FinerLevel => self.photo_level(level - 1),
            Source::CoarserLevel => self.photo_level(level + 1),
        }
    }

    fn photo_level(&self, level: usize) -> Vec<&wgpu::TextureView> {
        self.answers.iter().map(|answers| answers.level(level)).collect()
    }

    fn surface_sources(&self) -> impl Iterator<Item = &wgpu::TextureView> {
        let others = [&self.depth_view, &self.shadow_map, &self.environment];
        self.surfaces.iter().flatten().chain(others)
    }
}
