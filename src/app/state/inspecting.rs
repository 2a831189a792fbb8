//! What clicks on the picture do, and the camera moving by itself.

use super::{State, WindowRequest};
use crate::app::inspection::Tool;
use crate::app::motion::Glide;
use crate::scene::{Camera, Pick, Projection, pick};
use crate::sequence::PreparedFrame;
use egui::{Pos2, Vec2};
use std::sync::Arc;

/// A click may be so far beside what it is meant for, points.
const PICK_RADIUS: f32 = 6.0;

/// Focusing on a point comes so much closer.
const FOCUS_CLOSER: f64 = 0.5;

impl State {
    /// The point under a place of the window, and the frame that it is of, as they were drawn last.
    fn point_at(&self, place: Pos2) -> Option<(Pick, Arc<PreparedFrame>)> {
        let (packet, drawn) = self.packet.as_ref().zip(self.drawn_frame.as_ref())?;
        let rect = self.viewport.rect;
        if !rect.contains(place) || rect.area() == 0.0 {
            return None;
        }
        let [width, height] = packet.viewport_px.map(|edge| edge as f32);
        let px_per_point = Vec2::new(width, height) / rect.size();
        let place_px = (place - rect.min) * px_per_point;
        let radius_px = f64::from(PICK_RADIUS * px_per_point.y);
        let place_px = [place_px.x, place_px.y].map(f64::from);
        let slot = pick(packet, &drawn.frame, place_px, radius_px)?;
        let [red, green, blue, _] = drawn.frame.points[slot].color;
        let slot = drawn.slot_in_pose(slot)?;
        let pick = Pick {
            drawn_color: [red, green, blue],
            ..Pick::of(&drawn.pose, drawn.origin, slot)?
        };
        Some((pick, Arc::clone(&drawn.pose)))
    }

    /// Gives the point under a place of the window to the chosen tool; nothing if there is none.
    pub fn click_at(&mut self, place: Pos2) {
        if self.inspection.tool == Tool::Camera {
            return;
        }
        if let Some((pick, frame)) = self.point_at(place) {
            self.inspection.take(pick, &frame);
        }
    }

    /// Brings the point under a place of the window into the middle, and closer; false if there is none.
    pub fn focus_at(&mut self, place: Pos2) -> bool {
        let Some((pick, _)) = self.point_at(place) else {
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

    /// [`State::focus_at`] for what the pointer is over.
    pub(super) fn focus_at_pointer(&mut self) {
        if let Some(place) = self.viewport.pointer {
            self.focus_at(place);
        }
    }

    fn glide_to(&mut self, camera: Camera) {
        self.glide = Some(Glide::new(self.camera, camera, self.now));
    }

    /// Moves a gliding or turning camera on; true if it moved.
    pub(super) fn move_camera_on(&mut self) -> bool {
        let before = self.camera;
        if let Some(glide) = &mut self.glide
            && !glide.step(&mut self.camera, self.now)
        {
            self.glide = None;
        }
        self.turntable.step(&mut self.camera, self.now);
        self.move_on_path();
        self.camera != before
    }

    /// True while [`State::move_camera_on`] has something to do.
    pub(super) fn camera_moves(&self) -> bool {
        self.glide.is_some() || self.turntable.is_on || self.path.is_playing()
    }

    pub(super) fn toggle_projection(&mut self) {
        self.camera.projection = match self.camera.projection {
            Projection::Perspective => Projection::Orthographic,
            Projection::Orthographic => Projection::Perspective,
        };
    }

    pub(super) fn copy_view(&mut self) {
        let text = self.camera.to_string();
        self.requests.push(WindowRequest::Copy(text));
        self.notices.info("The view was copied as text");
    }

    /// Puts the camera where a text says that [`Command::CopyView`](crate::app::Command::CopyView) made.
    pub fn paste_view(&mut self, text: &str) {
        match text.parse() {
            Ok(camera) => {
                self.camera = camera;
                self.framed = true;
            }
            Err(error) => self
                .notices
                .error(format!("The view was not pasted: {error}")),
        }
    }

    /// Takes copying and pasting out of egui's input, unless text is selected or typed.
    pub(super) fn handle_clipboard(&mut self, ctx: &egui::Context) {
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
