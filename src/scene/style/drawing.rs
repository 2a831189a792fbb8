//! What points become, and who draws them.

use super::choices::choices;

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
