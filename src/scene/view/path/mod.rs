//! Camera path × time path: where the camera is, and which frame is shown, at any time of a video.
//!
//! **How it works.** A path is a list of keyframes. Between them the camera moves along curves without corners
//! (`curve.rs`) through its target (f64), the logarithm of its distance, its azimuth the short way round, its
//! elevation, the logarithm of its field of view, so that zooming looks even, and the position of its image on its
//! axis. The place in the sequence moves linearly: a frame that two neighbouring keyframes have is held, few frames
//! over a long time are slow motion, and frames that fall play backwards, exactly as they were written.

mod curve;
mod file;
#[cfg(test)]
mod tests;

pub use file::PathFileError;

use crate::scene::{Camera, PicturePlane};
use curve::Curve;
use glam::{DVec2, DVec3};

/// The camera and the place in the sequence at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// Seconds from the beginning of the video.
    pub time_s: f64,
    /// Camera at that time.
    pub camera: Camera,
    /// The frame that is shown then; between frames the nearest one is.
    pub frame: f64,
}

/// Reasons why keyframes are not a path. Keyframes are counted from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// There are none.
    #[error("a path has at least one keyframe")]
    Empty,
    /// There are too many.
    #[error("{count} keyframes: a path has at most {}", CameraPath::MAX_KEYFRAMES)]
    TooMany {
        /// Number of them.
        count: usize,
    },
    /// A number that cannot be.
    #[error("keyframe {number}: {field} is {value}: expected {expected}")]
    OutOfRange {
        /// Number of the keyframe.
        number: usize,
        /// Name of its invalid field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Permitted values.
        expected: &'static str,
    },
    /// Not after the keyframe before it.
    #[error(
        "keyframe {number} is at {time_s} s and the one before it at {before_s} s: expected times that ascend by a \
         microsecond at least"
    )]
    NotAscending {
        /// Number of the keyframe.
        number: usize,
        /// Its time.
        time_s: f64,
        /// The time before.
        before_s: f64,
    },
    /// The projection changes.
    #[error("keyframe {number} is seen in another projection than the first one: expected one for the whole path")]
    Projection {
        /// Number of the keyframe, counted from 1.
        number: usize,
    },
    /// The up axis changes.
    #[error("keyframe {number} has the up axis {axis}, the first one {first}: expected one for the whole path")]
    OtherUpAxis {
        /// Number of the keyframe.
        number: usize,
        /// Its axis.
        axis: &'static str,
        /// The axis of the first.
        first: &'static str,
    },
}

/// Keyframes at ascending times, and the curves through them.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPath {
    keyframes: Vec<Keyframe>,
    eases: bool,
    /// Target x, y, z, logarithm of the distance, azimuth without jumps, elevation, logarithm of the field of view,
    /// roll without jumps, shift x and y, logarithm of the aspect of pixels.
    curves: [Curve; 11],
}

/// Keyframes are at least so far apart.
const MIN_STEP_S: f64 = 1e-6;

impl CameraPath {
    /// Maximum number of keyframes of a path.
    pub const MAX_KEYFRAMES: usize = 100_000;

    /// A path through `keyframes`; `eases` lets the camera start and end at rest; frames play as they are written.
    ///
    /// # Errors
    /// The fault and its keyframe: numbers out of range, times that do not ascend, another up axis.
    pub fn new(keyframes: Vec<Keyframe>, eases: bool) -> Result<Self, PathError> {
        check(&keyframes)?;
        let times: Vec<f64> = keyframes.iter().map(|key| key.time_s).collect();
        let curve = |value: fn(&Camera) -> f64| {
            let values = keyframes.iter().map(|key| value(&key.camera)).collect();
            Curve::through(&times, values, eases)
        };
        let curves = [
            curve(|camera| camera.target_in_world.x),
            curve(|camera| camera.target_in_world.y),
            curve(|camera| camera.target_in_world.z),
            curve(|camera| camera.distance.ln()),
            Curve::through(&times, unwrapped(&keyframes, |camera| camera.azimuth_deg), eases),
            curve(|camera| camera.elevation_deg),
            curve(|camera| camera.fov_deg.ln()),
            Curve::through(&times, unwrapped(&keyframes, |camera| camera.plane.roll_deg), eases),
            curve(|camera| camera.plane.shift.x),
            curve(|camera| camera.plane.shift.y),
            curve(|camera| camera.plane.pixel_aspect.ln()),
        ];
        Ok(Self {
            keyframes,
            eases,
            curves,
        })
    }

    /// A turntable: `turns` times about the up axis in this many images, at one speed, as a loop: the image after the
    /// last one would be the first. The sequence is at frame `first_frame` in the first image and goes on by
    /// `frames_per_picture`.
    ///
    /// # Errors
    /// As [`CameraPath::new`]; of more than 25,000 turns.
    pub fn turntable(
        camera: Camera,
        turns: f64,
        [picture_count, pictures_per_second]: [f64; 2],
        [first_frame, frames_per_picture]: [f64; 2],
    ) -> Result<Self, PathError> {
        let steps = (picture_count - 1.0).max(0.0);
        let turned_deg = 360.0 * turns * steps / picture_count.max(1.0);
        // At most a quarter of a turn between keyframes, so that the shortest way round is unique.
        let count = if steps > 0.0 {
            (turned_deg.abs() / 90.0).ceil().max(1.0)
        } else {
            0.0
        };
        if count >= Self::MAX_KEYFRAMES as f64 {
            let count = count as usize;
            return Err(PathError::TooMany { count });
        }
        let keyframes = (0..=count as usize).map(|index| {
            let share = if count > 0.0 { index as f64 / count } else { 0.0 };
            Keyframe {
                time_s: share * steps / pictures_per_second,
                camera: Camera {
                    azimuth_deg: wrapped(camera.azimuth_deg + turned_deg * share),
                    ..camera
                },
                frame: first_frame + frames_per_picture * steps * share,
            }
        });
        Self::new(keyframes.collect(), false)
    }

    /// The keyframes; times ascend.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// Returns true if the path eases in and out: the camera starts and ends at rest.
    pub fn eases(&self) -> bool {
        self.eases
    }

    /// Seconds from the first to the last keyframe.
    pub fn duration_s(&self) -> f64 {
        let time = |key: Option<&Keyframe>| key.map_or(0.0, |key| key.time_s);
        time(self.keyframes.last()) - time(self.keyframes.first())
    }

    /// Returns the number of images that show all of the path at this rate, both ends included.
    pub fn picture_count(&self, pictures_per_second: f64) -> usize {
        (self.duration_s() * pictures_per_second).round() as usize + 1
    }

    /// The camera and the frame some seconds after the first keyframe; before it and after the last one, the ends.
    pub fn at(&self, seconds: f64) -> (Camera, usize) {
        let keys = &self.keyframes;
        let time_s = keys[0].time_s + seconds;
        let index = keys.partition_point(|key| key.time_s <= time_s).max(1) - 1;
        let (key, next) = (&keys[index], keys.get(index + 1));
        let span = next.map_or(1.0, |next| next.time_s - key.time_s);
        let share = ((time_s - key.time_s) / span).clamp(0.0, 1.0);
        let frame = next.map_or(key.frame, |next| key.frame * (1.0 - share) + next.frame * share);
        let value = |curve: usize| self.curves[curve].at(index, share, span);
        let camera = Camera {
            target_in_world: DVec3::new(value(0), value(1), value(2)),
            distance: value(3).exp(),
            azimuth_deg: wrapped(value(4)),
            elevation_deg: value(5),
            fov_deg: value(6).exp(),
            plane: PicturePlane {
                roll_deg: wrapped(value(7)),
                shift: DVec2::new(value(8), value(9)),
                pixel_aspect: value(10).exp(),
            },
            ..key.camera
        };
        (camera, frame.round() as usize)
    }
}

/// An angle from -180 to 180 degrees.
fn wrapped(deg: f64) -> f64 {
    deg - 360.0 * (deg / 360.0).round()
}

/// Angles that each continue from the one before the short way round.
fn unwrapped(keyframes: &[Keyframe], angle_deg: fn(&Camera) -> f64) -> Vec<f64> {
    let mut last = angle_deg(&keyframes[0].camera);
    let angle = |key: &Keyframe| {
        let step = angle_deg(&key.camera) - last;
        // Up to half a turn follows the written direction.
        let is_short = step.abs() <= 180.0;
        last += if is_short { step } else { wrapped(step) };
        last
    };
    keyframes.iter().map(angle).collect()
}

fn check(keyframes: &[Keyframe]) -> Result<(), PathError> {
    let first = keyframes.first().ok_or(PathError::Empty)?;
    let count = keyframes.len();
    if count > CameraPath::MAX_KEYFRAMES {
        return Err(PathError::TooMany { count });
    }
    let mut before: Option<f64> = None;
    for (number, key) in (1..).zip(keyframes) {
        let Keyframe { time_s, camera, frame } = *key;
        let [x, y, z] = camera.target_in_world.to_array();
        let place = (-1e15..=1e15, "a number within ±1e15");
        let turns = (-1e6..=1e6, "degrees within ±1e6");
        let shift = (-10.0..=10.0, "heights of the picture within ±10");
        for (field, value, (range, expected)) in [
            ("time_s", time_s, (0.0..=1e6, "seconds from 0 to 1e6")),
            ("frame", frame, (0.0..=1e9, "a frame from 0 to 1e9")),
            ("target x", x, place.clone()),
            ("target y", y, place.clone()),
            ("target z", z, place),
            ("distance", camera.distance, (1e-100..=1e100, "a length above 0")),
            ("azimuth_deg", camera.azimuth_deg, turns.clone()),
            (
                "elevation_deg",
                camera.elevation_deg,
                (-90.0..=90.0, "degrees from -90 to 90"),
            ),
            ("fov_deg", camera.fov_deg, (0.001..=179.0, "degrees from 0.001 to 179")),
            ("roll_deg", camera.plane.roll_deg, turns),
            ("shift x", camera.plane.shift.x, shift.clone()),
            ("shift y", camera.plane.shift.y, shift),
            (
                "pixel_aspect",
                camera.plane.pixel_aspect,
                (0.01..=100.0, "a number from 0.01 to 100"),
            ),
        ] {
            if !range.contains(&value) {
                return Err(PathError::OutOfRange {
                    number,
                    field,
                    value,
                    expected,
                });
            }
        }
        if let Some(before_s) = before.filter(|before_s| time_s - before_s < MIN_STEP_S) {
            return Err(PathError::NotAscending {
                number,
                time_s,
                before_s,
            });
        }
        if camera.projection != first.camera.projection {
            return Err(PathError::Projection { number });
        }
        if camera.up != first.camera.up {
            return Err(PathError::OtherUpAxis {
                number,
                axis: camera.up.name(),
                first: first.camera.up.name(),
            });
        }
        before = Some(time_s);
    }
    Ok(())
}
