//! Paths as JSON files that a person can read and write.

use super::{CameraPath, Keyframe, PathError};
use crate::scene::{Camera, PicturePlane, Projection, UpAxis};
use glam::{DVec2, DVec3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// The version that is written, and the only one there is.
const VERSION: u32 = 1;

/// The maximum number of keyframes, with all digits, takes less.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Reasons why there is no path in a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PathFileError {
    /// The file cannot be read or written.
    #[error("{}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// Larger than any path.
    #[error("{} is not a camera path: it has more than 64 MiB", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// It does not have the form of a path; the reason names line and column.
    #[error("{} is not a camera path: {reason}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Parse error and its position.
        reason: serde_json::Error,
    },
    /// A version that is not known.
    #[error("{} is a camera path of version {version}: this program knows version {VERSION}", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: u32,
    },
    /// The keyframes are not a path.
    #[error("{}: {reason}", path.display())]
    Keyframes {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: PathError,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(rename = "pointreel_path")]
    version: u32,
    #[serde(default)]
    ease: bool,
    #[serde(deserialize_with = "up_axis")]
    up: UpAxis,
    #[serde(default = "perspective")]
    projection: Projection,
    keyframes: Vec<WrittenKeyframe>,
}

/// Header that distinguishes a path from other JSON, and one version from another.
#[derive(Debug, Deserialize)]
struct Version {
    pointreel_path: u32,
}

/// Returns the default projection of paths that specify none.
fn perspective() -> Projection {
    Projection::Perspective
}

fn up_axis<'de, D: Deserializer<'de>>(deserializer: D) -> Result<UpAxis, D::Error> {
    let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
    text.parse().map_err(serde::de::Error::custom)
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenKeyframe {
    time_s: f64,
    frame: f64,
    target: [f64; 3],
    distance: f64,
    azimuth_deg: f64,
    elevation_deg: f64,
    fov_deg: f64,
    /// The picture plane of a sensor; others omit it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plane: Option<WrittenPlane>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenPlane {
    roll_deg: f64,
    shift: [f64; 2],
    pixel_aspect: f64,
}

impl WrittenPlane {
    fn of(plane: PicturePlane) -> Option<Self> {
        (plane != PicturePlane::CENTERED).then(|| Self {
            roll_deg: plane.roll_deg,
            shift: plane.shift.to_array(),
            pixel_aspect: plane.pixel_aspect,
        })
    }

    fn plane(self) -> PicturePlane {
        PicturePlane {
            roll_deg: self.roll_deg,
            shift: DVec2::from_array(self.shift),
            pixel_aspect: self.pixel_aspect,
        }
    }
}

impl CameraPath {
    /// Reads a path from a JSON file.
    ///
    /// # Errors
    /// Description of the fault in the file, with line and column, or with the keyframe.
    pub fn read(path: &Path) -> Result<Self, PathFileError> {
        let io = |reason| PathFileError::Io {
            path: path.to_owned(),
            reason,
        };
        let mut text = Vec::new();
        crate::regular_file::open(path)
            .and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut text))
            .map_err(io)?;
        if text.len() as u64 > MAX_FILE_BYTES {
            let path = path.to_owned();
            return Err(PathFileError::TooLarge { path });
        }
        Self::of_json(&text, path)
    }

    /// Reads a path from JSON; errors name `path` as its file.
    pub(super) fn of_json(text: &[u8], path: &Path) -> Result<Self, PathFileError> {
        let path = || path.to_owned();
        let json = |reason| PathFileError::Json { path: path(), reason };
        let Version {
            pointreel_path: version,
        } = serde_json::from_slice(text).map_err(json)?;
        if version != VERSION {
            return Err(PathFileError::Version { path: path(), version });
        }
        let written: Written = serde_json::from_slice(text).map_err(json)?;
        Self::of_written(written).map_err(|reason| PathFileError::Keyframes { path: path(), reason })
    }

    fn of_written(written: Written) -> Result<Self, PathError> {
        let keyframes = written.keyframes.into_iter().map(|key| Keyframe {
            time_s: key.time_s,
            frame: key.frame,
            camera: Camera {
                target_in_world: DVec3::from_array(key.target),
                distance: key.distance,
                azimuth_deg: key.azimuth_deg,
                elevation_deg: key.elevation_deg,
                fov_deg: key.fov_deg,
                up: written.up,
                projection: written.projection,
                plane: key.plane.map_or(PicturePlane::CENTERED, WrittenPlane::plane),
            },
        });
        Self::new(keyframes.collect(), written.ease)
    }

    /// Writes the path to a JSON file, which is replaced as a whole.
    ///
    /// # Errors
    /// The system's, if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), PathFileError> {
        crate::persist::write_whole(path, self.to_json().as_bytes()).map_err(|reason| PathFileError::Io {
            path: path.to_owned(),
            reason,
        })
    }

    /// The path as JSON, a keyframe a line.
    pub fn to_json(&self) -> String {
        let Camera { up, projection, .. } = self.keyframes[0].camera;
        let up = up.name();
        let lines: Vec<String> = self.keyframes.iter().map(line).collect();
        format!(
            "{{\n  \"pointreel_path\": {VERSION},\n  \"ease\": {},\n  \"up\": \"{up}\",\n  \"projection\": \
             \"{projection}\",\n  \"keyframes\": [\n    {}\n  ]\n}}\n",
            self.eases,
            lines.join(",\n    ")
        )
    }
}

/// A path within another file: the object that a file of its own holds.
impl<'de> Deserialize<'de> for CameraPath {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = Written::deserialize(deserializer)?;
        if written.version != VERSION {
            let version = written.version;
            let text = format!("a camera path of version {version}: this program knows version {VERSION}");
            return Err(D::Error::custom(text));
        }
        Self::of_written(written).map_err(D::Error::custom)
    }
}

impl Serialize for CameraPath {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Camera { up, projection, .. } = self.keyframes[0].camera;
        let written = WrittenPath {
            pointreel_path: VERSION,
            ease: self.eases,
            up: up.name(),
            projection,
            keyframes: self.keyframes.iter().map(written_keyframe).collect(),
        };
        written.serialize(serializer)
    }
}

#[derive(Serialize)]
struct WrittenPath {
    pointreel_path: u32,
    ease: bool,
    up: &'static str,
    projection: Projection,
    keyframes: Vec<WrittenKeyframe>,
}

fn line(key: &Keyframe) -> String {
    // Numbers only: this cannot fail.
    serde_json::to_string(&written_keyframe(key)).unwrap_or_default()
}

fn written_keyframe(key: &Keyframe) -> WrittenKeyframe {
    let camera = &key.camera;
    WrittenKeyframe {
        time_s: key.time_s,
        frame: key.frame,
        target: camera.target_in_world.to_array(),
        distance: camera.distance,
        azimuth_deg: camera.azimuth_deg,
        elevation_deg: camera.elevation_deg,
        fov_deg: camera.fov_deg,
        plane: WrittenPlane::of(camera.plane),
    }
}
