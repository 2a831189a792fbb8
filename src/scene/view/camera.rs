//! The camera: an orbit in f64 around a target, and its form for shaders.
//!
//! Shaders must not see large coordinates: a frame's positions are f32 relative to the sequence origin, and the eye is
//! handed over as a sum of two f32, so that `(position - eye_high) - eye_low` loses nothing a pixel could show.

use super::picture_plane::PicturePlane;
use crate::levels::{LodMetric, SelectView};
use crate::math::{Aabb, Frustum};
use crate::scene::style::{ParseChoiceError, choices};
use glam::{DMat3, DVec3, Mat3, Mat4, Vec3, Vec4};
use std::str::FromStr;

choices! {
    /// Projection: perspective or orthographic, that is, with or without foreshortening.
    Projection, "projection" {
        Perspective = "perspective", "Perspective", "As an eye sees: what is farther away is smaller";
        /// Lengths across the view can be compared.
        Orthographic = "orthographic", "Orthographic",
            "By parallel rays: everything is as large as at the centre of the orbit";
    }
}

/// The direction that is up in the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// +X.
    X,
    /// +Y, the usual one of models.
    #[default]
    Y,
    /// +Z, the usual one of surveys and `LiDAR`.
    Z,
    /// -X.
    NegX,
    /// -Y, the usual one of depth cameras.
    NegY,
    /// -Z.
    NegZ,
}

impl UpAxis {
    /// Every axis with its word.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("y", Self::Y),
        ("z", Self::Z),
        ("x", Self::X),
        ("-y", Self::NegY),
        ("-z", Self::NegZ),
        ("-x", Self::NegX),
    ];

    /// Its word.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(_, axis)| *axis == self)
            .map_or("y", |&(name, _)| name)
    }

    /// Its name with a sign, for people: `+Z`.
    pub fn label(self) -> &'static str {
        match self {
            Self::Y => "+Y",
            Self::Z => "+Z",
            Self::X => "+X",
            Self::NegY => "-Y",
            Self::NegZ => "-Z",
            Self::NegX => "-X",
        }
    }

    /// The unit vector that points up, in world space.
    pub fn direction(self) -> DVec3 {
        self.basis().col(1)
    }

    /// The axis that points most in a direction.
    pub(in crate::scene) fn nearest(direction: DVec3) -> Self {
        let along = |axis: &Self| axis.direction().dot(direction);
        let axes = Self::ALL.iter().map(|&(_, axis)| axis);
        axes.max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or_default()
    }

    /// Azimuth and elevation, degrees, of an eye that is in this direction of the target. Precondition: a unit vector.
    pub fn angles_of(self, toward_eye: DVec3) -> (f64, f64) {
        let seen = self.basis().transpose() * toward_eye;
        let elevation = seen.y.clamp(-1.0, 1.0).asin();
        (seen.x.atan2(seen.z).to_degrees(), elevation.to_degrees())
    }

    /// Into axes whose second is up, and whose third points to a viewer in front.
    pub(in crate::scene) fn environment_from_frame(self) -> Mat3 {
        self.basis().transpose().as_mat3()
    }

    /// Columns right, up, back of the view with azimuth and elevation 0, in world space.
    fn basis(self) -> DMat3 {
        let (right, up) = match self {
            Self::Y => (DVec3::X, DVec3::Y),
            Self::NegY => (DVec3::X, DVec3::NEG_Y),
            Self::Z => (DVec3::X, DVec3::Z),
            Self::NegZ => (DVec3::X, DVec3::NEG_Z),
            Self::X => (DVec3::NEG_Y, DVec3::X),
            Self::NegX => (DVec3::Y, DVec3::NEG_X),
        };
        DMat3::from_cols(right, up, right.cross(up))
    }
}

impl FromStr for UpAxis {
    type Err = ParseChoiceError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let word = text.trim_start_matches('+').to_ascii_lowercase();
        Self::ALL
            .iter()
            .find(|(name, _)| *name == word)
            .map(|&(_, axis)| axis)
            .ok_or_else(|| ParseChoiceError::new("up axis", text, Self::ALL.iter().map(|(name, _)| *name)))
    }
}

/// Views along the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewPreset {
    /// Azimuth 0.
    Front,
    /// Azimuth 180.
    Back,
    /// Azimuth -90.
    Left,
    /// Azimuth 90.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
}

impl ViewPreset {
    /// Every preset with its word, azimuth and elevation in degrees.
    pub const ALL: &'static [(&'static str, Self, f64, f64)] = &[
        ("Front", Self::Front, 0.0, 0.0),
        ("Back", Self::Back, 180.0, 0.0),
        ("Left", Self::Left, -90.0, 0.0),
        ("Right", Self::Right, 90.0, 0.0),
        ("Top", Self::Top, 0.0, 90.0),
        ("Bottom", Self::Bottom, 0.0, -90.0),
    ];
}

/// A camera on an orbit. World space is right-handed.
///
/// An orthographic camera shows the plane through the target like a perspective one with the same target, distance and
/// field of view, and everything else at the same scale. It is drawn as seen through a telephoto lens of a tenth of a
/// degree from as far away as that takes, so that renderers, traversals and truths know of one projection only: within
/// the sphere that fills the image, points are less than half a pixel from their position by parallel rays
/// (`tests/pictures/orthographic.rs`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Target that the camera looks at, in world space.
    pub target_in_world: DVec3,
    /// From the target to the eye, scene units; positive.
    pub distance: f64,
    /// Turn about the up axis, degrees; grows as the eye moves to its right.
    pub azimuth_deg: f64,
    /// Height above the horizon, degrees, -90 to 90.
    pub elevation_deg: f64,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// Up axis.
    pub up: UpAxis,
    /// Projection: determines if distant objects are smaller.
    pub projection: Projection,
    /// Picture plane: position of the image on the view axis.
    // A part of every camera: a separate type for sensors would have to be distinguished wherever a camera moves, is
    // compared or is stored.
    pub plane: PicturePlane,
}

/// Field of view of a new camera, degrees.
const DEFAULT_FOV_DEG: f64 = 45.0;

/// Cotangent of half the field of view through which an orthographic camera is drawn: of 0.05 degrees. A narrower one
/// leaves fewer bits of f32 for the content of the image.
// So passes, traversals and the ground truth need only one projection. In a sphere that fills 1280×720, points are less
// than half a pixel off: a quarter from the lens, the rest from f32; depth resolves a thousandth of its radius.
pub(in crate::scene) const TELEPHOTO_FOCAL: f64 = 1_145.915_299_281_798;

/// Fraction of the image height that the bounding sphere fills after [`Camera::frame_bounds`].
const FRAMED_FRACTION: f64 = 0.95;

/// The near plane, as a part of the distance to the target; nearer where content is, see [`ViewTransform::near_for`].
pub(super) const NEAR_FRACTION: f64 = 0.005;

impl Camera {
    /// A view from the front, a little above, that shows all of `bounds` (relative to `origin`).
    pub fn framing(bounds: &Aabb, origin: DVec3, up: UpAxis) -> Self {
        let mut camera = Self {
            target_in_world: origin,
            distance: 1.0,
            azimuth_deg: 30.0,
            elevation_deg: 15.0,
            fov_deg: DEFAULT_FOV_DEG,
            up,
            projection: Projection::Perspective,
            plane: PicturePlane::CENTERED,
        };
        camera.frame_bounds(bounds, origin);
        camera
    }

    /// Moves back or forth until the bounding sphere of `bounds` fits, keeping the direction.
    pub fn frame_bounds(&mut self, bounds: &Aabb, origin: DVec3) {
        self.plane = self.plane.centered();
        self.target_in_world = origin + bounds.center().as_dvec3();
        let radius = f64::from(bounds.radius());
        let radius = if radius > 0.0 { radius } else { 0.5 };
        let half_fov = (0.5 * self.fov_deg).to_radians();
        let radius_at_1 = match self.projection {
            Projection::Perspective => half_fov.sin(),
            Projection::Orthographic => half_fov.tan(),
        };
        self.distance = radius / (FRAMED_FRACTION * radius_at_1);
    }

    /// Moves so that `points` (relative to `origin`) just fit into an image whose width is `aspect` of its height,
    /// keeping the direction. Precondition: finite points and a positive aspect.
    ///
    /// How it works: each side of the image is a plane through the eye, and all points are to be on its inner side. The
    /// left and right sides determine the minimum distance of the eye and its position across the view; so do the upper
    /// and lower ones.
    pub fn frame_points(&mut self, points: &[Vec3], origin: DVec3, aspect: f64) {
        let bounds = Aabb::from_points(points);
        if bounds.is_empty() || bounds.radius() == 0.0 {
            return self.frame_bounds(&bounds, origin);
        }
        self.plane = self.plane.centered();
        let center = bounds.center().as_dvec3();
        let half_fov_tangent = (0.5 * self.fov_deg).to_radians().tan();
        let half_height = FRAMED_FRACTION * half_fov_tangent;
        let tangents = [half_height * aspect, half_height];
        // How much wider a point appears for being nearer: slightly through the telephoto lens of orthographic views,
        // which is visible if a cloud is much deeper than wide.
        let nearness = match self.projection {
            Projection::Perspective => 1.0,
            Projection::Orthographic => 1.0 / (TELEPHOTO_FOCAL * half_fov_tangent),
        };
        let rotation = self.view_from_world_rotation();
        // For each axis of the image: the farthest point on its low and on its high side.
        let mut sides = [[f64::NEG_INFINITY; 2]; 2];
        let mut nearest = f64::NEG_INFINITY;
        for point in points {
            let seen = rotation * (point.as_dvec3() - center);
            nearest = nearest.max(seen.z);
            for (axis, side) in sides.iter_mut().enumerate() {
                let toward = nearness * tangents[axis] * seen.z;
                side[0] = side[0].max(toward - seen[axis]);
                side[1] = side[1].max(toward + seen[axis]);
            }
        }
        let across = sides.map(|[low, high]| 0.5 * (high - low));
        let least = |axis: usize| 0.5 * (sides[axis][0] + sides[axis][1]) / tangents[axis];
        let distance = least(0).max(least(1));
        // A cloud that extends along the view direction has no width to be fitted; it must be beyond the near plane.
        let before_eye = nearness * nearest / (1.0 - 2.0 * NEAR_FRACTION);
        let distance = distance.max(before_eye + f64::from(bounds.radius()) * 1e-3);
        let target = rotation.transpose() * DVec3::new(across[0], across[1], 0.0);
        self.target_in_world = origin + center + target;
        self.distance = distance;
    }

    /// Looks along an axis, upright; target and distance stay.
    pub fn look_from(&mut self, preset: ViewPreset) {
        if let Some(&(_, _, azimuth, elevation)) = ViewPreset::ALL.iter().find(|(_, this, _, _)| *this == preset) {
            self.azimuth_deg = azimuth;
            self.elevation_deg = elevation;
            self.plane = PicturePlane::CENTERED;
        }
    }

    /// Rows of this rotation are the camera's right, up and backward directions.
    pub(crate) fn view_from_world_rotation(&self) -> DMat3 {
        let turn = DMat3::from_rotation_y(self.azimuth_deg.to_radians())
            * DMat3::from_rotation_x(-self.elevation_deg.to_radians());
        (self.up.basis() * turn * self.plane.rotation()).transpose()
    }

    /// Returns the eye position that images are drawn from, in world space.
    pub fn eye_in_world(&self) -> DVec3 {
        self.target_in_world + self.lens().distance * self.view_from_world_rotation().row(2)
    }

    /// Turns about the target. Elevation stops at the poles.
    pub fn orbit(&mut self, azimuth_deg: f64, elevation_deg: f64) {
        self.azimuth_deg = (self.azimuth_deg + azimuth_deg + 180.0).rem_euclid(360.0) - 180.0;
        self.elevation_deg = (self.elevation_deg + elevation_deg).clamp(-90.0, 90.0);
    }

    /// Shifts eye and target by pixels of an image `height_px` high, so that the target follows the pointer.
    pub fn pan_px(&mut self, dx_px: f64, dy_px: f64, height_px: f64) {
        let units_per_px = 2.0 * self.distance * (0.5 * self.fov_deg).to_radians().tan() / height_px.max(1.0);
        let rotation = self.view_from_world_rotation();
        self.target_in_world += (rotation.row(1) * dy_px - rotation.row(0) * dx_px) * units_per_px;
    }

    /// Multiplies the distance to the target; `factor < 1` moves closer.
    pub fn zoom(&mut self, factor: f64) {
        self.distance = (self.distance * factor).clamp(f64::MIN_POSITIVE.sqrt(), f64::MAX.sqrt());
    }

    /// Performs a [`Camera::zoom`] toward the surface seen the given number of pixels right of and below the centre of
    /// an image `height_px` high: at the depth of the target it stays there.
    pub fn zoom_toward(&mut self, factor: f64, right_px: f64, down_px: f64, height_px: f64) {
        let before = self.distance;
        self.zoom(factor);
        // The factor by which the distance actually shrank, also at its limits.
        let moved = 1.0 - self.distance / before;
        let units_per_px = 2.0 * before * (0.5 * self.fov_deg).to_radians().tan() / height_px.max(1.0);
        let rotation = self.view_from_world_rotation();
        let offset = (rotation.row(0) * right_px - rotation.row(1) * down_px) * units_per_px;
        self.target_in_world += offset * moved;
    }

    /// Moves eye and target together by view-space units: right, up, backward.
    pub fn fly(&mut self, movement_in_view: DVec3) {
        self.target_in_world += self.view_from_world_rotation().transpose() * movement_in_view;
    }

    /// Turns about the eye, as when looking around: the target swings.
    pub fn look_around(&mut self, azimuth_deg: f64, elevation_deg: f64) {
        let before = self.view_from_world_rotation().row(2);
        self.orbit(azimuth_deg, elevation_deg);
        let after = self.view_from_world_rotation().row(2);
        self.target_in_world += (before - after) * self.distance;
    }

    /// Returns the lens that images are drawn with.
    pub(in crate::scene) fn lens(&self) -> Lens {
        let focal = 1.0 / (0.5 * self.fov_deg.clamp(1e-3, 179.0)).to_radians().tan();
        match self.projection {
            Projection::Perspective => Lens {
                focal,
                distance: self.distance,
            },
            Projection::Orthographic => Lens {
                focal: TELEPHOTO_FOCAL,
                // The camera itself stays the perspective one at the same scale, so switching between projections loses
                // nothing.
                distance: self.distance * TELEPHOTO_FOCAL / focal,
            },
        }
    }

    /// Returns the view transform used by shaders and the octree, for frames relative to `origin`.
    pub fn transform(&self, origin: DVec3, viewport_px: [u32; 2]) -> ViewTransform {
        let rotation = self.view_from_world_rotation();
        let eye = self.eye_in_world() - origin;
        let eye_high = eye.as_vec3();
        let lens = self.lens();
        let focal_y = lens.focal;
        let [width, height] = viewport_px.map(|edge| f64::from(edge.max(1)));
        ViewTransform {
            view_from_frame_rotation: rotation.as_mat3(),
            eye_high,
            eye_low: (eye - eye_high.as_dvec3()).as_vec3(),
            focal: [
                (focal_y * self.plane.pixel_aspect * height / width) as f32,
                focal_y as f32,
            ],
            near: lens.near() as f32,
            pixels_per_unit_at_1: (focal_y * height * 0.5) as f32,
            center_ndc: self.plane.center_ndc([width, height]).as_vec2().to_array(),
            rows_of_whole: [0.0, 1.0],
            telephoto: (lens.distance / self.distance) as f32,
            up: self.up,
        }
    }
}

/// A lens, and how far from the target it is.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene) struct Lens {
    /// Cotangent of half the vertical field of view.
    pub(in crate::scene) focal: f64,
    /// From the target to the eye, scene units.
    pub(in crate::scene) distance: f64,
}

impl Lens {
    /// From the eye to the near plane, as long as the content is unknown.
    pub(in crate::scene) fn near(&self) -> f64 {
        self.distance * NEAR_FRACTION
    }
}

/// A camera as f32 and relative to one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewTransform {
    /// Rotation into view space (right, up, backward).
    pub view_from_frame_rotation: Mat3,
    /// The eye relative to the sequence origin, rounded to f32.
    pub eye_high: Vec3,
    /// Rounding remainder (low part).
    pub eye_low: Vec3,
    /// Cotangents of half the horizontal and vertical field of view.
    pub focal: [f32; 2],
    /// Distance to the near plane.
    pub near: f32,
    /// A length `s` at distance `d` covers `s / d` times this many pixels.
    pub pixels_per_unit_at_1: f32,
    /// Principal point: where the view axis meets the image, in normalised device coordinates: `[0, 0]`, except for a
    /// part of a larger image and where the [`PicturePlane`] shifts it.
    pub center_ndc: [f32; 2],
    /// Positions of the upper and the lower edge in the whole image, as fractions of its height from the top: `[0, 1]`,
    /// except for a part.
    pub rows_of_whole: [f32; 2],
    /// Telephoto factor: ratio of the eye distance to the camera's distance; 1 in perspective.
    pub telephoto: f32,
    /// The axis of the frame that points up.
    pub up: UpAxis,
}

impl ViewTransform {
    /// Reverse-Z projection with the far plane at infinity: depth is `near / distance`.
    pub fn clip_from_view(&self) -> Mat4 {
        Mat4::from_cols(
            Vec4::new(self.focal[0], 0.0, 0.0, 0.0),
            Vec4::new(0.0, self.focal[1], 0.0, 0.0),
            Vec4::new(-self.center_ndc[0], -self.center_ndc[1], 0.0, -1.0),
            Vec4::new(0.0, 0.0, self.near, 0.0),
        )
    }

    /// This view of an image of `whole_px`, restricted to the part of `part_px` whose upper left pixel is `start_px`:
    /// the same rays through the same pixels. Precondition: it is the view of a whole image.
    #[must_use]
    pub fn of_part(&self, whole_px: [u32; 2], start_px: [u32; 2], part_px: [u32; 2]) -> Self {
        let [whole, start, part] = [whole_px, start_px, part_px].map(|px| px.map(f64::from));
        let to_center_px = [0, 1].map(|axis| 0.5 * (whole[axis] - part[axis]) - start[axis]);
        let of_whole_px = [0, 1].map(|axis| 0.5 * whole[axis] * f64::from(self.center_ndc[axis]));
        Self {
            focal: [0, 1].map(|axis| (f64::from(self.focal[axis]) * whole[axis] / part[axis]) as f32),
            // Rows are counted downwards.
            center_ndc: [
                (2.0 * (of_whole_px[0] + to_center_px[0]) / part[0]) as f32,
                (2.0 * (of_whole_px[1] - to_center_px[1]) / part[1]) as f32,
            ],
            rows_of_whole: [start[1], start[1] + part[1]].map(|row| (row / whole[1]) as f32),
            ..*self
        }
    }

    /// Returns the view parameters for an octree traversal: down to the leaves, unless they project below `lod_px`.
    pub fn select_view(&self, lod_px: f32) -> SelectView {
        SelectView {
            frustum: self.frustum_in_frame(),
            eye: self.eye_high,
            pixels_per_unit_at_1: self.pixels_per_unit_at_1,
            lod_px,
            metric: LodMetric::default(),
            deepest_level: SelectView::ALL_LEVELS,
        }
    }

    /// The frustum in the space of the frame.
    pub fn frustum_in_frame(&self) -> Frustum {
        let view_from_frame = Mat4::from_mat3(self.view_from_frame_rotation) * Mat4::from_translation(-self.eye_high);
        Frustum::from_clip_matrix(&(self.clip_from_view() * view_from_frame))
    }

    /// A point of the frame in view space.
    pub fn to_view(&self, position_in_frame: Vec3) -> Vec3 {
        // In this order no precision is lost near the eye.
        self.view_from_frame_rotation * ((position_in_frame - self.eye_high) - self.eye_low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Aabb {
        Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        }
    }

    #[test]
    fn view_presets_are_where_their_names_say() {
        let mut camera = Camera::framing(&unit_box(), DVec3::ZERO, UpAxis::Y);
        let cases = [
            (ViewPreset::Front, DVec3::Z),
            (ViewPreset::Back, DVec3::NEG_Z),
            (ViewPreset::Right, DVec3::X),
            (ViewPreset::Left, DVec3::NEG_X),
            (ViewPreset::Top, DVec3::Y),
            (ViewPreset::Bottom, DVec3::NEG_Y),
        ];
        for (preset, direction) in cases {
            camera.look_from(preset);
            let eye = camera.eye_in_world() / camera.distance;
            assert!((eye - direction).length() < 1e-12, "{preset:?}: {eye}");
        }
    }

    #[test]
    fn up_is_up_for_every_axis() {
        for &(name, up) in UpAxis::ALL {
            let camera = Camera {
                azimuth_deg: 37.0,
                elevation_deg: 20.0,
                ..Camera::framing(&unit_box(), DVec3::ZERO, up)
            };
            let transform = camera.transform(DVec3::ZERO, [100, 100]);
            let axis = up.basis().col(1).as_vec3();
            let rise = transform.to_view(axis) - transform.to_view(Vec3::ZERO);
            assert!(rise.y > 0.9 && rise.x.abs() < 1e-6, "{name}: {rise}");
            assert!(
                transform.view_from_frame_rotation.determinant() > 0.99,
                "{name} is mirrored"
            );
        }
    }

    #[test]
    fn the_target_is_centered_at_its_distance() {
        let camera = Camera::framing(&unit_box(), DVec3::new(1e7, -2e7, 3e6), UpAxis::Z);
        let transform = camera.transform(DVec3::new(1e7, -2e7, 3e6), [640, 480]);
        let target = transform.to_view(Vec3::ZERO);
        assert!((target + Vec3::Z * camera.distance as f32).length() < 1e-5, "{target}");
    }

    #[test]
    fn panning_moves_the_target_with_the_pointer() {
        let mut camera = Camera::framing(&unit_box(), DVec3::ZERO, UpAxis::Y);
        camera.pan_px(48.0, -24.0, 480.0);
        let transform = camera.transform(DVec3::ZERO, [480, 480]);
        let clip = transform.clip_from_view() * transform.to_view(Vec3::ZERO).extend(1.0);
        let px = clip.truncate().truncate() / clip.w * 240.0;
        assert!((px.x - 48.0).abs() < 1e-3 && (px.y - 24.0).abs() < 1e-3, "{px}");
    }

    #[test]
    fn an_image_part_matches_the_full_image() {
        let camera = Camera::framing(&unit_box(), DVec3::ZERO, UpAxis::Z);
        let whole = camera.transform(DVec3::ZERO, [640, 480]);
        let part = whole.of_part([640, 480], [400, 120], [240, 90]);
        let px = |view: &ViewTransform, size: [f32; 2]| {
            let clip = view.clip_from_view() * view.to_view(Vec3::new(0.3, -0.2, 0.4)).extend(1.0);
            [
                (clip.x / clip.w + 1.0) * 0.5 * size[0],
                (1.0 - clip.y / clip.w) * 0.5 * size[1],
            ]
        };
        let (in_whole, in_part) = (px(&whole, [640.0, 480.0]), px(&part, [240.0, 90.0]));
        assert!((in_whole[0] - in_part[0] - 400.0).abs() < 1e-3, "{in_part:?}");
        assert!((in_whole[1] - in_part[1] - 120.0).abs() < 1e-3, "{in_part:?}");
        assert_eq!(part.rows_of_whole, [0.25, 0.4375]);
        assert_eq!(whole.of_part([640, 480], [0, 0], [640, 480]), whole);
    }

    #[test]
    fn looking_around_does_not_move_the_eye() {
        let mut camera = Camera::framing(&unit_box(), DVec3::ZERO, UpAxis::Z);
        let before = camera.eye_in_world();
        camera.look_around(25.0, -10.0);
        assert!((camera.eye_in_world() - before).length() < 1e-9);
    }
}
