//! Messages sent to the event loop from elsewhere.

use egui_winit::accesskit_winit;

/// News for the window.
#[derive(Debug)]
pub(super) enum Message {
    /// Workers or tasks have something new.
    Wake,
    /// A signal asks the program to end.
    End,
    /// A screen reader, or another program that helps people, wants to know or to do something.
    Accessibility(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Message {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Accessibility(event)
    }
}
