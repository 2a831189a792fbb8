//! Screen readers and other assistive technology: their requests to the window.

use super::App;
use egui_winit::accesskit_winit;

impl App {
    pub(super) fn serve_screen_reader(&mut self, event: accesskit_winit::WindowEvent) {
        let Some(screen) = &mut self.screen else {
            return;
        };
        match event {
            accesskit_winit::WindowEvent::InitialTreeRequested => {
                self.is_read_aloud = true;
                screen.egui.enable_accesskit();
            }
            accesskit_winit::WindowEvent::ActionRequested(request) => {
                screen.input.on_accesskit_action_request(request);
            }
            accesskit_winit::WindowEvent::AccessibilityDeactivated => {
                self.is_read_aloud = false;
                screen.egui.disable_accesskit();
            }
        }
        screen.window.request_redraw();
    }
}
