//! Frames that lack attributes of the others: reported once, since the image changes with it.

use crate::cloud::Frame;

/// Point attributes that affect rendered images if a file has them.
const ATTRIBUTES: [&str; 3] = ["colors", "normals", "radii"];

/// Attributes of the first shown frame of a sequence.
#[derive(Debug, Default)]
pub(super) struct FirstAttributes {
    first: Option<(usize, [bool; 3])>,
    was_told: bool,
}

impl FirstAttributes {
    /// Looks at frame `index`, which is shown; returns the notice if it is the first one with other attributes. A
    /// coarse level has radii that close its surface, whatever the frame has.
    pub(super) fn note(&mut self, index: usize, frame: &Frame) -> Option<String> {
        if frame.points_of_finer().is_some() {
            return None;
        }
        let has = [
            frame.colors().is_some(),
            frame.normals().is_some(),
            frame.radii().is_some(),
        ];
        let (first, had) = *self.first.get_or_insert((index, has));
        if self.was_told || has == had {
            return None;
        }
        self.was_told = true;
        let named = |has: [bool; 3]| {
            let names = ATTRIBUTES.iter().zip(has);
            let names: Vec<&str> = names.filter_map(|(name, has)| has.then_some(*name)).collect();
            if names.is_empty() {
                "none of colors, normals and radii".to_owned()
            } else {
                names.join(" and ")
            }
        };
        Some(format!(
            "Frame {} has {}, frame {} has {}: what a file lacks is estimated, so the picture changes from frame to \
             frame.",
            first + 1,
            named(had),
            index + 1,
            named(has)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use glam::DVec3;

    fn points(count: usize, radii: bool) -> RawCloud {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[1.0; 3]; count]));
        cloud.attributes.radii = radii.then(|| vec![0.5; count]);
        cloud
    }

    #[test]
    fn radii_of_coarse_levels_do_not_count_as_attributes_of_the_frame() {
        let mut first = FirstAttributes::default();
        let whole = Frame::from_raw(points(8, false), DVec3::ZERO).unwrap();
        let level = Frame::from_level(points(4, true), DVec3::ZERO, 8, 8).unwrap();
        let other = Frame::from_raw(points(8, true), DVec3::ZERO).unwrap();
        assert_eq!(first.note(0, &level), None);
        assert_eq!(first.note(0, &whole), None);
        assert_eq!(first.note(1, &level), None);
        assert!(first.note(2, &other).is_some());
    }
}
