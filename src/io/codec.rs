//! Codec: the capabilities of a row of the table of formats.

use super::contents::{Contents, Entry, Part};
use super::error::{Fault, IoError};
use super::format::Format;
use super::write::Encoder;
use crate::cloud::RawCloud;
use crate::io::columns::fixed_rows::FixedRows;
use crate::io::options::ReadOptions;
use crate::io::recordings::recording;
use crate::io::recordings::recording::camera::CameraTopics;
use crate::progress::Progress;
use std::path::Path;

/// A file to decode.
pub(super) struct Encoded<'a> {
    pub(super) format: Format,
    /// File name, used in messages and to find companion files.
    pub(super) name: &'a Path,
    /// All of it, at least a byte.
    pub(super) bytes: &'a [u8],
    /// Requested part of the file.
    pub(super) part: &'a Part,
    pub(super) options: &'a ReadOptions,
    pub(super) progress: &'a Progress,
}

type Decode = fn(&Encoded<'_>) -> Result<RawCloud, Fault>;

/// The frames in a file of a format that are read one by one, of the topic that is named.
type ContentsOf = fn(&Path, Format, Option<&str>, &ReadOptions) -> Result<Contents, IoError>;

/// Camera topics published in a file of a format; also where it has point clouds, if requested.
type CamerasOf = fn(&Path, Format, bool, &ReadOptions) -> Result<CameraTopics, IoError>;

/// The frames in a file.
type List = fn(&Path, &ReadOptions) -> Result<Vec<Entry>, IoError>;

/// Normals as stored in the file, one per row.
type Normals = fn(&[u8], &ReadOptions, &Progress) -> Result<Vec<[f32; 3]>, Fault>;

/// A format, and how it is read and written.
pub(super) struct Codec {
    pub(super) format: Format,
    pub(super) decode: Decode,
    /// `None` where a file is one frame, or its frames are files or messages within it.
    pub(super) list: Option<List>,
    /// Lister of the frames that a file contains as whole files, messages or packets.
    pub(super) contents: Option<ContentsOf>,
    /// Reader of camera topics, for formats that may contain camera images.
    pub(super) cameras: Option<CamerasOf>,
    /// Column access, for formats whose points are rows with named columns.
    pub(super) columns: Option<NamedColumns>,
    /// Its encoders.
    pub(super) encoders: &'static [&'static Encoder],
}

/// Functions that read named columns without reading all rows.
pub(super) struct NamedColumns {
    /// Layout of the point rows in a file that begins with the given bytes, if they can be read without the whole of
    /// it.
    pub(super) fixed_rows: fn(&[u8]) -> Option<FixedRows>,
    /// Names of the point attributes in a file with these first bytes.
    pub(super) point_names: fn(&[u8]) -> Option<Vec<String>>,
    /// The normals in a file that may have no points.
    pub(super) normals: Normals,
}

impl Codec {
    /// A format of one cloud a file that is read.
    pub(super) const fn reading(format: Format, decode: Decode) -> Self {
        Self {
            format,
            decode,
            list: None,
            contents: None,
            cameras: None,
            columns: None,
            encoders: &[],
        }
    }

    /// A format whose frames are read one by one.
    pub(super) const fn container(format: Format, contents: ContentsOf) -> Self {
        Self {
            contents: Some(contents),
            ..Self::reading(format, |file| {
                Err(Fault::header(format!(
                    "a {} file within another file is not read: unpack the outer one first",
                    file.format
                )))
            })
        }
    }

    /// A format of messages, possibly camera messages.
    pub(super) const fn recording(format: Format) -> Self {
        Self {
            cameras: Some(recording::cameras),
            ..Self::container(format, recording::list)
        }
    }
}
