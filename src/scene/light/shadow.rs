//! Shadow map of the key light: the input of a lamp's depth map, and the lookup position of image points in it.
//!
//! **How it works** (Williams 1978, with percentage-closer filtering, Reeves et al. 1987). The first lamp of a rig is
//! its key light. If it is far away, the cloud is drawn once more as seen from there, for its depths alone. A point of
//! the image is in shadow where something nearer to the lamp is drawn there. That is looked up in a square of 3×3
//! texels around the point, which begins between texels: so borders of shadows are soft and do not flicker.
//!
//! Parallel rays are those through a telephoto lens from far away, as in orthographic views: the map needs no
//! projection of its own, and is drawn by the passes that draw the image.
//!
//! A surface must not shadow itself. Two measures ensure that:
//!
//! - splats are pushed away from the lamp by their radius, as in the visibility pass, so that disks of one surface
//!   count as one; cells by twice the distance from their centre to a corner, since their faces are steps;
//! - positions are moved along their normal by [`Shadow::OFFSET_TEXELS`]: the rise of a sloping plane between a
//!   position and the texels around it that are looked up.
//!
//! The map depends on the cloud and on the direction of the lamp in it: zooming and panning leave it unchanged.

use crate::scene::style::Primitive;
use crate::scene::style::describe::Conditions as _;
use crate::scene::view::camera::TELEPHOTO_FOCAL;
use crate::scene::{Lights, ScenePacket, ViewTransform};
use glam::{DVec3, Mat3, Vec4};

/// Radius covered by the map, as a share of the cloud's: splats at its border reach beyond it.
const SHOWN_OF_RADIUS: f32 = 1.05;

/// The depth map of the key light.
#[derive(Debug, Clone, PartialEq)]
pub struct Shadow {
    /// The cloud as the lamp sees it; depths alone count, of the visibility pass or of cells.
    pub lamp_packet: ScenePacket,
    /// Rows of the matrix from the view space of the image into the lamp's.
    pub lamp_from_view: [Vec4; 3],
    /// Edge length of a texel at the centre of the cloud, scene units.
    pub texel: f32,
    /// Depth bias: the distance by which casters are pushed away from the lamp, in radii of splats.
    pub slack_radii: f32,
}

impl Shadow {
    /// Width and height of the map.
    pub const EDGE_PX: u32 = 1024;

    /// Normal offset of positions along their normal, in texels: always, and for a lamp that is seen edge-on
    /// additionally the reach of a square of 3×3 texels between texels, √2 · 2.
    pub const OFFSET_TEXELS: [f32; 2] = [1.0, 2.83];

    /// Depth bias by which splats are pushed away from the lamp, in their radii; as the visibility pass pushes them
    /// from the eye.
    const SLACK_RADII: f32 = 1.0;

    /// Depth bias where points are drawn. They face the screen: on a slope they are before and behind the surface that
    /// casts their shadows, at 60 degrees by nearly two radii.
    // The price: thin objects cast no shadow at their base.
    const SLACK_OF_POINTS_RADII: f32 = 3.0;

    /// The shadow of a packet as it is drawn ([`ScenePacket::as_drawn`]); `None` without shadows, or without a distant
    /// key light.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        let is_on = packet.style.has_shadows();
        let lights = Lights::of(packet).filter(|_| is_on)?;
        let key = lights.key()?;
        let radius = packet.bounds.radius() * SHOWN_OF_RADIUS;
        if radius.is_nan() || radius <= 0.0 {
            return None;
        }
        let view = &packet.view;
        let backward = view.view_from_frame_rotation.transpose() * key.place.truncate();
        let (right, up) = backward.any_orthonormal_pair();
        let lamp_from_frame = Mat3::from_cols(right, up, backward).transpose();
        let distance = TELEPHOTO_FOCAL * f64::from(radius);
        let lamp = packet.bounds.center().as_dvec3() + distance * backward.as_dvec3();
        let lamp_high = lamp.as_vec3();
        let lamp_view = ViewTransform {
            view_from_frame_rotation: lamp_from_frame,
            eye_high: lamp_high,
            eye_low: (lamp - lamp_high.as_dvec3()).as_vec3(),
            focal: [TELEPHOTO_FOCAL as f32; 2],
            near: (0.5 * distance) as f32,
            pixels_per_unit_at_1: (0.5 * TELEPHOTO_FOCAL * f64::from(Self::EDGE_PX)) as f32,
            center_ndc: [0.0; 2],
            rows_of_whole: [0.0, 1.0],
            telephoto: 1.0,
            up: view.up,
        };
        Some(Self {
            lamp_from_view: lamp_from_view(view, &lamp_view),
            lamp_packet: seen_from_lamp(packet, lamp_view),
            texel: 2.0 * radius / Self::EDGE_PX as f32,
            slack_radii: match packet.style.primitive {
                Primitive::Point => Self::SLACK_OF_POINTS_RADII,
                _ => Self::SLACK_RADII,
            },
        })
    }
}

/// Rows of the matrix from one view space into another one.
fn lamp_from_view(view: &ViewTransform, lamp_view: &ViewTransform) -> [Vec4; 3] {
    let eye = |view: &ViewTransform| -> DVec3 { view.eye_high.as_dvec3() + view.eye_low.as_dvec3() };
    let lamp_from_frame = lamp_view.view_from_frame_rotation.as_dmat3();
    let rotation = lamp_from_frame * view.view_from_frame_rotation.as_dmat3().transpose();
    let offset = lamp_from_frame * (eye(view) - eye(lamp_view));
    [0, 1, 2].map(|axis| rotation.row(axis).extend(offset[axis]).as_vec4())
}

/// A packet for the depths of the same records. Surfaces cast shadows to both sides. Points cast the shadows of their
/// surfels: the size of a point in an image is not a size in the scene.
fn seen_from_lamp(packet: &ScenePacket, view: ViewTransform) -> ScenePacket {
    let mut seen = packet.for_depths(view, [Shadow::EDGE_PX; 2]);
    if seen.style.primitive == Primitive::Point {
        seen.style.primitive = Primitive::Surfel;
        seen.style.surfels.splat_scale = 1.0;
    }
    seen
}
