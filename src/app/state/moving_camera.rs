//! Camera moves to the pointed-at position, and automatic motion.

use super::{State, WindowRequest};
use crate::app::motion::Glide;
use crate::scene::{Camera, Projection};
use egui::Pos2;

/// Focusing on a point comes so much closer.
const FOCUS_CLOSER: f64 = 0.5;

impl State {
    /// Moves the point under a window position to the centre of the view, and closer; returns false if there is none.
    pub fn focus_at(&mut self, place: Pos2) -> bool {
        let Some((pick, ..)) = self.point_at(place) else {
            return false;
        };
        let camera = &self.camera;
        let distance = match camera.projection {
            Projection::Perspective => camera.eye_in_world().distance(pick.position),
            Projection::Orthographic => camera.distance,
        };
        self.glide_to(Camera {
            target_in_world: pick.position,
            distance: FOCUS_CLOSER * distance,
            ..*camera
        });
        true
    }

    /// [`State::focus_at`] for the position of the pointer.
    pub(in crate::app) fn focus_at_pointer(&mut self) {
        if let Some(place) = self.viewport.pointer {
            self.focus_at(place);
        }
    }

    pub(in crate::app) fn glide_to(&mut self, camera: Camera) {
        self.motion.glide = Some(Glide::new(self.camera, camera, self.shared.now));
    }

    /// Moves a gliding or turning camera on; true if it moved.
    pub(in crate::app) fn move_camera_on(&mut self) -> bool {
        let before = self.camera;
        if let Some(glide) = &mut self.motion.glide
            && !glide.step(&mut self.camera, self.shared.now)
        {
            self.motion.glide = None;
        }
        self.motion.turntable.step(&mut self.camera, self.shared.now);
        self.move_on_path();
        self.camera != before
    }

    /// True while [`State::move_camera_on`] has something to do.
    pub(in crate::app) fn camera_moves(&self) -> bool {
        self.motion.glide.is_some() || self.motion.turntable.is_on || self.features.path.is_playing()
    }

    pub(in crate::app) fn toggle_projection(&mut self) {
        self.camera.projection = match self.camera.projection {
            Projection::Perspective => Projection::Orthographic,
            Projection::Orthographic => Projection::Perspective,
        };
    }

    pub(in crate::app) fn copy_view(&mut self) {
        let text = self.camera.to_string();
        self.shared.requests.push(WindowRequest::Copy(text));
        self.notices.info("The view was copied as text");
    }

    /// Sets the camera from a text made by [`Command::COPY_VIEW`](crate::app::Command::COPY_VIEW).
    pub fn paste_view(&mut self, text: &str) {
        match text.parse() {
            Ok(camera) => {
                self.camera = camera;
                if self.first_look().is_none() {
                    self.shared.options.view = Some(camera);
                }
            }
            Err(error) => self.notices.error(format!("The view was not pasted: {error}")),
        }
    }

    /// Takes copying and pasting out of egui's input, unless text is selected or typed.
    pub(in crate::app) fn handle_clipboard(&mut self, ctx: &egui::Context) {
        use egui::text_selection::LabelSelectionState;
        let selection = ctx.plugin_opt::<LabelSelectionState>();
        let has_selection = selection.is_some_and(|selection| selection.lock().has_selection());
        if ctx.text_edit_focused() {
            return;
        }
        let mut copies = false;
        let mut pasted = None;
        ctx.input_mut(|input| {
            input.events.retain(|event| {
                match event {
                    egui::Event::Copy if !has_selection => copies = true,
                    egui::Event::Paste(text) => pasted = Some(text.clone()),
                    _ => return true,
                }
                false
            });
        });
        if copies {
            self.copy_view();
        }
        if let Some(text) = pasted {
            self.paste_view(&text);
        }
    }
}
