//! Capture kind: the subject and the type of sensor, estimated from the distribution of the points around the sensor
//! position.
//!
//! **How it works.** A camera sees points before it, within a pyramid along one axis of its coordinates. A LiDAR sensor
//! stands among its points, all around, and they are the farther apart the farther away they are. Where no file states
//! the sensor position, the zero of its coordinates is tried: sensors write their own.

use super::sample::{CloudSample, quantile};
use super::trim;
use super::up::Up;
use crate::scene::UpAxis;
use glam::{Vec3, Vec3Swizzles as _};

/// Kind of capture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaptureKind {
    /// Something to walk around.
    Object,
    /// Camera frame, captured from one position.
    CameraFrame,
    /// LiDAR sweep around the sensor.
    Sweep,
    /// Wide and flat.
    Terrain,
}

impl CaptureKind {
    /// Returns true if the ground was scanned.
    pub(super) fn is_of_ground(self) -> bool {
        matches!(self, Self::Sweep | Self::Terrain)
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::CameraFrame => "frame of a camera",
            Self::Sweep => "LiDAR sweep",
            Self::Terrain => "terrain",
        }
    }
}

/// The axis a camera looks along, and which one is up then.
struct CameraAxes {
    forward: fn(Vec3) -> Vec3,
    up: UpAxis,
    why: &'static str,
}

/// Conventions of cameras. The function turns a vector into right, up, forward; handedness does not matter here.
const CAMERAS: [CameraAxes; 3] = [
    CameraAxes {
        forward: |p| p,
        up: UpAxis::NegY,
        why: "all points are before a camera that looks along +Z: Y is down",
    },
    CameraAxes {
        forward: |p| Vec3::new(p.x, p.y, -p.z),
        up: UpAxis::Y,
        why: "all points are before a camera that looks along -Z: Y is up",
    },
    CameraAxes {
        forward: |p| p.yzx(),
        up: UpAxis::Z,
        why: "all points are before a sensor that looks along +X: Z is up",
    },
];

/// The up axis of the camera at `eye` before which all points lie, with the reason.
pub(super) fn camera_frame(sample: &CloudSample, eye: Vec3) -> Option<Up> {
    let is_before = |camera: &&CameraAxes| {
        let seen: Vec<Vec3> = sample
            .positions
            .iter()
            .map(|&position| (camera.forward)(position - eye))
            .collect();
        is_before_camera(&seen)
    };
    let camera = CAMERAS.iter().find(is_before);
    camera.map(|camera| Up::by_points(camera.up, camera.why))
}

/// Returns true if points lie before a camera at zero that looks along +Z.
fn is_before_camera(seen: &[Vec3]) -> bool {
    /// Tangents of half the widest and the narrowest angle of view.
    const WIDEST: f32 = 1.6;
    const NARROWEST: f32 = 0.03;
    /// Maximum offset of the image centre from the axis, as a fraction of the image edge.
    const OFF_AXIS: f32 = 0.3;
    /// Seen from above, plains are thin; a wall that a camera looks at fills its image.
    const THIN: f32 = 0.15;
    const FULL: f32 = 0.25;
    if seen.is_empty() || seen.iter().any(|position| position.z <= 0.0) {
        return false;
    }
    let span = |value: fn(&Vec3) -> f32| {
        let mut values: Vec<f32> = seen.iter().map(value).collect();
        (quantile(&mut values, 0.01), quantile(&mut values, 0.99))
    };
    let (near, far) = span(|p| p.z);
    if near < 0.02 * far {
        return false;
    }
    let views = [span(|p| p.x / p.z), span(|p| p.y / p.z)];
    let is_centred = views.iter().all(|&(low, high)| {
        (low + high).abs() * 0.5 <= OFF_AXIS * (high - low)
            && low.abs().max(high.abs()) <= WIDEST
            && high - low >= 2.0 * NARROWEST
    });
    let edges = [span(|p| p.x), span(|p| p.y)].map(|(low, high)| high - low);
    let is_thin = far - near < THIN * edges[0].min(edges[1]);
    let is_full = views.iter().all(|&(low, high)| high - low >= 2.0 * FULL);
    is_centred && (!is_thin || is_full) && is_one_surface(seen)
}

/// Returns true if points that are seen in one direction are at about the same distance, on one surface: a camera sees
/// only the nearest surface, while a tree that stands above zero is seen through.
fn is_one_surface(seen: &[Vec3]) -> bool {
    /// Cells along an edge of the image, and minimum points of those that count.
    const CELLS: usize = 24;
    const MIN_POINTS: usize = 4;
    const MIN_CELLS: usize = 20;
    /// Depth within a cell as a share of the depth of all, or of half of the width: depth images have 0.03 to 0.08.
    const MAX_DEPTH: f32 = 0.11;
    let range = |value: &dyn Fn(&Vec3) -> f32| {
        let mut values: Vec<f32> = seen.iter().map(value).collect();
        (quantile(&mut values, 0.01), quantile(&mut values, 0.99))
    };
    let width = |(low, high): (f32, f32)| high - low;
    let views = [range(&|p| p.x / p.z), range(&|p| p.y / p.z)];
    let mut cells: Vec<Vec<f32>> = vec![Vec::new(); CELLS * CELLS];
    for position in seen {
        let place = |axis: usize| {
            let share = (position[axis] / position.z - views[axis].0) / width(views[axis]);
            (0.0..1.0).contains(&share).then_some((share * CELLS as f32) as usize)
        };
        if let (Some(x), Some(y)) = (place(0), place(1)) {
            cells[x * CELLS + y].push(position.z);
        }
    }
    let dense = cells.iter_mut().filter(|cell| cell.len() >= MIN_POINTS);
    let mut depths: Vec<f32> = dense.map(|cell| quantile(cell, 0.9) - quantile(cell, 0.1)).collect();
    let narrower = width(range(&|p| p.x)).min(width(range(&|p| p.y)));
    let whole = width(range(&|p| p.z)).max(0.5 * narrower);
    depths.len() < MIN_CELLS || quantile(&mut depths, 0.5) <= MAX_DEPTH * whole
}

/// Statistics of points around the place of a scanner.
pub(super) struct Around {
    /// Mean of the unit vectors from the scanner to the points.
    pub(super) mean_direction: Vec3,
    /// Mean of their absolute coordinates: small along the axis about which the scanner turns.
    pub(super) mean_abs_direction: Vec3,
}

/// Statistics of the points if they are a sweep around a scanner at `eye`.
pub(super) fn sweep(sample: &CloudSample, eye: Vec3) -> Option<Around> {
    /// Ratio of the spacing of the far fifth of the points to that of the near fifth.
    const MIN_GROWTH: f32 = 2.5;
    const SECTORS: usize = 36;
    const MIN_SECTORS: usize = 22;
    let bounds = trim::bounds(sample);
    let margin = 0.02 * bounds.extent();
    let inside = eye.cmpge(bounds.min - margin) & eye.cmple(bounds.max + margin);
    if sample.positions.len() < 200 || inside.bitmask().count_ones() < 2 {
        return None;
    }
    let mut ranges: Vec<f32> = sample.positions.iter().map(|position| position.distance(eye)).collect();
    let by_range: Vec<f32> = ranges.clone();
    let near = quantile(&mut ranges, 0.2);
    let far = quantile(&mut ranges, 0.8);
    let spacing_where = |wanted: &dyn Fn(f32) -> bool| {
        let mut spacing: Vec<f32> = by_range
            .iter()
            .zip(&sample.spacing)
            .filter(|(range, _)| wanted(**range))
            .map(|(_, &spacing)| spacing)
            .collect();
        quantile(&mut spacing, 0.5)
    };
    let growth = spacing_where(&|range| range >= far) / spacing_where(&|range| range <= near);
    // Points at the centre of the scanner have no direction.
    let directions = sample
        .positions
        .iter()
        .filter_map(|&position| (position - eye).try_normalize());
    let (mut sum, mut abs_sum, mut count) = (Vec3::ZERO, Vec3::ZERO, 0.0f32);
    for direction in directions.clone() {
        sum += direction;
        abs_sum += direction.abs();
        count += 1.0;
    }
    let around = Around {
        mean_direction: sum / count,
        mean_abs_direction: abs_sum / count,
    };
    let flat = around.flattest_axis();
    let mut sectors = [false; SECTORS];
    for direction in directions {
        let turned = [direction.yzx(), direction.zxy(), direction][flat];
        let turn = turned.y.atan2(turned.x) / std::f32::consts::TAU + 0.5;
        sectors[((turn * SECTORS as f32) as usize).min(SECTORS - 1)] = true;
    }
    let covered = sectors.iter().filter(|&&is_covered| is_covered).count();
    (growth >= MIN_GROWTH && covered >= MIN_SECTORS).then_some(around)
}

impl Around {
    /// The axis along which directions point least.
    pub(super) fn flattest_axis(&self) -> usize {
        let abs = self.mean_abs_direction.to_array();
        (0..3).min_by(|&a, &b| abs[a].total_cmp(&abs[b])).unwrap_or(2)
    }
}
