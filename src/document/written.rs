//! The fields of a session as they are written.
//!
//! How it works: each object is read field by field and then checked while the parser is at its end ([`checked`]), so
//! that every error has the line of the object that it is in.

use super::SessionError;
use super::model::{Compared, ComparedBy, ComparedLayout, Marker, Measured, MeasuredPoint, ShownTrails, SpreadTrails};
use super::paths::{as_text, joined};
use super::reading::Reading;
use crate::persist::Fields;
use crate::scene::{Camera, CameraPath, Clip, ClipShape, FollowedPoint, Label, MeasurementKind, UpAxis};
use crate::timeline::PlayRange;
use glam::DVec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// The version that is written. It changes where the same word would mean something else; further fields need no other
/// version.
pub(super) const VERSION: u64 = 1;

/// Places are within this, scene units.
const FARTHEST: f64 = 1e15;

/// Version marker that distinguishes a session from other JSON, and one version from another.
#[derive(Debug, Deserialize)]
pub(super) struct Version {
    pub(super) pointreel_session: u64,
}

/// All of it; the settings are parsed one by one later.
#[derive(Debug, Deserialize)]
pub(super) struct Written {
    #[serde(rename = "pointreel_session")]
    _version: u64,
    pub(super) files: Vec<String>,
    #[serde(default)]
    pub(super) reading: Reading,
    #[serde(default, deserialize_with = "up")]
    pub(super) up: Option<UpAxis>,
    #[serde(default)]
    pub(super) frame: usize,
    #[serde(default, deserialize_with = "view")]
    pub(super) view: Option<Camera>,
    #[serde(default)]
    pub(super) settings: Fields,
    #[serde(default)]
    pub(super) clip: Option<WrittenClip>,
    #[serde(default, deserialize_with = "range")]
    pub(super) range: PlayRange,
    #[serde(default)]
    pub(super) markers: Vec<Marker>,
    #[serde(default)]
    pub(super) measurements: Vec<WrittenMeasured>,
    #[serde(default)]
    pub(super) labels: Vec<WrittenLabel>,
    #[serde(default)]
    pub(super) trails: WrittenTrails,
    #[serde(default)]
    pub(super) camera_path: Option<CameraPath>,
    #[serde(default)]
    pub(super) compare: Option<WrittenCompared>,
    #[serde(default)]
    pub(super) notes: String,
    #[serde(flatten)]
    pub(super) unknown: Fields,
}

/// Sequence that is compared with the session's.
#[derive(Debug, Clone)]
pub(super) struct WrittenCompared(CompareFields);

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CompareFields {
    files: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    topic: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    by: Option<ComparedBy>,
    #[serde(default)]
    offset: i64,
    #[serde(default)]
    layout: ComparedLayout,
    #[serde(default = "center")]
    line: f64,
}

fn center() -> f64 {
    0.5
}

impl<'de> Deserialize<'de> for WrittenCompared {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        checked(deserializer, |fields: CompareFields| {
            if fields.files.is_empty() {
                return Err("`compare` has no `files`: expected at least one, such as \"smooth\"".to_owned());
            }
            if !(0.0..=1.0).contains(&fields.line) {
                return Err(format!(
                    "the `line` of `compare` is at {}: expected 0 to 1",
                    fields.line
                ));
            }
            Ok(Self(fields))
        })
    }
}

impl WrittenCompared {
    /// Resolves the compared sequence of a session in `folder`.
    pub(super) fn read_in(self, folder: &Path) -> Compared {
        let Self(fields) = self;
        Compared {
            inputs: fields.files.iter().map(|text| joined(folder, text)).collect(),
            topic: fields.topic,
            by: fields.by,
            offset_frames: fields.offset,
            layout: fields.layout,
            line: fields.line,
        }
    }
}

/// As a session in `folder` holds it.
pub(super) fn compare_fields(compared: &Compared, folder: Option<&Path>) -> Result<CompareFields, SessionError> {
    let files = compared.inputs.iter().map(|input| as_text(input, folder));
    Ok(CompareFields {
        files: files.collect::<Result<_, _>>()?,
        topic: compared.topic.clone(),
        by: compared.by,
        offset: compared.offset_frames,
        layout: compared.layout,
        line: compared.line,
    })
}

fn view<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Camera>, D::Error> {
    let text = Option::<String>::deserialize(deserializer)?;
    text.map(|text| text.parse().map_err(Error::custom)).transpose()
}

fn up<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<UpAxis>, D::Error> {
    let text = Option::<String>::deserialize(deserializer)?;
    text.map(|text| text.parse().map_err(Error::custom)).transpose()
}

fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PlayRange, D::Error> {
    let range = PlayRange::deserialize(deserializer)?;
    let is_sound = range.is_sound();
    let told = || Error::custom("the first frame of the range is after the last one");
    is_sound.then_some(range).ok_or_else(told)
}

/// Deserialises an object of fields `F` that `make` converts, or fails with the reason.
fn checked<'de, D, F, T>(deserializer: D, make: fn(F) -> Result<T, String>) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    F: Deserialize<'de>,
{
    struct Checks<F, T>(fn(F) -> Result<T, String>, PhantomData<F>);

    impl<'de, F: Deserialize<'de>, T> Visitor<'de> for Checks<F, T> {
        type Value = T;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object in braces")
        }

        fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<T, M::Error> {
            let fields = F::deserialize(MapAccessDeserializer::new(map))?;
            self.0(fields).map_err(Error::custom)
        }
    }

    deserializer.deserialize_map(Checks(make, PhantomData))
}

/// A place in the coordinates of the file.
fn place_of(at: [f64; 3]) -> Result<DVec3, String> {
    let place = DVec3::from_array(at);
    let is_near = place.abs().max_element() <= FARTHEST;
    is_near
        .then_some(place)
        .ok_or_else(|| format!("a place is at {at:?}: expected numbers within ±{FARTHEST:e}"))
}

/// A box or a plane.
#[derive(Debug, Clone)]
pub(super) struct WrittenClip(pub(super) Clip);

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClipFields {
    on: bool,
    /// True if the points outside the shape are drawn.
    #[serde(default)]
    outside: bool,
    /// The smallest and the largest corner.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    corners: Option<[[f64; 3]; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneFields>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneFields {
    normal: [f64; 3],
    offset: f64,
}

impl<'de> Deserialize<'de> for WrittenClip {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        checked(deserializer, |fields: ClipFields| {
            let shape = match (fields.corners, fields.plane) {
                (Some([min, max]), None) => ClipShape::Box {
                    min: place_of(min)?,
                    max: place_of(max)?,
                },
                (None, Some(PlaneFields { normal, offset })) => {
                    let normal = place_of(normal)?;
                    if normal == DVec3::ZERO {
                        return Err("the normal of a plane has no length".to_owned());
                    }
                    ClipShape::Plane { normal, offset }
                }
                _ => return Err("a clip has either a `box` or a `plane`".to_owned()),
            };
            Ok(Self(Clip {
                is_on: fields.on,
                shape,
                keeps_outside: fields.outside,
            }))
        })
    }
}

/// A clip as it is written.
pub(super) fn clip_fields(clip: &Clip) -> impl Serialize + use<> {
    let (corners, plane) = match clip.shape {
        ClipShape::Box { min, max } => (Some([min, max].map(|corner| corner.to_array())), None),
        ClipShape::Plane { normal, offset } => {
            let normal = normal.to_array();
            (None, Some(PlaneFields { normal, offset }))
        }
    };
    ClipFields {
        on: clip.is_on,
        outside: clip.keeps_outside,
        corners,
        plane,
    }
}

/// A point, a place, or both.
#[derive(Debug, Serialize, Deserialize)]
struct PointFields {
    /// Index of a frame.
    #[serde(default)]
    frame: usize,
    /// Index in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    point: Option<u32>,
    /// Point count of the files in which the index denotes this point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    of: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 3]>,
    /// Unknown fields, written by another version of the program.
    #[serde(flatten)]
    unknown: Fields,
}

impl PointFields {
    fn new(frame: usize, point: Option<FollowedPoint>, place: Option<DVec3>) -> Self {
        Self {
            frame,
            point: point.map(|point| point.index_in_file),
            of: point.and_then(|point| point.points_in_file),
            at: place.map(|place| place.to_array()),
            unknown: Fields::new(),
        }
    }

    fn point(&self) -> Result<Option<FollowedPoint>, String> {
        match (self.point, self.of) {
            (Some(index), Some(points)) if index as usize >= points => Err(format!(
                "point {index} of {points}: expected an index below that, counted from 0"
            )),
            (None, Some(_)) => {
                Err("`of` says how many points there are, and `point` which one: it is missing".to_owned())
            }
            (index, points_in_file) => Ok(index.map(|index_in_file| FollowedPoint {
                index_in_file,
                points_in_file,
            })),
        }
    }
}

impl PointFields {
    /// A point that is followed, and where it was last.
    fn followed(&self) -> Result<Option<MeasuredPoint>, String> {
        let followed = self.point()?.filter(|followed| followed.points_in_file.is_some());
        let Some((point, at)) = followed.zip(self.at) else {
            return Ok(None);
        };
        let (frame, place) = (self.frame, place_of(at)?);
        Ok(Some(MeasuredPoint { frame, point, place }))
    }
}

/// A measurement, and the names of fields that are not known.
#[derive(Debug, Clone)]
pub(super) struct WrittenMeasured(pub(super) Measured, pub(super) Vec<String>);

#[derive(Debug, Serialize, Deserialize)]
struct MeasuredFields {
    #[serde(rename = "gauge")]
    kind: MeasurementKind,
    points: Vec<PointFields>,
    #[serde(flatten)]
    unknown: Fields,
}

impl<'de> Deserialize<'de> for WrittenMeasured {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        checked(deserializer, |fields: MeasuredFields| {
            let (kind, count) = (fields.kind, fields.points.len());
            if count != kind.point_count() {
                let (name, takes) = (kind.name(), kind.point_count());
                return Err(format!("{count} points: the gauge {name} takes {takes}"));
            }
            let mut unknown: Vec<String> = fields.unknown.keys().cloned().collect();
            let mut points = Vec::with_capacity(count);
            for point in &fields.points {
                unknown.extend(point.unknown.keys().cloned());
                let Some(point) = point.followed()? else {
                    return Err("a point of a measurement has a `point`, `of` how many, and a place (`at`)".to_owned());
                };
                points.push(point);
            }
            Ok(Self(Measured { kind, points }, unknown))
        })
    }
}

/// A measurement as it is written.
pub(super) fn measured_fields(measured: &Measured) -> impl Serialize + use<> {
    let points = measured.points.iter();
    MeasuredFields {
        kind: measured.kind,
        points: points
            .map(|point| PointFields::new(point.frame, Some(point.point), Some(point.place)))
            .collect(),
        unknown: Fields::new(),
    }
}

/// A label, and the names of fields that are not known.
#[derive(Debug, Clone)]
pub(super) struct WrittenLabel(pub(super) Label, pub(super) Vec<String>);

#[derive(Debug, Serialize, Deserialize)]
struct LabelFields {
    text: String,
    /// The first and the last frame that show it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    to: Option<usize>,
    #[serde(flatten)]
    point: PointFields,
}

impl<'de> Deserialize<'de> for WrittenLabel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        checked(deserializer, |fields: LabelFields| {
            let (point, at) = (fields.point.point()?, fields.point.at);
            if point.is_none() && at.is_none() {
                return Err("a label has a `point`, a place (`at`), or both".to_owned());
            }
            let mut frames = PlayRange::default();
            match (fields.from, fields.to) {
                (Some(from), Some(to)) if from > to => {
                    return Err(format!(
                        "a label is shown from frame {from} to frame {to}, counted from 0"
                    ));
                }
                (from, to) => {
                    frames = from.map_or(frames, |from| frames.beginning_at(from));
                    frames = to.map_or(frames, |to| frames.ending_at(to));
                }
            }
            let label = Label {
                text: Label::as_text(&fields.text),
                frame: fields.point.frame,
                point,
                place: at.map(place_of).transpose()?,
                frames,
            };
            Ok(Self(label, fields.point.unknown.keys().cloned().collect()))
        })
    }
}

/// A label as it is written.
pub(super) fn label_fields(label: &Label) -> impl Serialize + use<> {
    LabelFields {
        text: label.text.clone(),
        from: label.frames.first(),
        to: label.frames.last(),
        point: PointFields::new(label.frame, label.point, label.place),
    }
}

/// Trails that are shown.
#[derive(Debug, Clone, Default)]
pub(super) struct WrittenTrails(pub(super) ShownTrails);

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrailFields {
    #[serde(default)]
    picked: bool,
    #[serde(rename = "kept", default, skip_serializing_if = "Vec::is_empty")]
    pinned: Vec<PointFields>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spread: Option<SpreadTrails>,
}

impl<'de> Deserialize<'de> for WrittenTrails {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        checked(deserializer, |fields: TrailFields| {
            let pinned = fields.pinned.iter().map(|point| {
                let told = || "a point of `trails` has a `point`, `of` how many, and a place (`at`)".to_owned();
                point.followed()?.ok_or_else(told)
            });
            Ok(Self(ShownTrails {
                of_picked: fields.picked,
                pinned: pinned.collect::<Result<_, String>>()?,
                spread: fields.spread,
            }))
        })
    }
}

/// Trails as they are written; `None` if there are none.
pub(super) fn trail_fields(trails: &ShownTrails) -> Option<impl Serialize + use<>> {
    let pinned = trails.pinned.iter();
    (*trails != ShownTrails::default()).then(|| TrailFields {
        picked: trails.of_picked,
        pinned: pinned
            .map(|point| PointFields::new(point.frame, Some(point.point), Some(point.place)))
            .collect(),
        spread: trails.spread,
    })
}
