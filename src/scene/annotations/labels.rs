//! Texts at points of the cloud, in windows, images and videos alike.
//!
//! **How it works.** A label is put at a point of one frame. In others it follows the point by its index in the file
//! ([`FollowedPoint`]); if that index is unknown, it stays at its place. So the position of a label depends on the
//! frame alone, and not on earlier frames: a window and a video of it agree. Labels are always drawn over the image,
//! and dimmed where something is in front of them ([`LabelOnPicture::is_hidden`]).

use crate::scene::visible::pick::hidden;
use crate::scene::{Camera, FollowedPoint, ScenePacket};
use crate::sequence::PreparedFrame;
use crate::timeline::PlayRange;
use glam::{DVec2, DVec3};

/// Longest text of a label, characters.
pub const MAX_LABEL_CHARS: usize = 200;

/// A text at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Label text, in one line.
    pub text: String,
    /// Index of the frame in which it was put somewhere.
    pub frame: usize,
    /// The point that it follows.
    pub point: Option<FollowedPoint>,
    /// Fallback position in frames without that point, in the coordinates of the file; `None`: it is not shown there.
    pub place: Option<DVec3>,
    /// The frames that show it.
    pub frames: PlayRange,
}

impl Label {
    /// Returns true if the label is shown in frame `index`.
    pub fn is_in_frame(&self, index: usize) -> bool {
        self.frames.first().is_none_or(|first| first <= index) && self.frames.last().is_none_or(|last| index <= last)
    }

    /// Returns the position of the label in `frame`, whose positions are relative to `origin`; `None` where it is not
    /// shown.
    pub fn place_in(&self, frame: &PreparedFrame, origin: DVec3) -> Option<DVec3> {
        if !self.is_in_frame(frame.index) {
            return None;
        }
        let slot = self.point.and_then(|point| point.slot_in(frame));
        let followed = slot.map(|slot| origin + frame.frame.positions()[slot].as_dvec3());
        followed.or(self.place)
    }

    /// `text` as a label shows it: one line without ends, cut after [`MAX_LABEL_CHARS`].
    pub fn as_text(text: &str) -> String {
        let line = text.trim().chars().take(MAX_LABEL_CHARS);
        line.map(|letter| if letter.is_control() { ' ' } else { letter })
            .collect()
    }
}

/// A label in an image.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelOnPicture {
    /// Index of the label.
    pub label: usize,
    /// Position of its point, pixels from the upper left corner; may be outside the image.
    pub px: DVec2,
    /// Something is drawn before its point.
    pub is_hidden: bool,
}

/// The labels in front of the eye of `camera` in an image of `size_px` drawn from `packet`. `pose` is the frame whose
/// points are followed: the packet may have more points, of other frames. Positions are relative to `origin`.
pub fn labels_on_picture(
    labels: &[Label],
    pose: &PreparedFrame,
    origin: DVec3,
    camera: &Camera,
    packet: &ScenePacket,
    size_px: [u32; 2],
) -> Vec<LabelOnPicture> {
    let placed = |(index, label): (usize, &Label)| {
        let place = label.place_in(pose, origin)?;
        // An image may be rendered at a smaller size than it is displayed.
        let [px, drawn_px] = [size_px, packet.viewport_px].map(|size_px| camera.to_px(place, size_px));
        Some((index, px?, (place - origin, drawn_px?)))
    };
    let placed: Vec<_> = labels.iter().enumerate().filter_map(placed).collect();
    let seen: Vec<_> = placed.iter().map(|&(.., seen)| seen).collect();
    let on_picture = placed.iter().zip(hidden(packet, &seen));
    on_picture
        .map(|(&(label, px, _), is_hidden)| LabelOnPicture { label, px, is_hidden })
        .collect()
}

#[cfg(test)]
#[path = "labels_tests.rs"]
mod tests;
