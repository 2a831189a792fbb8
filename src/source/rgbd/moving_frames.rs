//! Transform tree of moving frames: the pose of a frame of reference in the world over time, from the links that a
//! robot publishes (`/tf`).
//!
//! *How it works.* Links form a tree: a frame has one parent. The chain from the frame of a camera leads up to the
//! root, which is the world as far as the recording knows it (`map`, `odom`, `world`). A moving link is a list of
//! transforms with their times; between two, translation is interpolated linearly and rotation at a constant rate, as
//! `tf2` does. Before the first and after the last it is valid for the maximum time offset between images of one time
//! step. A camera without a moving link above it has no pose: its motion and position are unknown.

use super::pairs::MAX_APART;
use crate::io::recordings::recording::camera::Link;
use glam::DAffine3;
use std::collections::HashMap;
use std::time::Duration;

/// Frames of reference with the places that they had.
#[derive(Debug, Default)]
pub(super) struct MovingFrames {
    /// Parents by child.
    parents: HashMap<String, Parent>,
}

/// Transform of a frame relative to its parent.
#[derive(Debug)]
struct Parent {
    name: String,
    /// True if the transform is valid for all times.
    is_static: bool,
    /// In the order of time; one at least.
    places: Vec<(Duration, DAffine3)>,
}

impl MovingFrames {
    /// Creates the tree from links that hold for all times, and from those that hold at their time. Of a frame with
    /// several parents the first one counts.
    pub(super) fn of(statics: Vec<Link>, moving: Vec<Link>) -> Self {
        let mut frames = Self::default();
        for (is_static, links) in [(true, statics), (false, moving)] {
            for link in links {
                let parent = frames.parents.entry(link.child).or_insert_with(|| Parent {
                    name: link.parent.clone(),
                    is_static,
                    places: Vec::new(),
                });
                if parent.name == link.parent && parent.is_static == is_static {
                    parent.places.push((link.time, link.parent_from_child));
                }
            }
        }
        for parent in frames.parents.values_mut() {
            parent.places.sort_by_key(|&(time, _)| time);
        }
        frames
    }

    /// Returns the pose of `frame` in the root of its tree at `time`; `None` if nothing above it moves, or its pose is
    /// unknown at this time.
    pub(super) fn world_from(&self, frame: &str, time: Duration) -> Option<DAffine3> {
        let mut world_from_frame = DAffine3::IDENTITY;
        let mut moves = false;
        let mut at = frame;
        // At most one step per link: more would be a cycle.
        for _ in 0..=self.parents.len() {
            let Some(parent) = self.parents.get(at) else {
                return moves.then_some(world_from_frame);
            };
            moves |= !parent.is_static;
            world_from_frame = parent.place(time)? * world_from_frame;
            at = &parent.name;
        }
        None
    }
}

impl Parent {
    fn place(&self, time: Duration) -> Option<DAffine3> {
        let first_after = self.places.partition_point(|&(at, _)| at <= time);
        let before = first_after.checked_sub(1).map(|index| self.places[index]);
        let after = self.places.get(first_after).copied();
        match (before, after) {
            (Some((_, place)), _) if self.is_static => Some(place),
            (None, Some((_, place))) if self.is_static => Some(place),
            (Some((start, from)), Some((end, to))) => {
                // `start` is not after `time`, but `end` is.
                let [passed, whole] = [time, end].map(|later| later.saturating_sub(start).as_secs_f64());
                Some(between(from, to, passed / whole))
            }
            (Some((at, place)), None) | (None, Some((at, place))) => (at.abs_diff(time) <= MAX_APART).then_some(place),
            (None, None) => None,
        }
    }
}

/// The position reached so far.
fn between(from: DAffine3, to: DAffine3, share: f64) -> DAffine3 {
    let [(_, turn, at), (_, other_turn, other_at)] = [from, to].map(|place| place.to_scale_rotation_translation());
    DAffine3::from_rotation_translation(turn.slerp(other_turn, share), at.lerp(other_at, share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn link(parent: &str, child: &str, millis: u64, place: DAffine3) -> Link {
        Link {
            parent: parent.to_owned(),
            child: child.to_owned(),
            parent_from_child: place,
            time: Duration::from_millis(millis),
        }
    }

    fn robot() -> MovingFrames {
        let mounted = DAffine3::from_rotation_y(0.5) * DAffine3::from_translation(DVec3::X);
        let drive = |millis: u64, x: f64, turn: f64| {
            let place = DAffine3::from_translation(DVec3::X * x) * DAffine3::from_rotation_z(turn);
            link("odom", "base", millis, place)
        };
        MovingFrames::of(
            vec![
                link("base", "camera", 0, mounted),
                link("map", "odom", 9, DAffine3::from_rotation_x(0.1)),
            ],
            // Not in chronological order.
            vec![drive(2000, 3.0, 0.4), drive(1000, 1.0, 0.0), drive(3000, 3.0, 0.4)],
        )
    }

    #[test]
    fn a_camera_moves_with_its_robot() {
        let robot = robot();
        let found = robot.world_from("camera", Duration::from_millis(1250)).unwrap();
        let drive = DAffine3::from_translation(DVec3::X * 1.5) * DAffine3::from_rotation_z(0.1);
        let mounted = DAffine3::from_rotation_y(0.5) * DAffine3::from_translation(DVec3::X);
        let expected = DAffine3::from_rotation_x(0.1) * drive * mounted;
        assert!(found.abs_diff_eq(expected, 1e-12), "{found} {expected}");
        let last = robot.world_from("base", Duration::from_millis(3020)).unwrap();
        assert_eq!(last, robot.world_from("base", Duration::from_secs(3)).unwrap());
        for beyond in [979, 3021] {
            assert_eq!(
                robot.world_from("camera", Duration::from_millis(beyond)),
                None,
                "{beyond}"
            );
        }
    }

    #[test]
    fn static_frames_have_no_pose() {
        let robot = robot();
        for frame in ["odom", "map", "lidar"] {
            assert_eq!(robot.world_from(frame, Duration::from_secs(1)), None, "{frame}");
        }
        assert_eq!(MovingFrames::default().world_from("camera", Duration::ZERO), None);
    }

    #[test]
    fn cyclic_links_terminate() {
        let place = DAffine3::IDENTITY;
        let circle = MovingFrames::of(
            Vec::new(),
            vec![
                link("a", "b", 0, place),
                link("b", "a", 0, place),
                link("c", "c", 0, place),
            ],
        );
        for frame in ["a", "b", "c"] {
            assert_eq!(circle.world_from(frame, Duration::ZERO), None);
        }
        // Of two parents the first counts.
        let two = MovingFrames::of(
            Vec::new(),
            vec![
                link("map", "base", 0, DAffine3::from_translation(DVec3::X)),
                link("other", "base", 0, DAffine3::from_translation(DVec3::Y)),
            ],
        );
        let found = two.world_from("base", Duration::ZERO).unwrap();
        assert_eq!(found.translation, DVec3::X);
    }
}
