//! Rendered images: the next one to draw, and those that were drawn.

use super::State;
use crate::app::drawing::Drawing;
use crate::app::meter::Redraw;
use crate::composition::{Composed, PictureView, photos_apply};
use crate::render::RenderStats;
use crate::scene::{Primitive, ScenePacket, Style};
use crate::sequence::PreparedFrame;
use std::sync::Arc;

impl State {
    /// The frame that is drawn: the shown one, or one derived from it and other frames.
    pub(in crate::app) fn drawn_frame(&self) -> Option<&Arc<PreparedFrame>> {
        let made = self.features.temporal.shown().map(|made| &made.composed().frame);
        made.or_else(|| self.player.as_ref()?.shown())
    }

    /// Returns true if an image that is coarse because the camera moved is due to be redrawn in full.
    pub(in crate::app) fn is_picture_due(&self) -> bool {
        let of_b = self.features.split_view.as_ref().map(|split_view| &split_view.drawing);
        let drawings = [Some(&self.main.drawing), of_b];
        let mut deadlines = drawings.into_iter().flatten().filter_map(Drawing::next_deadline);
        deadlines.any(|deadline| deadline <= self.shared.now)
    }

    /// Returns true if the image is a coarse one because the camera moved.
    pub(in crate::app) fn is_picture_coarse(&self) -> bool {
        self.main.drawing.next_deadline().is_some()
    }

    /// Returns the progress of the surface for view-dependent texturing, in words, while it is being built and the
    /// images are to be shown. Multi-view video does not wait for one.
    pub(in crate::app) fn surface_on_its_way(&self) -> Option<String> {
        let text = self.features.photos.loading()?;
        self.waits_for_surface(&self.drawn_style()).then_some(text)
    }

    fn waits_for_surface(&self, style: &Style) -> bool {
        let is_single = self.player.as_ref().is_some_and(|player| player.sequence().len() == 1);
        is_single && style.draws_photos()
    }

    /// The packet to draw, if it differs from the last one.
    pub fn next_packet(&mut self) -> Option<ScenePacket> {
        let player = self.player.as_ref()?;
        let pose = player.shown()?;
        let made = self.features.temporal.shown();
        let composed = made.map_or_else(|| Composed::of(Arc::clone(pose)), |made| made.composed().clone());
        if self.viewport.size_px.contains(&0) {
            return None;
        }
        let origin = player.sequence().origin();
        let mut style = self.drawn_style();
        let shows_photos = photos_apply(&self.features.temporal.options(), &style);
        let waits_for_surface = shows_photos && self.waits_for_surface(&style);
        let set = player.posed_images();
        let set = set.filter(|_| shows_photos);
        let textured = self.features.photos.drawn(&composed.frame, set.as_ref(), &style);
        if self.style.primitive.is_open() && waits_for_surface && textured.is_none() {
            // A few thousand points do not form a surface before it has been estimated.
            style.primitive = Primitive::Point;
        }
        let composed = match textured {
            Some(with) if Arc::ptr_eq(with.bare(), &composed.frame) => with.composed(&composed.pose),
            // A stand-in for one that is being built.
            Some(with) => with.composed(with.bare()),
            None => composed,
        };
        self.main.note_choice(self.style.drawing.renderer);
        let view = PictureView {
            camera: &self.camera,
            origin,
            size_px: self.viewport.size_px,
        };
        let packet = self
            .main
            .drawing
            .next_packet(composed, &view, &style, self.shared.now)?;
        self.shared.counters.pictures += 1;
        self.note_picture();
        Some(packet)
    }

    /// Records the time of a redraw whose image is on the screen now.
    pub fn note_redraw(&mut self, redraw: Redraw, frame_ms: f64, render: RenderStats) {
        self.graphics.redraw = redraw;
        self.graphics.frame_ms = frame_ms;
        self.graphics.render = render;
        let draw_ms = self.graphics.picture_ms();
        let style = self.drawn_style();
        let Some(player) = &self.player else { return };
        let noted = self.main.drawing.note_draw_ms(draw_ms);
        // A stand-in for a frame that is still loading says nothing about the draw time of that frame, and building
        // levels for it would get in the way.
        let is_partial = player.is_partial();
        if let Some(points) = noted.filter(|_| !is_partial) {
            player.note_picture_ms(points, draw_ms);
        }
        let is_at_rest = !player.is_playing() && !is_partial;
        let (tasks, now) = (&self.shared.tasks, self.shared.now);
        self.main.drawing.prepare(&style, is_at_rest, tasks, now);
        if let Some(split_view) = &mut self.features.split_view {
            if let Some(points) = split_view.drawing.note_draw_ms(draw_ms) {
                split_view.companion.note_picture_ms(points, draw_ms);
            }
            split_view.drawing.prepare(&style, is_at_rest, tasks, now);
        }
    }

    /// The packet of the other side of a comparison, or of the other sequence, if it differs from the last one. To be
    /// called after [`State::next_packet`].
    pub fn next_other_packet(&mut self) -> Option<ScenePacket> {
        if self.features.split_view.is_some() {
            return self.next_packet_second();
        }
        let other = self.features.comparison.as_ref()?.other;
        let style_of_a = self.drawn_style();
        let mut style = self.resolved(&other);
        style.of_sequence.clip = self.style.clip;
        let comparison = self.features.comparison.as_mut()?;
        let player = self.player.as_ref()?;
        let set = player.posed_images();
        let shown = player.shown()?;
        // Disks of the other side may be of any size: its renderer draws its own depths.
        let textured = self.features.photos.drawn(shown, set.as_ref(), &style_of_a);
        let frame = textured.map_or(shown, |with| with.frame());
        if self.viewport.size_px.contains(&0) {
            return None;
        }
        let view = PictureView {
            camera: &self.camera,
            origin: player.sequence().origin(),
            size_px: self.viewport.size_px,
        };
        let packet = comparison.next_packet(frame, &view, &style)?;
        comparison.pictures.note_change(self.shared.now);
        Some(packet)
    }

    /// Forgets drawn images: after a new GPU device everything is drawn again.
    pub fn forget_picture(&mut self) {
        self.main.drawing.forget_picture();
        self.features.thumbnails.forget_textures();
        if let Some(comparison) = &mut self.features.comparison {
            comparison.forget_picture();
        }
        if let Some(split_view) = &mut self.features.split_view {
            split_view.drawing.forget_picture();
        }
    }
}
