//! A second sequence beside the open one: opening and closing it, its pictures, its share of the memory.

use super::State;
use crate::app::features::beside::{Beside, Layout};
use crate::app::sequence_name::name_of;
use crate::app::side::Side;
use crate::app::widgets::numbers::significant;
use crate::app::work::tasks::close;
use crate::composition::{Composed, PictureView};
use crate::math::Aabb;
use crate::playback::{Companion, PlayerChange};
use crate::scene::ScenePacket;
use crate::sequence::{LoaderOptions, OpenOptions, Sequence, watch};
use image::{RgbaImage, imageops};
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// Shows `sequence` beside the open one, in place of what that was compared with before, laid out like that. The
    /// camera stays.
    pub fn compare_with(&mut self, sequence: Arc<Sequence>) {
        let Some(player) = &self.player else {
            let text = "There is nothing to compare with yet: open a sequence first";
            return self.notices.error(text);
        };
        let leader = Arc::clone(player.sequence());
        let before = self.beside.as_ref();
        let laid_out = before.map(|before| (before.layout, before.pictures.split));
        self.close_beside();
        self.end_comparison(Side::A);
        let [_, share] = Companion::shares(self.budget_bytes());
        let options = self.loader_options(share);
        let companion = match Companion::new(&leader, sequence, options) {
            Ok(companion) => companion,
            Err(error) => return self.notices.error(error.to_string()),
        };
        let sequence = companion.sequence();
        if let Err(error) = watch(sequence, self.wake()) {
            self.notices.error(error.to_string());
        }
        let name = name_of(sequence).unwrap_or_default();
        let mut beside = Beside::new(companion, name);
        if let Some((layout, split)) = laid_out {
            beside.pictures.split = split;
            beside.lay_out(layout);
        }
        self.beside = Some(beside);
        self.share_budget();
    }

    /// Finds the frames of `inputs` on a thread and shows them beside the open sequence.
    pub fn compare_paths(&mut self, inputs: Vec<PathBuf>) {
        self.find(inputs, self.options.open.clone(), Side::B);
    }

    /// Opens the recording beside the open sequence again, with the point clouds of another topic.
    pub fn compare_topic(&mut self, topic: &str) {
        if let Some(beside) = &self.beside {
            let inputs = beside.companion.sequence().source().inputs().to_vec();
            let topic = Some(topic.into());
            let open = self.options.open.clone();
            self.find(inputs, OpenOptions { topic, ..open }, Side::B);
        }
    }

    /// Shows the open sequence alone. Its memory is all its own again.
    pub(super) fn close_beside(&mut self) {
        if let Some(beside) = self.beside.take() {
            // Its threads end after the frame they are on; nobody waits for that here.
            close(beside);
            self.inspection.forget_points_of_b();
            self.share_budget();
        }
    }

    /// Side by side, or one over the other.
    pub(super) fn next_layout(&mut self) {
        match &mut self.beside {
            Some(beside) => {
                let layout = match beside.layout {
                    Layout::SideBySide => Layout::Wipe,
                    Layout::Wipe => Layout::SideBySide,
                };
                beside.lay_out(layout);
            }
            None => self
                .notices
                .hint("One sequence is open: File, Compare with… opens another beside it"),
        }
    }

    /// Takes notice that the first of two pictures is another one.
    pub(super) fn note_picture(&mut self) {
        if let Some(beside) = &mut self.beside {
            beside.note_change(self.now);
        }
        if let Some(comparison) = &mut self.comparison {
            comparison.pictures.note_change(self.now);
        }
    }

    /// Measures the distances of the two shown frames.
    pub(in crate::app) fn measure_distances(&mut self) {
        if let (Some(beside), Some(player)) = (&mut self.beside, &self.player) {
            beside.measure(player, &self.tasks);
        }
    }

    /// Memory for the prepared frames of all that is open.
    pub fn budget_bytes(&self) -> usize {
        let default = || LoaderOptions::default().budget_bytes;
        self.options.budget_bytes.unwrap_or_else(default)
    }

    pub(super) fn loader_options(&self, budget_bytes: usize) -> LoaderOptions {
        LoaderOptions {
            shows_stages: true,
            wake: self.wake(),
            keeps_coarse_frames: true,
            budget_bytes,
            ..LoaderOptions::default()
        }
    }

    /// Divides the memory between what is open.
    pub(super) fn share_budget(&self) {
        let whole = self.budget_bytes();
        let [a, b] = match self.beside {
            Some(_) => Companion::shares(whole),
            None => [whole, 0],
        };
        if let Some(player) = &self.player {
            player.loader().set_budget_bytes(a);
        }
        if let Some(beside) = &self.beside {
            beside.companion.loader().set_budget_bytes(b);
        }
    }

    /// Takes in what has changed about the other sequence. True if something can be seen.
    pub(super) fn follow_beside(&mut self, change: PlayerChange) -> bool {
        let (Some(beside), Some(player)) = (&mut self.beside, &self.player) else {
            return false;
        };
        let sequence = beside.companion.sequence();
        if let Some(failure) = change.new_failure {
            let place = failure.index() + 1;
            let (count, name) = (sequence.len(), &beside.name);
            self.notices
                .error(format!("Frame {place} of {count} of B ({name}) is left out. {failure}"));
        }
        for warning in change.new_warnings {
            self.notices.warn(format!("B: {warning}"));
        }
        if let Some(frame) = beside.companion.shown() {
            self.inspection.follow(Side::B, frame, sequence.origin());
        }
        if let Some(gap) = beside.take_gap(player) {
            let a = name_of(player.sequence()).unwrap_or_default();
            self.notices.warn(format!(
                "B ({}) is {} away from A ({a}): both are drawn where their files say. R shows both; \
                 `pointreel convert --transform` moves the points of one",
                beside.name,
                significant(gap),
            ));
        }
        change.visible
    }

    /// The box around the shown frame of the other sequence, relative to the origin of the open one; empty without any.
    pub(super) fn bounds_beside(&self) -> Aabb {
        let (Some(beside), Some(player)) = (&self.beside, &self.player) else {
            return Aabb::EMPTY;
        };
        let Some(frame) = beside.companion.shown() else {
            return Aabb::EMPTY;
        };
        let shift = beside.shift_from(player).as_vec3();
        let Aabb { min, max } = frame.frame.bounds();
        Aabb {
            min: min + shift,
            max: max + shift,
        }
    }

    /// The packet of the other sequence, if it differs from the last one.
    pub(super) fn next_packet_beside(&mut self) -> Option<ScenePacket> {
        let style = self.drawn_style();
        let beside = self.beside.as_mut()?;
        let Some(frame) = beside.companion.shown() else {
            beside.pictures.forget_difference();
            return None;
        };
        if self.viewport.other_size_px.contains(&0) {
            return None;
        }
        let view = PictureView {
            camera: &self.camera,
            origin: beside.companion.sequence().origin(),
            size_px: self.viewport.other_size_px,
        };
        let composed = Composed::of(Arc::clone(frame));
        let packet = beside.drawing.next_packet(composed, &view, &style, self.now)?;
        beside.note_change(self.now);
        Some(packet)
    }

    /// Whether all pictures that are to be seen have been drawn of frames that are due.
    pub(in crate::app) fn is_drawn(&self) -> bool {
        let is_drawn_beside = |beside: &Beside| {
            beside.companion.waiting_for().is_none()
                && (beside.drawing.is_drawn() || beside.companion.shown().is_none())
        };
        self.main.drawing.is_drawn() && self.beside.as_ref().is_none_or(is_drawn_beside)
    }

    /// What is seen of both pictures, as one: side by side, or on both sides of the line. The first one alone if there
    /// is no other sequence, or no frame of it. With the labels that are in the window.
    pub fn joined(&self, a: RgbaImage, b: Option<RgbaImage>) -> RgbaImage {
        let Some((beside, b)) = self.beside.as_ref().zip(b) else {
            return self.with_labels(a);
        };
        if beside.companion.shown().is_none() {
            return self.with_labels(a);
        }
        match beside.layout {
            Layout::SideBySide => {
                let left = a.width();
                let mut joined = RgbaImage::new(left + b.width(), a.height().max(b.height()));
                imageops::replace(&mut joined, &self.with_labels(a), 0, 0);
                imageops::replace(&mut joined, &b, i64::from(left), 0);
                joined
            }
            Layout::Wipe => {
                let mut joined = a;
                let width = joined.width().min(b.width());
                let line = (beside.pictures.split * width as f32).round() as u32;
                let right = imageops::crop_imm(&b, line, 0, width - line, b.height());
                imageops::replace(&mut joined, &right.to_image(), i64::from(line), 0);
                self.with_labels(joined)
            }
        }
    }
}
