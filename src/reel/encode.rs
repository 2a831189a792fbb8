//! A group of frames as bytes: apart from writing, so that groups are encoded on all cores and written in order.

use super::error::ReelError;
use super::file::{Directory, FrameRecord, SectionRecord, StreamRecord};
use super::frame::{
    CodedSection, Followed, GroupPlan, Run, Schema, choose_parent_colors, encode_inter, encode_pose, follows, prepare,
};
use super::options::{Precision, ReelOptions};
use crate::analysis::{FileSurface, SurfaceOptions};
use crate::cloud::RawCloud;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use std::time::Duration;

/// Maximum number of points of a frame: indices have 31 bits.
const MAX_POINTS: usize = (1 << 31) - 1;

/// A frame that is to be written.
#[derive(Debug, Clone, Copy)]
pub struct NewFrame<'a> {
    /// Its points. Faces and their textures are not stored.
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
/// Errors for invalid options, and for clouds with an attribute that does not have one entry per point.
pub fn encode_group(frames: &[NewFrame<'_>], options: &ReelOptions) -> Result<EncodedGroup, ReelError> {
    options.check()?;
    for frame in frames {
        check(frame)?;
    }
    let clouds = frames.par_iter().map(|frame| with_normals(frame, options));
    let clouds: Vec<Cow<'_, RawCloud>> = clouds.collect::<Result<_, _>>()?;
    let clouds: Vec<&RawCloud> = clouds.iter().map(AsRef::as_ref).collect();
    let mut plan = GroupPlan::new(&clouds, options);
    let runs = runs_of(&plan, &clouds, options);
    choose_parent_colors(&mut plan, &clouds, &runs);
    let coded: Vec<Vec<CodedFrame>> = runs
        .into_par_iter()
        .map(|run| encode_run(&plan, &clouds, run))
        .collect();
    let coded = coded.concat();
    let mut schemas: Vec<Schema> = Vec::new();
    let mut records = Vec::new();
    for (index, (frame, coded)) in frames.iter().zip(&coded).enumerate() {
        let schema = &plan.schemas[index];
        let place = schemas.iter().position(|other| other == schema).unwrap_or_else(|| {
            schemas.push(schema.clone());
            schemas.len() - 1
        });
        records.push(record(frame, coded, place, schema));
    }
    let mut data = Vec::new();
    // The first sections of all frames are stored together: they are read while scrubbing.
    for is_first in [true, false] {
        for (record, coded) in records.iter_mut().zip(&coded) {
            let (first, rest) = coded.sections.split_at(coded.sections.len().min(1));
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

/// A frame as streams, and how many nodes and points these are.
#[derive(Debug, Clone)]
struct CodedFrame {
    is_inter: bool,
    counts: Vec<usize>,
    points: [usize; 2],
    sections: Vec<CodedSection>,
}

impl CodedFrame {
    fn bytes(&self) -> usize {
        let streams = self.sections.iter().flat_map(|section| &section.streams);
        streams.map(|(_, bytes)| bytes.len()).sum()
    }
}

/// Returns the runs of consecutive frames that may be encoded relative to the first of them.
fn runs_of(plan: &GroupPlan, clouds: &[&RawCloud], options: &ReelOptions) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for index in 0..clouds.len() {
        match runs.last_mut() {
            Some(run) if options.may_follow() && follows(plan, clouds, run.start, index) => run.end = index + 1,
            _ => runs.push(index..index + 1),
        }
    }
    runs
}

/// Encodes the frames of a run: the first stands alone, and so does each that would take more bytes if encoded relative
/// to the one before.
fn encode_run(plan: &GroupPlan, clouds: &[&RawCloud], run: Range<usize>) -> Vec<CodedFrame> {
    let mut coded: Vec<CodedFrame> = Vec::with_capacity(run.len());
    let mut key: Option<(Run<'_>, Followed, usize)> = None;
    for index in run.clone() {
        if let Some((of_key, followed, key_bytes)) = &mut key
            && let Some(changes) = of_key.changes(index, clouds[index], followed)
        {
            let sections = encode_inter(&plan.schemas[index], followed, changes);
            let before = &coded[coded.len() - 1];
            let inter = CodedFrame {
                is_inter: true,
                counts: before.counts.clone(),
                points: before.points,
                sections,
            };
            if inter.bytes() < *key_bytes {
                coded.push(inter);
                continue;
            }
        }
        let mut pose = prepare(plan, index, clouds[index]);
        let sections = encode_pose(&plan.schemas[index], &plan.grid, &mut pose);
        let points = pose.points.as_ref();
        let frame = CodedFrame {
            is_inter: false,
            counts: pose.counts(),
            points: points.map_or([0; 2], |points| [points.below.len(), points.outside.len()]),
            sections,
        };
        let followed = (index + 1 < run.end).then(|| Followed::of(&plan.schemas[index], &plan.grid, &pose));
        key = followed.flatten().and_then(|followed| {
            let of_key = Run::new(plan, index, clouds[index], &pose, &followed)?;
            Some((of_key, followed, frame.bytes()))
        });
        coded.push(frame);
    }
    coded
}

/// The points of a frame with normals, if they are to be estimated.
fn with_normals<'a>(frame: &NewFrame<'a>, options: &ReelOptions) -> Result<Cow<'a, RawCloud>, ReelError> {
    let has_normals = frame.cloud.attributes.normals.is_some();
    if has_normals || !options.estimates_normals || options.precision != Precision::SamplingDensity {
        return Ok(Cow::Borrowed(frame.cloud));
    }
    let surface = FileSurface::of(frame.cloud, SurfaceOptions::AUTO).map_err(|error| ReelError::Cloud {
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
        None if count > MAX_POINTS => format!("{count} points are more than a frame can hold"),
        None => return Ok(()),
    };
    Err(ReelError::Cloud {
        name: frame.name.to_owned(),
        problem,
    })
}

fn record(frame: &NewFrame<'_>, coded: &CodedFrame, schema: usize, of_schema: &Schema) -> FrameRecord {
    let cloud = frame.cloud;
    FrameRecord {
        name: frame.name.to_owned(),
        time: frame.time,
        is_inter: coded.is_inter,
        schema,
        points_written: cloud.positions.len() as u64,
        points: coded.points,
        counts: coded.counts.clone(),
        scalar_offsets: cloud.attributes.scalars.iter().map(|field| field.offset).collect(),
        sensor: cloud.sensor,
        convention: cloud.convention,
        unit: cloud.unit,
        image: cloud.grid.filter(|_| of_schema.has_order),
        sections: Vec::new(),
        cut: None,
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
