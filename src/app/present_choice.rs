//! How a picture that the processor drew comes onto the screen.

use crate::scene::choices;

choices! {
    /// Who brings the window's picture onto the screen.
    #[derive(Default)]
    PresentChoice, "way to present" {
        #[default]
        Auto = "auto", "Automatic", "The GPU if there is a hardware one, else the CPU";
        Gpu = "gpu", "GPU", "The adapter of the graphics library, be it a software one";
        Cpu = "cpu", "CPU", "The CPU, without any driver: only changed parts are painted";
    }
}
