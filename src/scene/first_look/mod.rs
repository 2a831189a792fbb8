//! Automatic settings of a sequence without chosen ones: guesses of its kind, up axis, viewpoint and render mode.
//!
//! **How it works.** A few thousand points of some frames represent the sequence ([`CloudSample`]). Outliers are
//! removed (`trim.rs`), the distribution of points around the sensor determines the kind of scene (`kind.rs`), the
//! format or the orientation of the scene determines the up axis (`up.rs`), and the viewpoint is where most is seen
//! (`standpoint.rs`). Every guess comes with its reason, for the user to accept or change it. It takes a few
//! milliseconds, for clouds of any size, and the same frames give the same answer.

mod colors;
mod ground;
mod kind;
mod primitive;
mod sample;
mod shape;
mod standpoint;
#[cfg(test)]
mod test_clouds;
#[cfg(test)]
mod tests;
mod trim;
mod up;

pub use colors::ColorGuess;
pub use kind::CaptureKind;
use primitive::Captured;
pub(crate) use sample::{PointSpacing, typical_spacing};
pub use standpoint::Standpoint;
use up::Up;

use super::{Camera, Primitive, UpAxis};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::{AxisConvention, Frame};
use crate::math::Aabb;
use crate::photos::{Photo, ViewSet};
use crate::progress::Progress;
use crate::rgbd::{self, Sensor};
use crate::scene::view::pinhole_view::sensor_target_distance;
use crate::sequence::{ColorHints, Detail, Sequence};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use sample::{CloudSample, MAX_POINTS, median_luma, quantile};

/// Half of the points of a dark scan are darker than this, 0 to 255.
const DARK_LUMA: f32 = 45.0;

/// Guesses about a sequence.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is a guess of its own")]
pub struct FirstLook {
    /// Kind of capture.
    pub kind: CaptureKind,
    /// Up axis.
    pub up: UpAxis,
    /// The reason for the up axis.
    pub up_why: &'static str,
    /// Strength of the evidence for the up axis.
    pub up_evidence: Evidence,
    /// From where it is seen first.
    pub from: Standpoint,
    /// A mesh where the files have triangles, surfels, or points where no surface was sampled.
    pub primitive: Primitive,
    /// The reason for the primitive.
    pub primitive_why: &'static str,
    /// True if there are triangles that can be drawn instead of points.
    pub has_faces: bool,
    /// Share of places of the cloud whose neighbours lie in a plane.
    pub planar_share: f32,
    /// Ratio of the spacing of the sparse points to the spacing of most points.
    pub spacing_spread: f32,
    /// True if back-face culling is safe: culling surfaces that face away hides nothing from any side.
    pub is_closed: bool,
    /// True if normals are known to point outwards: the file has them, or a sensor saw the surface from there.
    pub knows_outside: bool,
    /// Edge of points that are drawn as such, pixels.
    pub point_size_px: f32,
    /// Guessed colour source of the points, and the reason for it.
    pub colors: ColorGuess,
    /// True if the colours have baked-in lighting: from a camera, or from splats reconstructed from images.
    pub colors_have_light: bool,
    /// True if the file's colours are so dark that the default background would hide them.
    pub is_dark: bool,
    /// The box around the points of the frames that were looked at, but for outliers, relative to the origin.
    pub trimmed: Aabb,
    /// The box around all points of these frames.
    pub full: Aabb,
    /// Sample of the first frame, without outliers.
    sample: CloudSample,
    /// Places that the first image is to show, of all examined frames.
    shown: Vec<Vec3>,
    eye: Option<Vec3>,
    /// First of the posed images of the scene, if there are any.
    photo: Option<Photo>,
}

impl FirstLook {
    /// Guesses from `frames`, whose positions are relative to `origin`. The first determines its kind, all of them its
    /// extent.
    pub fn of(frames: &[&Frame], origin: DVec3) -> Self {
        let samples = frames.iter().filter(|frame| !frame.is_empty()).map(|frame| {
            let all = CloudSample::of(frame, MAX_POINTS);
            (*frame, all.at(&trim::inliers(&all)), all.positions.len())
        });
        let samples: Vec<(&Frame, CloudSample, usize)> = samples.collect();
        let zero = (-origin).as_vec3();
        let luma = samples.first().and_then(|(frame, ..)| median_luma(frame));
        let (convention, sensor) = samples
            .first()
            .map_or((None, None), |(frame, ..)| (frame.convention(), frame.sensor()));
        let full = samples
            .iter()
            .fold(Aabb::EMPTY, |bounds, (frame, ..)| bounds.union(&frame.bounds()));
        let outliers = samples
            .first()
            .map_or(0, |(_, sample, all)| all - sample.positions.len());
        let sample = samples.first().map(|(_, sample, _)| sample.clone()).unwrap_or_default();
        let told = Told::by(&sample, convention, sensor, zero);
        let up = told.up.axis;
        let mut shown = Vec::new();
        for (_, sample, _) in samples {
            match told.kind {
                CaptureKind::Sweep => shown.extend(near(&sample.positions, told.eye.unwrap_or(zero), up)),
                _ => shown.extend(sample.positions),
            }
        }
        let trimmed = Aabb::from_points(&shown);
        let has_faces = frames.iter().any(|frame| frame.has_faces());
        let are_splats = frames.first().is_some_and(|frame| frame.ellipses().is_some());
        let (primitive, primitive_why) = primitive::choose(&Captured {
            kind: told.kind,
            sample: &sample,
            outliers,
            trimmed: &trimmed,
            eye: told.eye.unwrap_or(zero),
            has_faces,
            are_splats,
        });
        let from = standpoint::standpoint(told.kind, up, &sample, &trimmed, told.eye);
        Self {
            kind: told.kind,
            up,
            up_why: told.up.why,
            up_evidence: told.up.evidence,
            from,
            primitive,
            primitive_why,
            has_faces,
            planar_share: sample.planar_share,
            spacing_spread: sample.spread(),
            is_closed: standpoint::is_closed(&sample, &trimmed),
            point_size_px: primitive::point_size_px(frames.first().map_or(0, |frame| frame.points_in_file())),
            colors: frames
                .first()
                .map(|frame| ColorGuess::of(frame, &color_hints(told.kind, up)))
                .unwrap_or_default(),
            // When relit with estimated normals, depth steps show up as waves: where the points of five of Redwood's
            // frames are opaque, the PSNR against the third image is 15.3 dB with lighting and 36.0 dB without.
            colors_have_light: frames.first().is_some_and(|frame| {
                let is_image = frame.grid().is_some() || told.kind == CaptureKind::CameraFrame;
                (is_image || are_splats) && frame.value_sample().has_telling_colors()
            }),
            is_dark: luma.is_some_and(|luma| luma < DARK_LUMA),
            // Both sides of a splat look the same: its normal points to either.
            knows_outside: sensor.is_some() || (has_normals(&sample) && !are_splats),
            trimmed,
            full,
            sample,
            shown,
            eye: told.eye,
            photo: None,
        }
    }

    /// Guesses from the first frame of `sequence` and from as many others as can be read alongside it in negligible
    /// time: frames of a scan that walks through a room should all be in the first view. A frame that cannot be read is
    /// skipped.
    pub fn of_sequence(first: &Frame, sequence: &Sequence) -> Self {
        let others: Vec<Frame> = others(sequence.len(), first.points_in_file())
            .into_par_iter()
            .filter_map(|index| {
                let detail = Detail::at_most(MAX_POINTS as u32);
                let loaded = sequence.load(index, detail, &Progress::default());
                loaded.ok().map(|loaded| loaded.frame)
            })
            .collect();
        let frames: Vec<&Frame> = std::iter::once(first).chain(&others).collect();
        Self::of(&frames, sequence.origin()).with_photos_of(sequence)
    }

    /// Guesses from the first frame of `sequence` alone.
    pub fn of_first(first: &Frame, sequence: &Sequence) -> Self {
        Self::of(&[first], sequence.origin()).with_photos_of(sequence)
    }

    fn with_photos_of(self, sequence: &Sequence) -> Self {
        match sequence.source().posed_images(0) {
            Some(set) => self.with_photos(&set),
            None => self,
        }
    }

    /// Returns this guess adapted to posed images: they are held upright, are projected onto a surface, and the first
    /// of them is the first view.
    fn with_photos(mut self, set: &ViewSet) -> Self {
        let upwards = set.photos.iter().map(|photo| -photo.camera_from_world.matrix3.row(1));
        if let Some(upwards) = upwards.sum::<DVec3>().try_normalize() {
            self.up_why = "the images are upright";
            self.up_evidence = Evidence::Convention;
            self.up = UpAxis::nearest(upwards);
        }
        self.primitive = Primitive::Surfel;
        self.primitive_why = "there are images of a surface";
        // The colours come from the images.
        self.colors.why.clear();
        self.colors_have_light = true;
        self.photo = set.photos.first().cloned();
        self
    }

    /// The guessed up axis and primitive, and colours where the file has none.
    pub fn assumptions(&self) -> Vec<Assumption> {
        let primitive = self.primitive.to_string();
        let evidence = match self.primitive {
            Primitive::Mesh | Primitive::Ellipse => Evidence::File,
            _ => Evidence::Statistics,
        };
        let mut assumptions = vec![
            Assumption::new(Subject::UpAxis, self.up.name(), self.up_why, self.up_evidence),
            Assumption::new(Subject::Primitive, primitive, self.primitive_why, evidence),
        ];
        assumptions.extend(self.colors.assumption());
        assumptions
    }

    /// Returns true if the points sample a surface, so that disks or ellipses show it.
    pub fn has_surface(&self) -> bool {
        matches!(self.primitive, Primitive::Surfel | Primitive::Ellipse | Primitive::Mesh)
    }

    /// Returns true if there are posed images of the scene.
    pub fn has_photos(&self) -> bool {
        self.photo.is_some()
    }

    /// Returns the camera of a posed image, orbiting about the centre of its scene.
    pub fn camera_of_photo(&self, photo: &Photo, origin: DVec3) -> Camera {
        self.camera_of_pinhole(&photo.camera, photo.camera_from_world.inverse(), origin)
    }

    /// Returns the camera of a pinhole, orbiting about the centre of its scene.
    pub fn camera_of_pinhole(&self, pinhole: &rgbd::Camera, world_from_camera: DAffine3, origin: DVec3) -> Camera {
        let center = origin + self.trimmed.center().as_dvec3();
        let distance = sensor_target_distance(&world_from_camera, center, f64::from(self.trimmed.radius()));
        Camera::of_pinhole(pinhole, world_from_camera, distance, self.up)
    }

    /// Describes in words the primitive that is drawn instead if the files lack the chosen one.
    pub fn lack_of(&self, chosen: Primitive) -> Option<String> {
        let lacks = chosen == Primitive::Mesh && !self.has_faces;
        lacks.then(|| format!("these files have no triangles: they are drawn as {}s", self.primitive))
    }

    /// Returns this guess with the up axis replaced by a known one.
    #[must_use]
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up_why = "chosen";
        self.up_evidence = Evidence::File;
        self.up = up;
        self.from = standpoint::standpoint(self.kind, up, &self.sample, &self.trimmed, self.eye);
        self
    }

    /// Hints for colours that were not chosen.
    pub fn color_hints(&self) -> ColorHints {
        color_hints(self.kind, self.up)
    }

    /// Sensor position relative to the origin, if a file or the points reveal it.
    pub fn eye(&self) -> Option<Vec3> {
        self.eye
    }

    /// The first view, in which all points except outliers fill an image whose width is `aspect` of its height.
    pub fn camera(&self, origin: DVec3, aspect: f64) -> Camera {
        if let Some(photo) = &self.photo {
            return self.camera_of_photo(photo, origin);
        }
        let mut camera = Camera::framing(&self.trimmed, origin, self.up);
        camera.azimuth_deg = self.from.azimuth_deg;
        camera.elevation_deg = self.from.elevation_deg;
        self.frame(&mut camera, origin, aspect, &Aabb::EMPTY);
        camera
    }

    /// Returns the initial camera with `up` as the up axis, regardless of the guess.
    pub fn camera_with_up(&self, up: UpAxis, origin: DVec3, aspect: f64) -> Camera {
        if up == self.up {
            return self.camera(origin, aspect);
        }
        self.clone().with_up(up).camera(origin, aspect)
    }

    /// Returns the camera of the sensor that captured a frame whose points are in the coordinate frame of its depth
    /// camera: that camera, orbiting about the centre of its scene.
    pub fn camera_of_sensor(&self, sensor: &Sensor, origin: DVec3) -> Camera {
        self.camera_of_pinhole(&sensor.rig.depth, DAffine3::IDENTITY, origin)
    }

    /// Moves `camera` so that all points except outliers fill the image, together with the box `second_bounds`
    /// (relative to `origin`), keeping its direction.
    pub fn frame(&self, camera: &mut Camera, origin: DVec3, aspect: f64, second_bounds: &Aabb) {
        // The view of an image shows exactly that image's scene.
        let photo = self.photo.as_ref().filter(|_| second_bounds.is_empty());
        if photo.is_some_and(|photo| self.camera_of_photo(photo, origin) == *camera) {
            return;
        }
        if second_bounds.is_empty() {
            return camera.frame_points(&self.shown, origin, aspect);
        }
        let corners = (0..8).map(|corner| {
            let side = [0, 1, 2].map(|axis| (corner >> axis & 1) as f32);
            second_bounds.min + Vec3::from_array(side) * second_bounds.extent()
        });
        let shown: Vec<Vec3> = self.shown.iter().copied().chain(corners).collect();
        camera.frame_points(&shown, origin, aspect);
    }
}

/// Hints for colours: if the ground was scanned, height is more informative than the direction of normals.
fn color_hints(kind: CaptureKind, up: UpAxis) -> ColorHints {
    ColorHints {
        up: Some(up.direction().as_vec3()),
        prefers_height: Some(kind.is_of_ground()),
    }
}

/// Evidence from the points and the file.
struct Told {
    kind: CaptureKind,
    up: Up,
    eye: Option<Vec3>,
}

impl Told {
    fn by(sample: &CloudSample, convention: Option<AxisConvention>, sensor: Option<Vec3>, zero: Vec3) -> Self {
        let bounds = trim::bounds(sample);
        let eye = sensor.unwrap_or(zero);
        let by_format = convention.map(by_convention);
        // Only glTF, LAS and optical frames of ROS override the points: formats can be wrong (E57 files with Y down
        // exist).
        let sure = by_format.filter(|_| convention.is_some_and(AxisConvention::is_binding));
        if let Some(camera) = kind::camera_frame(sample, eye)
            && sure.is_none_or(|sure| sure.axis == camera.axis)
        {
            return Self {
                kind: CaptureKind::CameraFrame,
                up: camera,
                eye: Some(eye),
            };
        }
        if let Some(around) = kind::sweep(sample, eye) {
            return Self {
                kind: CaptureKind::Sweep,
                up: sure.unwrap_or_else(|| up_of_sweep(&around, by_format)),
                eye: Some(eye),
            };
        }
        let is_flat = bounds.is_flat_along_z();
        let flat = || is_flat.then(|| Up::by_points(UpAxis::Z, "it is wide and flat along Z"));
        let field = shape::of_height_field(sample, &bounds);
        let fallback = Up::new(UpAxis::Y, "as most models have it", Evidence::Fallback);
        let is_opposite = |up: &Up| by_format.is_some_and(|format| up.is_opposite(format));
        // Shape heuristics never turn a cloud upside down: one that looked for narrow feet put bunnies on their ears.
        let on_zero = up::on_zero(&bounds, zero).filter(|up| !is_opposite(up));
        let mut on_base = up::on_base(sample, &bounds).filter(|up| !is_opposite(up));
        let mut symmetric = shape::of_symmetry(sample, &bounds);
        // If two heuristics disagree, neither counts.
        if let (Some(base), Some(other)) = (on_base, symmetric)
            && base.axis != other.up.axis
        {
            (on_base, symmetric) = (None, None);
        }
        let guess = sure
            .or_else(|| ground::of_map_coordinates(&bounds, zero))
            .or_else(|| ground::of_undersides(sample, &bounds))
            .or(on_zero)
            .or(on_base)
            .or(symmetric.filter(|found| found.is_strong).map(|found| found.up))
            .or(by_format)
            .or_else(|| shape::of_slender(&bounds))
            .or(symmetric.map(|found| found.up))
            .or(field)
            .or_else(flat)
            .unwrap_or(fallback);
        // Surveys may contain a hill.
        let is_survey = convention == Some(AxisConvention::ZUp)
            && bounds.extent().z < 0.7 * bounds.extent().truncate().max_element();
        let is_terrain = guess.axis == UpAxis::Z && (is_flat || is_survey || field.is_some());
        Self {
            kind: if is_terrain {
                CaptureKind::Terrain
            } else {
                CaptureKind::Object
            },
            up: guess,
            eye: sensor.filter(|&eye| is_outside(&bounds, eye)),
        }
    }
}

/// Returns the indices of the frames examined in addition to the first one of `count`, which has `point_count` points:
/// up to a million points together, four at most.
fn others(count: usize, point_count: usize) -> Vec<usize> {
    const MAX_FRAMES: usize = 4;
    const MAX_POINTS_READ: usize = 1_000_000;
    let max = (MAX_POINTS_READ / point_count.max(1)).min(MAX_FRAMES);
    let last = count.saturating_sub(1);
    let mut others: Vec<usize> = (1..=max).map(|part| part * last / max.max(1)).collect();
    others.dedup();
    others.retain(|&index| index > 0);
    others
}

/// Returns true if the file has normals for all but a few points.
fn has_normals(sample: &CloudSample) -> bool {
    let without = sample.normals.iter().filter(|&&normal| normal == Vec3::ZERO).count();
    !sample.normals.is_empty() && 20 * without <= sample.normals.len()
}

fn is_outside(bounds: &Aabb, place: Vec3) -> bool {
    (place.cmplt(bounds.min) | place.cmpgt(bounds.max)).any()
}

fn by_convention(convention: AxisConvention) -> Up {
    let (axis, why) = match convention {
        AxisConvention::YUp => (UpAxis::Y, "the format says that Y is up"),
        AxisConvention::ZUp => (UpAxis::Z, "the format says that Z is up"),
        AxisConvention::UsuallyZUp => (
            UpAxis::Z,
            "most files of this format, or of the program that wrote this one, have Z up",
        ),
        AxisConvention::Camera => (UpAxis::NegY, "the file has the axes of a camera: Y is down"),
        AxisConvention::UsuallyYDown => (UpAxis::NegY, "most Gaussian splats have Y down"),
    };
    Up::new(axis, why, Evidence::Convention)
}

/// The axis about which the scanner turns. The ground is below it.
fn up_of_sweep(around: &kind::Around, by_format: Option<Up>) -> Up {
    /// Scanners that look up and down as far as around have no recognisable axis.
    const FLAT: f32 = 0.35;
    /// Unless directions are this much flatter along another axis, it is the format's.
    const MUCH_FLATTER: f32 = 0.6;
    let axis = around.flattest_axis();
    if let Some(format) = by_format {
        let along_format = around.mean_abs_direction.dot(format.axis.direction().as_vec3().abs());
        if around.mean_abs_direction[axis] > MUCH_FLATTER * along_format {
            return format;
        }
    }
    if around.mean_abs_direction[axis] > FLAT {
        return by_format.unwrap_or(Up::new(UpAxis::Z, "LiDAR sensors have Z up", Evidence::Convention));
    }
    let is_positive = axis == 2 || around.mean_direction[axis] < 0.0;
    Up::by_points(up::along(axis, is_positive), "the scanner turns about this axis")
}

/// Points of a sweep that are worth looking at first: nine in ten are nearer to the scanner than the tail that makes it
/// so wide.
fn near(positions: &[Vec3], eye: Vec3, up: UpAxis) -> Vec<Vec3> {
    const SHOWN: f64 = 0.93;
    let up = up.direction().as_vec3();
    let range = |position: &Vec3| (*position - eye).reject_from_normalized(up).length();
    let mut ranges: Vec<f32> = positions.iter().map(range).collect();
    let max = quantile(&mut ranges, SHOWN);
    let is_near = |position: &&Vec3| range(position) <= max;
    positions.iter().filter(is_near).copied().collect()
}
