//! Presentation of CPU-rendered images on the screen.

use crate::scene::choices;

choices! {
    /// Presentation backend of the window: the renderer that brings its image onto the screen.
    #[derive(Default)]
    PresentChoice, "way to present" {
        #[default]
        Auto = "auto", "Automatic", "The GPU if there is a hardware one, else the CPU";
        Gpu = "gpu", "GPU", "The adapter of the graphics library, be it a software one";
        Cpu = "cpu", "CPU", "The CPU, without any driver: only changed parts are painted";
    }
}
