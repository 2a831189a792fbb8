//! Open options of the files of a session: the user's choices of [`OpenOptions`], under the names of the options of the
//! command line.

use super::SessionError;
use super::paths::{as_text, joined};
use crate::cloud::{ColorDepth, NoData};
use crate::io::{ColumnMap, ReadOptions};
use crate::rgbd::Filters;
use crate::source::{NO_POSES, OpenOptions, RgbdOptions};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// Reading options; `None` or false is the default.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reading {
    /// Topic of a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// Pattern of the names of files that are frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<String>,
    /// Frame rate in frames per second.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "positive")]
    pub fps: Option<f64>,
    /// The scans of an E57 file are one frame.
    #[serde(skip_serializing_if = "is_false")]
    pub merge_scans: bool,
    /// Points sampled from the faces of a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample: Option<NonZeroUsize>,
    /// Columns of text and of files without a header: their number, or their meanings.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "write_columns",
        deserialize_with = "columns"
    )]
    pub columns: Option<ColumnMap>,
    /// Values of a missing point.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "write_word",
        deserialize_with = "word"
    )]
    pub no_data: Option<NoData>,
    /// The least range of colours whose type does not say it.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "write_word",
        deserialize_with = "word"
    )]
    pub color_depth: Option<ColorDepth>,
    /// True if a dense point cloud is reconstructed from the input images by stereo.
    #[serde(skip_serializing_if = "is_false")]
    pub dense: bool,
    /// Filters of depth images.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "write_word",
        deserialize_with = "word"
    )]
    pub rgbd_filters: Option<Filters>,
    /// Pattern of the names of depth images.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_images: Option<String>,
    /// Pattern of the names of colour images.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_images: Option<String>,
    /// `fx,fy,cx,cy`, or a file with them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<String>,
    /// Units of the depth images that are a metre.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "positive")]
    pub depth_scale: Option<f64>,
    /// A file with the poses of the camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poses: Option<PathBuf>,
    /// Poses lead from the world to the camera.
    #[serde(skip_serializing_if = "is_false")]
    pub invert_poses: bool,
    /// Frames, both ends included, that become one cloud.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merge_frames: Option<(usize, usize)>,
    /// Edge of the cells in which their points are joined, metres; 0 keeps all points.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "not_negative")]
    pub merge_cells_m: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_false(value: &bool) -> bool {
    !value
}

fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = Option::<f64>::deserialize(deserializer)?;
    match value {
        Some(number) if !(number > 0.0 && number.is_finite()) => {
            Err(serde::de::Error::custom(format!("{number} is not above 0")))
        }
        value => Ok(value),
    }
}

fn not_negative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = Option::<f64>::deserialize(deserializer)?;
    match value {
        Some(number) if !(number >= 0.0 && number.is_finite()) => {
            Err(serde::de::Error::custom(format!("{number} is not 0 or more")))
        }
        value => Ok(value),
    }
}

/// Their number as such, as sessions have always had it, other text as it is.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Columns {
    Number(usize),
    Text(String),
}

#[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn write_columns<S: Serializer>(columns: &Option<ColumnMap>, serializer: S) -> Result<S::Ok, S::Error> {
    let written = |columns: &ColumnMap| {
        let text = columns.to_string();
        text.parse().map_or(Columns::Text(text), Columns::Number)
    };
    columns.as_ref().map(written).serialize(serializer)
}

fn columns<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<ColumnMap>, D::Error> {
    let text = Option::<Columns>::deserialize(deserializer)?.map(|columns| match columns {
        Columns::Number(number) => number.to_string(),
        Columns::Text(text) => text,
    });
    text.map(|text| text.parse().map_err(serde::de::Error::custom))
        .transpose()
}

#[expect(clippy::ref_option, reason = "serde calls it so")]
fn write_word<T: ToString, S: Serializer>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error> {
    value.as_ref().map(T::to_string).serialize(serializer)
}

fn word<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(deserializer: D) -> Result<Option<T>, D::Error> {
    let text = Option::<String>::deserialize(deserializer)?;
    text.map(|text| text.parse().map_err(serde::de::Error::custom))
        .transpose()
}

impl Reading {
    /// Returns the reading options that were chosen in `options`.
    pub fn of(options: &OpenOptions) -> Self {
        let (read, rgbd) = (&options.read, &options.rgbd);
        Self {
            topic: options.topic.as_deref().map(str::to_owned),
            only: options.only.as_deref().map(str::to_owned),
            fps: options.fps,
            merge_scans: options.merge_scans,
            sample: read.sample_count,
            columns: read.columns,
            no_data: (options.no_data != NoData::Auto).then_some(options.no_data),
            color_depth: options.color_depth,
            dense: options.dense,
            rgbd_filters: (rgbd.filters != Filters::USUAL).then_some(rgbd.filters),
            depth_images: rgbd.depth.clone(),
            color_images: rgbd.color.clone(),
            intrinsics: rgbd.intrinsics.clone(),
            depth_scale: rgbd.depth_scale,
            poses: rgbd.poses.clone(),
            invert_poses: rgbd.invert_poses,
            merge_frames: rgbd.merge,
            merge_cells_m: rgbd.merge_edge_m,
        }
    }

    /// `options` with these choices, where `options` has none.
    #[must_use]
    pub fn over(&self, options: &OpenOptions) -> OpenOptions {
        let read: ReadOptions = options.read;
        let given = &options.rgbd;
        OpenOptions {
            read: read
                .with_sample_count(read.sample_count.or(self.sample))
                .with_columns(read.columns.or(self.columns)),
            no_data: match options.no_data {
                NoData::Auto => self.no_data.unwrap_or_default(),
                given => given,
            },
            color_depth: options.color_depth.or(self.color_depth),
            fps: options.fps.or(self.fps),
            merge_scans: options.merge_scans || self.merge_scans,
            topic: options.topic.clone().or_else(|| self.topic.as_deref().map(Arc::from)),
            only: options.only.clone().or_else(|| self.only.as_deref().map(Arc::from)),
            dense: options.dense || self.dense,
            rgbd: RgbdOptions {
                filters: self.rgbd_filters.unwrap_or(given.filters),
                filters_are_automatic: self.rgbd_filters.is_none() && given.filters_are_automatic,
                depth: given.depth.clone().or_else(|| self.depth_images.clone()),
                color: given.color.clone().or_else(|| self.color_images.clone()),
                intrinsics: given.intrinsics.clone().or_else(|| self.intrinsics.clone()),
                depth_scale: given.depth_scale.or(self.depth_scale),
                poses: given.poses.clone().or_else(|| self.poses.clone()),
                invert_poses: given.invert_poses || self.invert_poses,
                merge: given.merge.or(self.merge_frames),
                merge_edge_m: given.merge_edge_m.or(self.merge_cells_m),
                ..given.clone()
            },
            ..options.clone()
        }
    }

    /// The files that it names.
    pub(super) fn files(&self) -> impl Iterator<Item = PathBuf> {
        let poses = self.poses.clone().filter(|file| file != Path::new(NO_POSES));
        let intrinsics = self.intrinsics.as_deref().filter(|text| is_file_name(text));
        poses.into_iter().chain(intrinsics.map(PathBuf::from))
    }

    /// With the paths of its files as a session in `folder` holds them, or absolute without one.
    pub(super) fn written_in(&self, folder: Option<&Path>) -> Result<Self, SessionError> {
        let file_of_poses = self.poses.as_deref().filter(|file| *file != Path::new(NO_POSES));
        let poses = match file_of_poses {
            Some(file) => Some(as_text(file, folder)?),
            None => self.poses.as_ref().map(|_| NO_POSES.to_owned()),
        };
        let file_of_intrinsics = self.intrinsics.as_deref().filter(|text| is_file_name(text));
        let intrinsics = match file_of_intrinsics {
            Some(file) => Some(as_text(Path::new(file), folder)?),
            None => self.intrinsics.clone(),
        };
        Ok(Self {
            poses: poses.map(PathBuf::from),
            intrinsics,
            ..self.clone()
        })
    }

    /// The opposite of [`Reading::written_in`].
    pub(super) fn read_in(self, folder: &Path) -> Self {
        let intrinsics = self.intrinsics.map(|text| {
            if is_file_name(&text) {
                joined(folder, &text).to_string_lossy().into_owned()
            } else {
                text
            }
        });
        Self {
            poses: self.poses.map(|file| {
                if file == Path::new(NO_POSES) {
                    file
                } else {
                    joined(folder, &file.to_string_lossy())
                }
            }),
            intrinsics,
            ..self
        }
    }
}

/// Numbers are the intrinsics themselves.
fn is_file_name(text: &str) -> bool {
    !text.split(',').all(|number| number.trim().parse::<f64>().is_ok())
}
