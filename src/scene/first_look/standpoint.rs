//! From where a cloud is seen first.
//!
//! **How it works.** A sensor's scene is seen from the sensor's side. For anything else a few views are tried on a
//! coarse image of the sample: the fraction covered, and the fraction of that whose surface faces the view. The default
//! view, from the front a little to the right and above, is left only for one that shows clearly more.

use super::kind::CaptureKind;
use super::sample::CloudSample;
use crate::math::Aabb;
use crate::scene::{Camera, UpAxis};
use glam::{DVec3, Vec3};

/// A direction to look from, with the reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standpoint {
    /// Turn about the up axis, degrees.
    pub azimuth_deg: f64,
    /// Height above the horizon, degrees.
    pub elevation_deg: f64,
    /// For people.
    pub why: &'static str,
}

/// The usual view.
const USUAL: Standpoint = Standpoint {
    azimuth_deg: 30.0,
    elevation_deg: 15.0,
    why: "from the front, a little to the right and above",
};
/// From higher, so that wide, flat clouds cover some of the image.
const TERRAIN_ELEVATION_DEG: f64 = 35.0;
const SWEEP_ELEVATION_DEG: f64 = 30.0;
/// Azimuths of candidate views along the horizon, those closer to the front first.
const AZIMUTHS_DEG: [f64; 11] = [
    -30.0, 0.0, 60.0, -60.0, 90.0, -90.0, 120.0, -120.0, 150.0, -150.0, 180.0,
];
/// Another view is taken if it shows this many times as much.
const CLEARLY_MORE: f32 = 1.25;

/// Chooses the viewpoint of the first view. `eye` is the sensor position, if it is known or estimated from the points.
pub(super) fn standpoint(
    kind: CaptureKind,
    up: UpAxis,
    sample: &CloudSample,
    bounds: &Aabb,
    eye: Option<Vec3>,
) -> Standpoint {
    let seen_from = |why| {
        let toward = (eye? - bounds.center()).as_dvec3();
        let toward = toward.try_normalize()?;
        let (azimuth_deg, elevation_deg) = up.angles_of(toward);
        Some(Standpoint {
            azimuth_deg,
            elevation_deg,
            why,
        })
    };
    match kind {
        CaptureKind::Sweep => Standpoint {
            azimuth_deg: behind(up),
            elevation_deg: SWEEP_ELEVATION_DEG,
            why: "from behind and above the scanner, which looks along +X",
        },
        CaptureKind::CameraFrame => seen_from("from the side of the camera").unwrap_or(USUAL),
        CaptureKind::Object => seen_from("from the side of the sensor")
            .unwrap_or_else(|| max_surface(up, sample, bounds, USUAL.elevation_deg)),
        CaptureKind::Terrain => Standpoint {
            why: "from above",
            ..max_surface(up, sample, bounds, TERRAIN_ELEVATION_DEG)
        },
    }
}

/// The azimuth from which +X is ahead; the usual one if X is up.
fn behind(up: UpAxis) -> f64 {
    match up {
        UpAxis::X | UpAxis::NegX => USUAL.azimuth_deg,
        _ => up.angles_of(DVec3::NEG_X).0,
    }
}

fn max_surface(up: UpAxis, sample: &CloudSample, bounds: &Aabb, elevation_deg: f64) -> Standpoint {
    let usual = Standpoint { elevation_deg, ..USUAL };
    let shown = |azimuth_deg| {
        let mut camera = Camera::framing(bounds, DVec3::ZERO, up);
        (camera.azimuth_deg, camera.elevation_deg) = (azimuth_deg, elevation_deg);
        CoarsePicture::of(sample, bounds, &camera).facing_cells()
    };
    let enough = CLEARLY_MORE * shown(usual.azimuth_deg);
    let mut best = (enough, usual);
    for azimuth_deg in AZIMUTHS_DEG {
        let cells = shown(azimuth_deg);
        if cells > best.0 {
            let why = "from where most of its surface is seen";
            let found = Standpoint {
                azimuth_deg,
                why,
                ..usual
            };
            best = (cells, found);
        }
    }
    best.1
}

/// Cells along an edge of a coarse image: a few points of a sample are in each.
const CELLS: usize = 48;

/// The nearest point of a sample in each cell of a small image by parallel rays.
struct CoarsePicture {
    /// Facing ratio of the surface in each cell, −1 to 1; 1 without a normal. `None` for empty cells.
    cells: Vec<Option<f32>>,
}

impl CoarsePicture {
    fn of(sample: &CloudSample, bounds: &Aabb, camera: &Camera) -> Self {
        let rotation = camera.view_from_world_rotation().as_mat3();
        let scale = CELLS as f32 * 0.5 / bounds.radius().max(f32::MIN_POSITIVE);
        let mut nearest = vec![(f32::NEG_INFINITY, None); CELLS * CELLS];
        for (index, &position) in sample.positions.iter().enumerate() {
            let seen = rotation * (position - bounds.center()) * scale;
            let center = CELLS as f32 * 0.5;
            let [column, row] = [seen.x, seen.y].map(|at| (at + center).max(0.0) as usize);
            let cell = row.min(CELLS - 1) * CELLS + column.min(CELLS - 1);
            if seen.z > nearest[cell].0 {
                let facing = match sample.normals.get(index) {
                    Some(&normal) if normal != Vec3::ZERO => (rotation * normal).z,
                    _ => 1.0,
                };
                nearest[cell] = (seen.z, Some(facing));
            }
        }
        Self {
            cells: nearest.into_iter().map(|(_, facing)| facing).collect(),
        }
    }

    /// Cells whose surface faces the view.
    fn facing_cells(&self) -> f32 {
        let facing = self.cells.iter().flatten().filter(|facing| **facing > 0.0);
        facing.count() as f32
    }
}

/// Returns true if back-face culling would leave nothing missing from any side: each view shows front faces only. False
/// without normals.
pub(super) fn is_closed(sample: &CloudSample, bounds: &Aabb) -> bool {
    /// Points near an outline face away a little although their surface does not.
    const CLEARLY_AWAY: f32 = -0.3;
    const MAX_BACKS: f32 = 0.01;
    const ELEVATIONS_DEG: [f64; 5] = [-90.0, -40.0, 0.0, 40.0, 90.0];
    if sample.normals.len() < sample.positions.len()
        || sample.positions.is_empty()
        || sample.normals.contains(&Vec3::ZERO)
    {
        return false;
    }
    let (mut met, mut backs) = (0.0, 0.0);
    for elevation_deg in ELEVATIONS_DEG {
        for azimuth_deg in [0.0, 60.0, 120.0, 180.0, 240.0, 300.0] {
            let mut camera = Camera::framing(bounds, DVec3::ZERO, UpAxis::Y);
            (camera.azimuth_deg, camera.elevation_deg) = (azimuth_deg, elevation_deg);
            let picture = CoarsePicture::of(sample, bounds, &camera);
            for facing in picture.cells.iter().flatten() {
                met += 1.0;
                backs += f32::from(u8::from(*facing < CLEARLY_AWAY));
            }
        }
    }
    backs <= MAX_BACKS * met
}
