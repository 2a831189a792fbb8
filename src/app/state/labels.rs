//! Labels in the window: put by clicks, followed, shown.

use super::State;
use crate::app::features::inspection::Tool;
use crate::app::features::labels::panel;
use crate::app::side::Side;
use crate::export::draw_labels;
use crate::playback::Player;
use crate::scene::{Camera, FollowedPoint, Label, LabelOnPicture, Pick};
use crate::sequence::PreparedFrame;
use crate::timeline::PlayRange;
use image::RgbaImage;

impl State {
    /// Puts a label at a point of `frame`, which is of the sequence `side`.
    pub(super) fn put_label(&mut self, side: Side, pick: &Pick, frame: &PreparedFrame) {
        if side == Side::B {
            let text = "Labels are put at points of the open sequence, not of the one beside it";
            return self.notices.hint(text);
        }
        let label = Label {
            text: String::new(),
            frame: pick.frame,
            point: Some(FollowedPoint {
                index_in_file: pick.index_in_file,
                points_in_file: Some(frame.frame.points_in_file()),
            }),
            place: Some(pick.position),
            frames: PlayRange::default(),
        };
        if !self.labels.put(label) {
            return self.notices.warn("There are 1000 labels: delete one first");
        }
        self.panels.set(panel::PANEL, true);
    }

    /// Begins to put labels by clicks, with the list beside, or ends that.
    pub(super) fn toggle_tool(&mut self, tool: Tool) {
        self.inspection.toggle(tool);
        if self.inspection.tool == Tool::Label {
            self.panels.set(panel::PANEL, true);
        }
    }

    /// Looks where labels are in the frame that is shown, and what hides them. True if the picture that is drawn next
    /// may hide others.
    pub(in crate::app) fn follow_labels(&mut self) -> bool {
        let Some((player, frame)) = self.player.as_ref().and_then(|player| Some((player, player.shown()?))) else {
            return false;
        };
        self.labels.follow(frame, player.sequence().origin());
        if !self.labels.are_shown() {
            return false;
        }
        let (drawing, camera) = (&self.main.drawing, &self.camera);
        let picture = self.counters.pictures;
        self.labels
            .note_hidden(picture, camera, |places| drawing.hides(camera, places))
    }

    /// A picture of the open sequence with the labels that are in the window.
    pub(super) fn with_labels(&self, mut picture: RgbaImage) -> RgbaImage {
        let size_px = picture.dimensions().into();
        let shown = self.labels.in_picture().into_iter().enumerate();
        let on_picture = shown.filter_map(|(label, (place, text, is_hidden))| {
            let px = self.camera.to_px(place, size_px)?;
            Some((LabelOnPicture { label, px, is_hidden }, text.to_owned()))
        });
        draw_labels(&mut picture, &on_picture.collect::<Vec<_>>());
        picture
    }

    /// Shows a label: its frame, and its place in the middle of the picture.
    pub(in crate::app) fn go_to_label(&mut self, index: usize) {
        let Some(label) = self.labels.list.get(index) else {
            return;
        };
        let (first, last) = (label.frames.first().unwrap_or(0), label.frames.last());
        let own = label.frame.max(first).min(last.unwrap_or(usize::MAX));
        let shown = self.player.as_ref().and_then(Player::shown);
        let is_shown = shown.is_some_and(|frame| label.is_in_frame(frame.index));
        let place = self.labels.place(index);
        if !is_shown {
            self.play_with(|player, now| player.seek(own, now));
        }
        if let Some(target_in_world) = place {
            self.glide_to(Camera {
                target_in_world,
                ..self.camera
            });
        }
    }
}
