//! User options of the composition, the same for all frames.

use super::onion_skin::OnionSkin;
use super::trails::Trails;
use std::sync::Arc;

/// Additions to each pose.
#[derive(Debug, Clone, Default)]
pub struct ComposeOptions {
    /// The colours of points.
    pub change: Option<ChangeColors>,
    /// Neighbouring poses.
    pub onion: Option<OnionSkin>,
    /// Trajectories of points, and their looks.
    pub trails: Option<(Arc<Trails>, Vec<TrailLook>)>,
    /// Indices of the input images that are excluded from view-dependent texturing.
    pub skipped_photos: Vec<usize>,
}

impl ComposeOptions {
    /// A pose as it is.
    pub const NONE: Self = Self {
        change: None,
        onion: None,
        trails: None,
        skipped_photos: Vec::new(),
    };
}

/// Colours by the distance to another pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeColors {
    /// Frame offset of the compared frame: positive for later frames, negative for earlier ones.
    pub step: i64,
    /// The distance in the last colour, scene units; that which 99 % of the points do not exceed if `None`.
    pub range: Option<f64>,
}

impl ChangeColors {
    /// The frame that `index` is compared with; `None` where a sequence of `frame_count` has no such frame.
    pub fn other_frame(&self, index: usize, frame_count: usize) -> Option<usize> {
        let other = i64::try_from(index).ok()?.checked_add(self.step)?;
        usize::try_from(other).ok().filter(|&other| other < frame_count)
    }
}

/// Appearance of a trail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrailLook {
    /// Index of the trail.
    pub trail: usize,
    /// Its colour; the future part is half as bright.
    pub tint: [u8; 3],
    /// Number of frames before the shown one; all frames, including later ones, if `None`.
    pub length: Option<usize>,
}

impl TrailLook {
    /// The colour of trails of picked points.
    pub const PICKED_TINT: [u8; 3] = [255, 190, 60];

    /// All of a trail of a picked point.
    pub fn picked(trail: usize) -> Self {
        Self {
            trail,
            tint: Self::PICKED_TINT,
            length: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_frame_is_within_the_sequence() {
        let with = |step| ChangeColors { step, range: None };
        assert_eq!(with(1).other_frame(3, 5), Some(4));
        assert_eq!(with(2).other_frame(3, 5), None);
        assert_eq!(with(-3).other_frame(3, 5), Some(0));
        assert_eq!(with(-4).other_frame(3, 5), None);
        assert_eq!(with(i64::MAX).other_frame(3, 5), None);
    }
}
