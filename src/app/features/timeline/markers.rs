//! Named places on the timeline.

use crate::document::Marker;

/// More than users set by hand.
const MAX_MARKERS: usize = 1000;

/// Longest name, characters.
const MAX_NAME_CHARS: usize = 200;

/// Markers by frame, one a frame at most.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Markers {
    list: Vec<Marker>,
}

impl Markers {
    /// Restores stored markers. Names are cut after 200 characters; of several at a frame the first stays, and the
    /// others are noted in `unread`. There is no limit on their number: no user's markers are dropped.
    pub(super) fn of(mut list: Vec<Marker>, unread: &mut Vec<String>) -> Self {
        list.sort_by_key(|marker| marker.frame);
        list.dedup_by(|later, marker| {
            let is_second = later.frame == marker.frame;
            if is_second {
                unread.push(format!("there is a second marker at {}", later.frame));
            }
            is_second
        });
        for marker in &mut list {
            marker.name = as_name(&marker.name);
        }
        Self { list }
    }

    /// From the first frame on.
    pub fn list(&self) -> &[Marker] {
        &self.list
    }

    fn place(&self, frame: usize) -> Result<usize, usize> {
        self.list.binary_search_by_key(&frame, |marker| marker.frame)
    }

    /// Adds a marker at `frame`, or removes the existing one. None is added beyond the thousandth.
    pub fn toggle(&mut self, frame: usize) {
        match self.place(frame) {
            Ok(place) => {
                self.list.remove(place);
            }
            Err(place) if self.list.len() < MAX_MARKERS => {
                let name = String::new();
                self.list.insert(place, Marker { frame, name });
            }
            Err(_) => {}
        }
    }

    /// Names the marker at `frame`, if there is one; the name is cut after 200 characters.
    pub fn rename(&mut self, frame: usize, name: &str) {
        if let Ok(place) = self.place(frame) {
            self.list[place].name = as_name(name);
        }
    }

    /// The first marked frame after `frame`, or, if there is none, the first of all. Of frames below `frame_count`.
    pub fn next_after(&self, frame: usize, frame_count: usize) -> Option<usize> {
        let mut frames = self.frames(frame_count);
        let first = frames.clone().next();
        frames.find(|&other| other > frame).or(first)
    }

    /// The last marked frame before `frame`, or, if there is none, the last of all. Of frames below `frame_count`.
    pub fn last_before(&self, frame: usize, frame_count: usize) -> Option<usize> {
        let mut frames = self.frames(frame_count).rev();
        let last = frames.clone().next();
        frames.find(|&other| other < frame).or(last)
    }

    /// A folder may have fewer frames than when they were marked.
    fn frames(&self, frame_count: usize) -> impl DoubleEndedIterator<Item = usize> + Clone {
        let frames = self.list.iter().map(|marker| marker.frame);
        frames.filter(move |&frame| frame < frame_count)
    }
}

/// `text` as a stored name.
fn as_name(text: &str) -> String {
    text.trim().chars().take(MAX_NAME_CHARS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn markers_can_be_added_removed_and_named() {
        let mut markers = Markers::default();
        for frame in [7, 3, 9, 7] {
            markers.toggle(frame);
        }
        markers.rename(9, "  the jump ");
        markers.rename(4, "nobody");
        let list: Vec<_> = markers
            .list()
            .iter()
            .map(|marker| (marker.frame, marker.name.as_str()))
            .collect();
        assert_eq!(list, [(3, ""), (9, "the jump")]);
        markers.rename(3, &"é".repeat(500));
        assert_eq!(markers.list()[0].name.chars().count(), 200);
        for frame in 0..2000 {
            markers.toggle(10 + frame);
        }
        assert_eq!(markers.list().len(), 1000);
        let mut unread = Vec::new();
        assert_eq!(Markers::of(markers.list().to_vec(), &mut unread), markers);
        assert_eq!(unread, [""; 0]);
    }

    #[test]
    fn hand_written_lists_are_sorted() {
        let marker = |frame, name: &str| Marker {
            frame,
            name: name.to_owned(),
        };
        let of = |list: &[Marker]| {
            let mut unread = Vec::new();
            let markers = Markers::of(list.to_vec(), &mut unread);
            (markers.list, unread.len())
        };
        let (jump, turn) = (marker(3, "jump"), marker(4, "turn"));
        let sorted = vec![jump.clone(), turn.clone()];
        assert_eq!(of(&[turn.clone(), jump.clone()]), (sorted.clone(), 0));
        assert_eq!(of(&[turn, jump, marker(3, "second")]), (sorted, 1));
        let long = "x".repeat(201);
        assert_eq!(of(&[marker(4, &long)]), (vec![marker(4, &long[1..])], 0));
        let many: Vec<Marker> = (0..1001).map(|frame| marker(frame, "")).collect();
        assert_eq!(of(&many), (many, 0));
    }

    proptest! {
        /// Compared with a scan over all frames.
        #[test]
        fn jumps_go_to_the_nearest_marker_and_wrap_around(
            marked in prop::collection::btree_set(0usize..20, 0..8), frame in 0usize..16, count in 1usize..16,
        ) {
            let mut markers = Markers::default();
            for &frame in &marked {
                markers.toggle(frame);
            }
            let frame = frame % count;
            let found = |mut way: Box<dyn Iterator<Item = usize>>| way.find(|other| marked.contains(other));
            let next = found(Box::new((frame + 1..count).chain(0..=frame)));
            prop_assert_eq!(markers.next_after(frame, count), next);
            let last = found(Box::new((0..frame).rev().chain((frame..count).rev())));
            prop_assert_eq!(markers.last_before(frame, count), last);
        }
    }
}
