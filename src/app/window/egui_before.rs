//! egui outlives the device that painted it.

use egui_winit::accesskit_winit;

/// State of egui that survives a lost device.
pub(super) struct EguiBefore {
    pub(super) context: egui::Context,
    /// The window's, which has one for good.
    pub(super) accessibility: Option<accesskit_winit::Adapter>,
}
