//! First look of the open sequence: derived data about it.

use crate::math::Aabb;
use crate::scene::{Camera, FirstLook};
use crate::sequence::Sequence;
use std::sync::{Arc, Weak};

/// Known properties of the open sequence.
#[derive(Debug, Default)]
pub(in crate::app) struct SequenceLook {
    pub(in crate::app) look: Option<Arc<FirstLook>>,
    /// First look without the user's choice of the up axis.
    pub(in crate::app) guessed: Option<Arc<FirstLook>>,
    /// The first examined frame: its index and its content, as `PreparedFrame::id`.
    pub(in crate::app) first: Option<(usize, u64)>,
    /// The file of that frame has changed since, as it was half-written.
    pub(in crate::app) is_outdated: bool,
    /// True if frames other than the first one have been examined, or there are none.
    pub(in crate::app) is_complete: bool,
    /// The view that followed from it.
    pub(in crate::app) view: Option<FirstView>,
}

/// An automatic view, not chosen by the user.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) struct FirstView {
    pub(in crate::app) camera: Camera,
    /// Size of the image that it fills.
    pub(in crate::app) size_px: [u32; 2],
    /// Bounding box of the sequence alongside the open one.
    pub(in crate::app) second_bounds: Aabb,
}

impl SequenceLook {
    /// The first view, if `camera` still is where it put it.
    pub(in crate::app) fn untouched(&self, camera: &Camera) -> Option<FirstView> {
        self.view.filter(|view| view.camera == *camera)
    }

    /// Returns true if `frame` with the content `id` is to be examined instead of the first one, whose file has
    /// changed: it is another content of that, or another frame.
    pub(in crate::app) fn is_mended_by(&self, frame: usize, id: u64) -> bool {
        self.is_outdated && self.first != Some((frame, id))
    }

    pub(in crate::app) fn is_empty(&self) -> bool {
        self.look.is_none()
    }

    pub(in crate::app) fn look(&self) -> Option<Arc<FirstLook>> {
        self.look.clone()
    }
}

/// Look refined by a thread from several frames.
#[derive(Debug)]
pub struct RefinedLook {
    pub(in crate::app) sequence: Weak<Sequence>,
    pub(in crate::app) look: FirstLook,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_from_a_half_written_frame_are_corrected_by_new_content_or_another_frame() {
        let mut look = SequenceLook {
            first: Some((0, 7)),
            ..SequenceLook::default()
        };
        assert!(
            !look.is_mended_by(0, 8) && !look.is_mended_by(1, 9),
            "its file is as it was"
        );
        look.is_outdated = true;
        assert!(!look.is_mended_by(0, 7) && look.is_mended_by(0, 8) && look.is_mended_by(1, 9));
    }
}
