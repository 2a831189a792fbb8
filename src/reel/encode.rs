//! A group of frames as bytes: apart from writing, so that groups are encoded on all cores and written in order.

use super::error::ReelError;
use super::file::{Directory, FrameRecord, SectionRecord, StreamRecord};
use super::frame::{CodedSection, GroupPlan, Pose, Schema, encode_pose, prepare};
use super::options::{Precision, ReelOptions};
use crate::analysis::FileSurface;
use crate::cloud::RawCloud;
use rayon::prelude::*;
use std::borrow::Cow;
use std::time::Duration;

/// Most points of a frame: indices of 31 bits tell them apart.
const MOST_POINTS: usize = (1 << 31) - 1;

/// A frame that is to be written.
#[derive(Debug, Clone, Copy)]
pub struct NewFrame<'a> {
    /// Its points. Faces and pictures on them are not kept.
    pub cloud: &'a RawCloud,
    /// Its name, for people.
    pub name: &'a str,
    /// Its time stamp.
    pub time: Option<Duration>,
}

/// A group that is encoded and not yet written.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodedGroup {
    pub(super) directory: Directory,
    pub(super) directory_bytes: Vec<u8>,
    pub(super) data: Vec<u8>,
}

impl EncodedGroup {
    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.directory.frames.len()
    }

    /// Bytes that it takes in a file, but for the header of its chunk.
    pub fn byte_size(&self) -> usize {
        self.directory_bytes.len() + self.data.len()
    }
}

/// Encodes frames that follow each other as a group: they share a cube and the steps of scalars.
///
/// # Errors
/// Options that cannot be meant, and clouds of which an attribute has not one entry a point.
pub fn encode_group(frames: &[NewFrame<'_>], options: &ReelOptions) -> Result<EncodedGroup, ReelError> {
    options.check()?;
    for frame in frames {
        check(frame)?;
    }
    let clouds = frames.par_iter().map(|frame| with_normals(frame, options));
    let clouds: Vec<Cow<'_, RawCloud>> = clouds.collect::<Result<_, _>>()?;
    let clouds: Vec<&RawCloud> = clouds.iter().map(AsRef::as_ref).collect();
    let plan = GroupPlan::new(&clouds, options);
    let coded: Vec<(Pose, Vec<CodedSection>)> = clouds
        .par_iter()
        .enumerate()
        .map(|(index, cloud)| {
            let mut pose = prepare(&plan, index, cloud);
            let sections = encode_pose(&plan.schemas[index], &plan.grid, &mut pose);
            (pose, sections)
        })
        .collect();
    let mut schemas: Vec<Schema> = Vec::new();
    let mut records = Vec::new();
    for (index, (frame, (pose, _))) in frames.iter().zip(&coded).enumerate() {
        let schema = &plan.schemas[index];
        let place = schemas.iter().position(|other| other == schema).unwrap_or_else(|| {
            schemas.push(schema.clone());
            schemas.len() - 1
        });
        records.push(record(frame, pose, place, schema));
    }
    let mut data = Vec::new();
    // The first sections of all frames stand together: they are read for scrubbing.
    for is_first in [true, false] {
        for (record, (_, sections)) in records.iter_mut().zip(&coded) {
            let (first, rest) = sections.split_at(sections.len().min(1));
            for section in if is_first { first } else { rest } {
                record.sections.push(append(section, &mut data));
            }
        }
    }
    let directory = Directory {
        grid: plan.grid,
        schemas,
        frames: records,
    };
    Ok(EncodedGroup {
        directory_bytes: directory.to_bytes(),
        directory,
        data,
    })
}

/// The points of a frame with normals, if they are to be estimated.
fn with_normals<'a>(frame: &NewFrame<'a>, options: &ReelOptions) -> Result<Cow<'a, RawCloud>, ReelError> {
    let has_normals = frame.cloud.attributes.normals.is_some();
    if has_normals || !options.estimates_normals || options.precision != Precision::SamplingDensity {
        return Ok(Cow::Borrowed(frame.cloud));
    }
    let surface = FileSurface::of(frame.cloud).map_err(|error| ReelError::Cloud {
        name: frame.name.to_owned(),
        problem: error.to_string(),
    })?;
    let mut cloud = frame.cloud.clone();
    cloud.attributes.normals = surface.map(|surface| surface.normals);
    Ok(Cow::Owned(cloud))
}

fn check(frame: &NewFrame<'_>) -> Result<(), ReelError> {
    let count = frame.cloud.positions.len();
    let problem = match frame.cloud.attributes.other_length(count) {
        Some((attribute, found)) => format!("{attribute} has {found} entries for {count} points"),
        None if count > MOST_POINTS => format!("{count} points are more than a frame can hold"),
        None => return Ok(()),
    };
    Err(ReelError::Cloud {
        name: frame.name.to_owned(),
        problem,
    })
}

fn record(frame: &NewFrame<'_>, pose: &Pose, schema: usize, of_schema: &Schema) -> FrameRecord {
    let cloud = frame.cloud;
    let points = pose.points.as_ref();
    FrameRecord {
        name: frame.name.to_owned(),
        time: frame.time,
        schema,
        points_written: cloud.positions.len() as u64,
        points: points.map_or([0; 2], |points| [points.below.len(), points.outside.len()]),
        counts: pose.levels.iter().map(|level| level.cells.len()).collect(),
        scalar_offsets: cloud.attributes.scalars.iter().map(|field| field.offset).collect(),
        sensor: cloud.sensor,
        convention: cloud.convention,
        unit: cloud.unit,
        image: cloud.grid.filter(|_| of_schema.has_order),
        sections: Vec::new(),
    }
}

fn append(section: &CodedSection, data: &mut Vec<u8>) -> SectionRecord {
    let offset = data.len();
    let streams = section.streams.iter().map(|(kind, bytes)| {
        data.extend(bytes);
        StreamRecord {
            kind: *kind,
            bytes: bytes.len(),
        }
    });
    let streams = streams.collect();
    SectionRecord {
        levels: section.levels.clone(),
        offset: offset as u64,
        crc: crc32fast::hash(&data[offset..]),
        streams,
    }
}
