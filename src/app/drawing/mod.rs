//! An image of a frame in the window: the packet that it is drawn from, and its inputs.

pub(super) mod in_view;
pub(super) mod levels;

use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{Composed, PictureView, StandIns, can_draw, packet, with_stand_ins};
use crate::scene::{Camera, Pick, Primitive, Scene, ScenePacket, SceneStats, ScreenStats, Style, hidden, pick};
use crate::sequence::PreparedFrame;
use egui::{Pos2, Rect, Vec2};
use glam::{DVec2, DVec3};
use in_view::{InView, SurfelsInView};
use levels::{FrameWithLevels, Levels};
use std::sync::Arc;
use std::time::Duration;

/// Pick radius: maximum distance of a click from its target, points.
const PICK_RADIUS: f32 = 6.0;

/// An image that follows frame, camera and settings.
#[derive(Debug)]
pub(in crate::app) struct Drawing {
    scene: Scene,
    packet: Option<ScenePacket>,
    /// The frame of the packet, and the origin of its positions.
    drawn: Option<(Composed, DVec3)>,
    primitive: Primitive,
    /// Levels of detail for coarser images while the camera moves.
    levels: Levels,
    /// Substitute for surfels that are not available.
    surfels_in_view: SurfelsInView,
    /// The last redraw had a new image, whose time has not been evaluated.
    is_new: bool,
}

impl Default for Drawing {
    fn default() -> Self {
        Self {
            scene: Scene::that_remembers(),
            packet: None,
            drawn: None,
            primitive: Primitive::Point,
            levels: Levels::default(),
            surfels_in_view: SurfelsInView::default(),
            is_new: false,
        }
    }
}

impl Drawing {
    /// Counters of the traversal.
    pub(in crate::app) fn stats(&self) -> SceneStats {
        self.scene.stats()
    }

    /// Returns statistics of the screen-space normals, if the last image has such.
    pub(in crate::app) fn screen_stats(&self) -> Option<ScreenStats> {
        self.scene.screen_stats()
    }

    /// Records the time of the last image, unless done already. Then returns the number of points of its frame, if the
    /// image was of all of them.
    pub(in crate::app) fn note_draw_ms(&mut self, draw_ms: f64) -> Option<usize> {
        if !std::mem::take(&mut self.is_new) {
            return None;
        }
        let (packet, (drawn, _)) = self.packet.as_ref().zip(self.drawn.as_ref())?;
        self.scene.note_draw_ms(&packet.style, draw_ms);
        // Triangles are drawn regardless of the number of points.
        if self.levels.are_drawn() || packet.content.mesh().is_some() {
            return None;
        }
        self.levels.note_whole_picture(&drawn.frame, draw_ms);
        Some(drawn.frame.frame.len())
    }

    /// Starts to prepare the data that the next images lack: levels of detail for a frame at rest that takes long to
    /// draw, so that the camera moves smoothly; surfels of the visible part at `now`, where the frame has none.
    pub(in crate::app) fn prepare<T>(&mut self, style: &Style, is_at_rest: bool, tasks: &Tasks<T>, now: Duration)
    where
        T: TaskOutcome + From<FrameWithLevels> + From<Arc<InView>>,
    {
        if let Some((drawn, _)) = self.drawn.as_ref().filter(|_| is_at_rest) {
            self.levels.prepare(&drawn.frame, style, tasks);
        }
        self.surfels_in_view.prepare(tasks, now);
    }

    /// Takes surfels in view that were made.
    pub(in crate::app) fn take_surfels_in_view(&mut self, made: &Arc<InView>) {
        self.surfels_in_view.take(made);
    }

    /// Returns true if the last image shows surfels, including surfels of the view alone.
    pub(in crate::app) fn has_surfels(&self) -> bool {
        self.packet
            .as_ref()
            .is_some_and(|packet| packet.style.draws_surfels() && packet.content.has_shapes())
    }

    /// Takes levels of detail that were made.
    pub(in crate::app) fn take_levels(&mut self, frame: &Arc<PreparedFrame>) {
        self.levels.take(frame);
    }

    /// Time at which a coarse image of a moving camera is to be refined, or one of points to become surfels.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        let levels = self.levels.next_deadline().into_iter();
        levels.chain(self.surfels_in_view.next_deadline()).min()
    }

    /// The packet to draw at `now`, if it differs from the last one. Until the frame has the data of the primitive, it
    /// is shown as before.
    pub(in crate::app) fn next_packet(
        &mut self,
        composed: Composed,
        view: &PictureView<'_>,
        style: &Style,
        now: Duration,
    ) -> Option<ScenePacket> {
        let in_view = self.surfels_in_view.choose(&composed.frame, view, style, now);
        let whole = in_view.as_ref().unwrap_or(&composed.frame);
        let coarse = self.levels.choose(whole, view.camera, style, now);
        let composed = with_stand_ins(composed, style, StandIns { in_view, coarse });
        let mut style = composed.coarse.as_ref().map_or(*style, |coarse| coarse.style);
        if !can_draw(&composed.frame, &style) {
            style.primitive = self.primitive;
            if !can_draw(&composed.frame, &style) {
                style.primitive = Primitive::Point;
            }
        }
        let packet = packet(&mut self.scene, &composed, view, &style);
        if self.packet.as_ref() == Some(&packet) {
            return None;
        }
        self.primitive = style.primitive;
        self.drawn = Some((composed, view.origin));
        self.packet = Some(packet.clone());
        self.is_new = true;
        Some(packet)
    }

    /// Returns true if there is a rendered image.
    pub(in crate::app) fn is_drawn(&self) -> bool {
        self.packet.is_some()
    }

    /// Forgets the drawn image, which is then drawn again.
    pub(in crate::app) fn forget_picture(&mut self) {
        self.packet = None;
    }

    /// Forgets the pickable points.
    pub(in crate::app) fn forget_frame(&mut self) {
        self.drawn = None;
        self.surfels_in_view = SurfelsInView::default();
    }

    /// Occlusion test: returns for each of these positions, in the coordinates of the file, true if it is behind the
    /// surfaces of the last image, as `camera` saw it.
    pub(in crate::app) fn hides(&self, camera: &Camera, places: &[DVec3]) -> Vec<bool> {
        let Some((packet, (_, origin))) = self.packet.as_ref().zip(self.drawn.as_ref()) else {
            return vec![false; places.len()];
        };
        // Points behind the eye are not in the image.
        let seen = places.iter().map(|&place| {
            let px = camera.to_px(place, packet.viewport_px);
            (place - origin, px.unwrap_or(DVec2::NEG_ONE))
        });
        hidden(packet, &seen.collect::<Vec<_>>())
    }

    /// The point under `place` of the image over `rect`, and its frame, as they were drawn last.
    pub(in crate::app) fn point_at(&self, place: Pos2, rect: Rect) -> Option<(Pick, Arc<PreparedFrame>)> {
        let (packet, (drawn, origin)) = self.packet.as_ref().zip(self.drawn.as_ref())?;
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
            ..Pick::of(&drawn.pose, *origin, slot)?
        };
        Some((pick, Arc::clone(&drawn.pose)))
    }
}
