//! Backdrop of the cloud: background and ground grid.

use super::background::Background;
use super::describe::{Section, Values, group};

group! {
    /// Backdrop settings: the surroundings of the cloud.
    Backdrop {
        /// Background behind the cloud.
        background: Background = Background::default(), "background" BACKGROUND {
            // The option also accepts a value that no style has: `transparent`.
            value_name: "COLOR",
            help: "Background: a preset, #rrggbb or a gradient #rrggbb-#rrggbb (transparent: for image files)",
            everyday: true,
            title: "Preset",
            hint: "Background behind the cloud",
            section: Section::Background,
            full_name: "Background",
            also: &["backdrop", "clear colour", "canvas"],
            values: Values::Background,
        }
        /// Visibility of the ground grid.
        grid: bool = false, "grid" GRID {
            flag: "grid",
            help: "Draw a ground grid",
            everyday: true,
            title: "Ground",
            hint: "Lines on the plane below the cloud; a cell is a power of ten wide (G)",
            section: Section::Background,
            full_name: "Grid on the ground",
            also: &["ground plane", "floor", "axes"],
            values: Values::Switch("Grid"),
        }
    }
}
