//! Helpers of several test files.

use super::view::PixelView;
use crate::math::Aabb;
use crate::scene::{Camera, Content, PacketParams, PicturePlane, Projection, ScenePacket, Style, UpAxis};
use glam::{DVec3, Vec3};

/// A packet without records, seen from 4 units in front of the origin.
pub(super) fn packet_of(size_px: [u32; 2]) -> ScenePacket {
    let camera = Camera {
        target_in_world: DVec3::ZERO,
        distance: 4.0,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 60.0,
        up: UpAxis::Y,
        plane: PicturePlane::CENTERED,
        projection: Projection::Perspective,
    };
    ScenePacket {
        viewport_px: size_px,
        view: camera.transform(DVec3::ZERO, size_px),
        style: Style::default().painted(),
        content: Content::Nothing,
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds: Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        },
    }
}

pub(super) fn view_of(size_px: [u32; 2]) -> PixelView {
    PixelView::new(&packet_of(size_px))
}
