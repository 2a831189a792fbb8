//! Drawing settings: the primitive that points become, and the renderer.

use super::Choice;
use super::choices::choices;
use super::describe::{Label, Numbers, Place, Typed, Unit, Values, group};

choices! {
    /// Primitive that a point is rendered as. If left open, [`FirstLook`](crate::scene::FirstLook) decides.
    Primitive, "primitive", auto Surfel = "Auto", "Surfels where the points sample a surface, else points" {
        /// The 4D media paper §V.
        // The default, not ellipses: on evenly sampled shapes these take just as long to draw and are not closer to the
        // ground truth (saddle: FLIP 0.0390, disks 0.0386), and a frame takes nearly three times as long to prepare.
        Surfel = "surfel", "Surfels", "Oriented disks with a Gaussian mask, blended where they overlap",
            also ["splats", "disks", "surface splats"];
        /// Sainz and Pajarola 2004 §4.
        Ellipse = "ellipse", "Ellipses", "Oriented ellipses: as surfels, but longer where points are farther apart",
            also ["ellipsoids", "gaussian splats", "anisotropic"];
        /// Sainz and Pajarola 2004 §5.1.
        Sprite = "sprite", "Sprites", "The disks of surfels on squares that face the screen: exact in every pixel",
            also ["billboards", "impostors"];
        /// Sainz and Pajarola 2004, Figs. 5 and 6.
        Mesh = "mesh", "Mesh", "The triangles of the file, where it has some, and the points between them",
            also ["wireframe", "triangles", "surface", "faces", "polygons"];
        /// The 4D media paper §VI.
        Voxel = "voxel", "Voxels", "Cubes of the octree's cells, as fine as the image needs",
            also ["cubes", "octree", "blocks"];
        Point = "point", "Points", "Squares or disks that face the screen; plain ones are the fastest",
            also ["dots", "vertices", "point cloud"];
    }
}

choices! {
    /// Renderer choice.
    RendererChoice, "renderer", auto Cpu = "Automatic", "The GPU if there is a hardware one, else the CPU" {
        Gpu = "gpu", "GPU", "The adapter of the graphics library, even a software one";
        Cpu = "cpu", "CPU", "The CPU, without instancing";
    }
}

impl RendererChoice {
    /// Returns the CPU or the GPU renderer.
    pub fn of(is_processor: bool) -> Self {
        if is_processor { Self::Cpu } else { Self::Gpu }
    }
}

impl Choice<RendererChoice> {
    /// Returns true if the CPU draws, given whether the adapter is a software one that draws there too, or a GPU.
    pub fn is_processor(self, adapter_is_software: bool) -> bool {
        match self {
            Self::Auto => adapter_is_software,
            Self::Is(chosen) => chosen == RendererChoice::Cpu,
        }
    }
}

choices! {
    /// Instancing strategy: how instances reach the vertex stage (the 4D media paper §IV). Their GPU implementations
    /// are in `render/gpu/instancing`.
    Strategy, "instancing strategy" {
        Storage = "storage", "Storage buffer", "Records pulled from a storage buffer";
        Uniform = "uniform", "Uniform buffers", "Records in 64 KiB uniform buffers, one draw for each";
        Texture = "texture", "Texture", "Records fetched as texels";
        Vertex = "vertex", "Vertex attributes", "Records as attributes stepped per instance";
        /// Replacement for the geometry shader.
        Compute = "compute", "Compute", "A compute pass writes the quads and cubes; one indirect draw";
    }
}

choices! {
    /// Antialiasing mode for jagged edges.
    Antialiasing, "way of antialiasing" {
        None = "none", "None", "One sample per pixel, at its centre";
        /// Lottes 2009.
        Fxaa = "fxaa", "FXAA", "Smooths edges in the finished image";
        Supersample = "supersample", "Supersampling", "Renders four pixels for each and averages them",
            also ["ssaa", "msaa"];
    }
}

impl Antialiasing {
    /// Maximum number of search steps along an edge for its end.
    pub const FXAA_SEARCH_STEPS: u32 = 16;

    /// Pixels drawn per pixel shown, along both edges of the image.
    pub const fn samples_per_edge(self) -> u32 {
        match self {
            Self::None | Self::Fxaa => 1,
            Self::Supersample => 2,
        }
    }

    /// Returns the halo in pixels: how many pixels around one it depends on.
    pub(in crate::scene) fn halo_px(self) -> u32 {
        match self {
            // Next to the end of an edge its corners count.
            Self::Fxaa => Self::FXAA_SEARCH_STEPS + 1,
            Self::None | Self::Supersample => 0,
        }
    }

    /// Returns the antialiasing mode for images without a background: the lightness of the background would change
    /// which edges FXAA finds.
    #[must_use]
    pub fn without_background(self) -> Self {
        match self {
            Self::Fxaa => Self::Supersample,
            chosen => chosen,
        }
    }
}

group! {
    /// Drawing settings: the renderer, and the number of pixels.
    DrawingSettings decided DrawingStyle {
        /// Renderer.
        renderer: Choice<RendererChoice> = Choice::Auto, "renderer" RENDERER {
            flag: "renderer",
            value_name: "RENDERER",
            help: "Render on the GPU or the CPU (auto: a hardware GPU if there is one)",
            everyday: true,
            title: "Renderer",
            hint: "Renderer: both draw the same image",
            label: Label::Always(Place::Who, "{title}"),
            also: &["rasterizer", "software rendering", "backend", "hardware acceleration", "graphics card"],
            values: Values::Words(Choice::<RendererChoice>::WORDS),
        }
        /// Instancing strategy: how instances reach the GPU.
        strategy: Strategy = Strategy::Storage, "strategy" STRATEGY {
            flag: "instancing",
            value_name: "STRATEGY",
            help: "Pass instances to the GPU in this way (same image, different speed)",
            title: "Instancing",
            hint: "How instances reach the GPU's vertex stage. All strategies draw the same picture; their speed \
                   differs",
            label: Label::If(|drawn| drawn.is_drawn_on_gpu(), Place::Who, "{}"),
            values: Values::Words(Strategy::WORDS),
        }
        /// Edge of the drawn image, as a share of the shown one's: below 1 fewer pixels are drawn and scaled up.
        resolution: f32 = 1.0, "resolution" RESOLUTION {
            flag: "render-scale",
            other_flags: &["resolution"],
            value_name: "0.25..1",
            help: "Render at a fraction of the image size and upscale",
            title: "Resolution",
            hint: "Edge of the picture that is drawn, as a share of the one that is shown: at 50 % a quarter of the \
                   pixels are drawn and scaled up",
            label: Label::Unusual(Place::HowFine, "at {}"),
            also: &["render scale", "pixel ratio", "quality", "downscale"],
            values: Values::Number(Numbers {
                retained: [0.25, 1.0],
                offered: [0.25, 1.0],
                typed: Typed::Retained("a share from 0.25 to 1"),
                unit: Unit::Share,
                ..Numbers::USUAL
            }),
        }
        /// Antialiasing mode for jagged edges.
        antialiasing: Antialiasing = Antialiasing::None, "antialiasing" ANTIALIASING {
            flag: "antialiasing",
            value_name: "METHOD",
            help: "Antialiasing method",
            everyday: true,
            title: "Antialiasing",
            hint: "Smooths jaggies: supersampling renders four times the pixels, FXAA filters the finished image",
            label: Label::Unusual(Place::HowFine, "with {title}"),
            also: &["aa", "msaa", "smooth edges", "jaggies", "aliasing"],
            values: Values::Words(Antialiasing::WORDS),
        }
    }
}
