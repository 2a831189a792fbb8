//! How a picture that the processor drew comes onto the screen.

use crate::scene::choices;

choices! {
    /// Who brings the window's picture onto the screen.
    #[derive(Default)]
    PresentChoice, "way to present" {
        /// The processor where there is no real GPU, else the graphics library.
        #[default]
        Auto = "auto",
        /// The graphics library, whatever its adapter is.
        Gpu = "gpu",
        /// The processor, without any driver.
        Cpu = "cpu",
    }
}
