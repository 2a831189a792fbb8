//! One sequence of a run, and its viewpoints.

use super::scenario;
use crate::composition::{PictureView, packet};
use crate::messages::frame_place;
use crate::scene::{Camera, FirstLook, Scene, ScenePacket, Style};
use crate::sequence::{PreparedFrame, Sequence, Shape};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// One sequence of a run.
pub(super) struct Subject<'a> {
    pub(super) name: &'a str,
    pub(super) sequence: &'a Arc<Sequence>,
    pub(super) shape: Option<Shape>,
    /// Indices of the frames to measure.
    pub(super) chosen: Vec<usize>,
}

impl Subject<'_> {
    /// Display name of a frame of it.
    pub(super) fn named(&self, index: usize) -> String {
        format!("{} {}", self.name, frame_place(index, self.sequence.len()))
    }

    /// The packet of an image of `frame` from `camera`; `scene` remembers the last one.
    pub(super) fn packet(
        &self,
        scene: &mut Scene,
        frame: &PreparedFrame,
        camera: &Camera,
        style: &Style,
        size_px: [u32; 2],
    ) -> ScenePacket {
        let view = PictureView {
            camera,
            origin: self.sequence.origin(),
            size_px,
        };
        packet(scene, frame, &view, style)
    }

    /// The whole of `frame`, upright.
    pub(super) fn framing(&self, frame: &PreparedFrame) -> Camera {
        let origin = self.sequence.origin();
        let up = FirstLook::of(&[&frame.frame], origin).up;
        Camera::framing(&frame.frame.bounds(), origin, up)
    }

    /// `count` views of it from all around, at `distance` times the distance.
    pub(super) fn views(&self, frame: &PreparedFrame, count: usize, distance: f64) -> Vec<Camera> {
        let framing = self.framing(frame);
        let view = |(azimuth_deg, elevation_deg)| Camera {
            azimuth_deg,
            elevation_deg,
            distance: distance * framing.distance,
            ..framing
        };
        scenario::directions(count).map(view).collect()
    }
}

/// Returns the centroid of the points; the origin without points.
pub(super) fn mean_position(positions: &[Vec3]) -> DVec3 {
    let sum: DVec3 = positions.iter().map(|position| position.as_dvec3()).sum();
    sum / positions.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_center_of_mass_is_where_most_points_are() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::X, Vec3::new(2.0, 4.0, 0.0)];
        assert_eq!(mean_position(&positions), DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(mean_position(&[]), DVec3::ZERO);
    }
}
