//! Frames of a file, whole or by their coarse levels.

use super::cut::share_there;
use super::error::{Fault, ReelError};
use super::file::{Directory, FrameRecord, SectionRecord, checksum, is_right};
use super::frame::{CodedSection, Followed, Pose, Wanted, cloud_of, cloud_of_followed, decode_inter, decode_pose};
use super::reader::ReelFile;
use crate::cloud::RawCloud;
use crate::progress::Progress;
use std::ops::Range;
use std::sync::Arc;

/// Maximum number of nodes in a byte of a stream: even a predicted bit costs something.
const NODES_PER_BYTE: u64 = 1 << 15;

/// Number of nodes that take about one second. Beyond it, a byte holds at most [`MANY_NODES_PER_BYTE`]: a file of a few
/// kilobytes that claims a billion points would be made to keep its reader busy.
const MANY_NODES: u64 = 1 << 22;
const MANY_NODES_PER_BYTE: u64 = 1 << 9;

/// A frame that was decoded.
#[derive(Debug, Clone, PartialEq)]
pub struct DecodedFrame {
    /// Points, colours, normals, radii and scalars as they were written, in Morton order or in file order. For coarse
    /// levels, the means of their nodes, with radii that close the surface.
    pub cloud: RawCloud,
    /// Points of the frame, were all of it decoded.
    pub points_in_frame: usize,
    /// Levels that were decoded.
    pub levels: u8,
    /// True if the frame was decoded completely.
    pub is_whole: bool,
    /// Edge of the cells that its points stand for, in the unit of the file; where points are stored individually, of
    /// the cells with about one point each.
    pub cell_edge: f64,
}

/// Decodes frames, one after the other or in any order.
#[derive(Debug)]
pub struct ReelDecoder {
    file: Arc<ReelFile>,
    max_memory_bytes: u64,
    group: Option<OpenGroup>,
    last: Option<LastFrame>,
}

/// The group of the last frame.
#[derive(Debug)]
struct OpenGroup {
    index: usize,
    directory: Directory,
    frames: Range<usize>,
    data: u64,
}

/// Last decoded frame, cached if the next one may be encoded relative to it.
#[derive(Debug)]
struct LastFrame {
    group: usize,
    /// Its place in the group.
    place: usize,
    /// Number of its sections that were decoded.
    sections: usize,
    followed: Followed,
}

impl ReelDecoder {
    /// Creates a decoder for a file; decoding a frame may take at most `max_memory_bytes` bytes of memory.
    pub fn new(file: Arc<ReelFile>, max_memory_bytes: u64) -> Self {
        Self {
            file,
            max_memory_bytes,
            group: None,
            last: None,
        }
    }

    /// The file.
    pub fn file(&self) -> &Arc<ReelFile> {
        &self.file
    }

    /// Decodes frame `index` at its finest level of at most `max_points` points (at its root, if no level has so few;
    /// `usize::MAX` for all of it). The result does not depend on earlier decoding, but the time does: a frame that is
    /// encoded relative to others is decoded after them, unless the one before it was decoded last.
    ///
    /// # Errors
    /// No such frame, bytes that are damaged, more memory than is allowed, and cancellation.
    pub fn decode(&mut self, index: usize, max_points: usize, progress: &Progress) -> Result<DecodedFrame, ReelError> {
        let file = Arc::clone(&self.file);
        let Some(group) = file.group_of(index) else {
            return Err(ReelError::NoFrame {
                path: file.path().to_owned(),
                index,
                count: file.frame_count(),
            });
        };
        let group = open_group(&mut self.group, &file, group)?;
        let place = index - group.frames.start;
        let choice = Choice::of(&group.directory.frames[place], max_points);
        let reading = Reading {
            file: &file,
            group,
            choice,
            allowed: self.max_memory_bytes,
            progress,
        };
        let cloud = reading.cloud(place, &mut self.last)?;
        let frame = &group.directory.frames[place];
        Ok(DecodedFrame {
            cloud: finished(frame, cloud, choice),
            points_in_frame: frame.all_points(),
            levels: choice.levels as u8,
            is_whole: choice.is_whole,
            cell_edge: group.directory.grid.edge((choice.levels.max(1) - 1) as u32),
        })
    }
}

/// Read context of a group: the chosen level of detail, the memory limit and the progress.
struct Reading<'a> {
    file: &'a ReelFile,
    group: &'a OpenGroup,
    choice: Choice,
    allowed: u64,
    progress: &'a Progress,
}

impl Reading<'_> {
    /// Decodes the cloud of a frame of the group; `last` is the previously decoded frame, and becomes the reference of
    /// the next.
    fn cloud(&self, place: usize, last: &mut Option<LastFrame>) -> Result<RawCloud, ReelError> {
        let Directory { grid, schemas, frames } = &self.group.directory;
        let frame = &frames[place];
        let schema = &schemas[frame.schema];
        let key = (0..place)
            .rev()
            .find(|&place| !frames[place + 1].is_inter)
            .map_or(0, |before| before + 1);
        let Choice {
            sections,
            levels,
            is_whole,
        } = self.choice;
        let known = last.take().filter(|last| {
            last.group == self.group.index && last.sections == sections && (key..=place).contains(&last.place)
        });
        if key == place {
            let is_followed = frames.get(place + 1).is_some_and(|next| next.is_inter);
            let mut pose = self.pose(place, is_followed)?;
            let followed = is_followed.then(|| Followed::of(schema, grid, &pose)).flatten();
            *last = followed.map(|followed| self.last(place, followed));
            pose.truncate(levels);
            return Ok(cloud_of(schema, grid, pose, &frame.scalar_offsets));
        }
        let (mut followed, from) = if let Some(last) = known {
            (last.followed, last.place)
        } else {
            let followed = Followed::of(schema, grid, &self.pose(key, true)?);
            let unfollowed = || self.fault(place, Fault::new("it moves a frame that keeps every bit"));
            (followed.ok_or_else(unfollowed)?, key)
        };
        for next in from + 1..=place {
            let sections = self.sections(next)?;
            decode_inter(schema, &mut followed, &sections).map_err(|fault| self.fault(next, fault))?;
        }
        let level = if is_whole && frame.has_points() {
            levels
        } else {
            levels - 1
        };
        let cloud = cloud_of_followed(schema, grid, &followed, level, &frame.scalar_offsets);
        *last = Some(self.last(place, followed));
        Ok(cloud)
    }

    /// A frame that stands alone, as whole numbers; with the values of all levels, or at least of the last one.
    fn pose(&self, place: usize, keeps_levels: bool) -> Result<Pose, ReelError> {
        let sections = self.sections(place)?;
        let frame = &self.group.directory.frames[place];
        let wanted = Wanted {
            schema: &self.group.directory.schemas[frame.schema],
            grid: &self.group.directory.grid,
            counts: &frame.counts,
            points: frame.points,
            keeps_levels,
        };
        decode_pose(&wanted, &sections).map_err(|fault| self.fault(place, fault))
    }

    /// The chosen sections of a frame.
    fn sections(&self, place: usize) -> Result<Vec<CodedSection>, ReelError> {
        if self.progress.is_cancelled() {
            return Err(ReelError::Cancelled {
                path: self.file.path().to_owned(),
            });
        }
        let frame = &self.group.directory.frames[place];
        let limits = Limits {
            frame: self.group.frames.start + place,
            allowed: self.allowed,
        };
        let schema = &self.group.directory.schemas[frame.schema];
        limits.check(
            self.file,
            frame,
            &self.choice,
            schema.bytes_per_point(),
            self.group.data,
        )?;
        let count = self.choice.sections.min(frame.sections.len());
        read_sections(self.file, &frame.sections[..count], self.group.data)
    }

    fn name(&self, place: usize) -> String {
        let index = self.group.frames.start + place;
        format!("{index} ({})", self.group.directory.frames[place].name)
    }

    fn fault(&self, place: usize, Fault(problem): Fault) -> ReelError {
        let sections = &self.group.directory.frames[place].sections;
        let first_byte = sections.first().map_or(0, |section| section.offset);
        Fault(format!("frame {}: {problem}", self.name(place))).at(self.file.path(), self.group.data + first_byte)
    }

    fn last(&self, place: usize, followed: Followed) -> LastFrame {
        LastFrame {
            group: self.group.index,
            place,
            sections: self.choice.sections,
            followed,
        }
    }
}

/// The group, opened unless it is the last one that was.
fn open_group<'a>(last: &'a mut Option<OpenGroup>, file: &ReelFile, index: usize) -> Result<&'a OpenGroup, ReelError> {
    let open = match last.take() {
        Some(group) if group.index == index => group,
        _ => {
            let (directory, frames, data) = file.directory(index)?;
            OpenGroup {
                index,
                directory,
                frames,
                data,
            }
        }
    };
    Ok(last.insert(open))
}

/// Choice of how much of a frame is decoded.
#[derive(Debug, Clone, Copy)]
struct Choice {
    sections: usize,
    levels: usize,
    is_whole: bool,
}

impl Choice {
    fn of(frame: &FrameRecord, max_points: usize) -> Self {
        if frame.all_points() <= max_points && frame.cut.is_none() {
            return Self {
                sections: frame.sections.len(),
                levels: frame.counts.len(),
                is_whole: true,
            };
        }
        let levels = frame
            .counts_there()
            .iter()
            .rposition(|&count| count <= max_points)
            .map_or(1, |level| level + 1);
        let sections = frame.sections.iter().position(|section| section.levels.end >= levels);
        Self {
            sections: sections.map_or(frame.sections.len(), |last| last + 1),
            levels,
            is_whole: levels == frame.counts.len() && !frame.has_points() && frame.cut.is_none(),
        }
    }
}

/// Memory limits for the allocations of a frame.
struct Limits {
    frame: usize,
    allowed: u64,
}

impl Limits {
    fn check(
        &self,
        file: &ReelFile,
        frame: &FrameRecord,
        choice: &Choice,
        point_bytes: u64,
        data: u64,
    ) -> Result<(), ReelError> {
        let sections = &frame.sections[..choice.sections];
        let levels = sections.last().map_or(0, |section| section.levels.end);
        let nodes: u64 = frame.counts[..levels].iter().map(|&count| count as u64).sum();
        let points = if choice.is_whole && frame.has_points() {
            frame.all_points() as u64
        } else {
            0
        };
        let bytes: u64 = sections.iter().map(SectionRecord::bytes).sum();
        let per_byte = match nodes + points {
            0..=MANY_NODES => NODES_PER_BYTE,
            _ => MANY_NODES_PER_BYTE,
        };
        if nodes + points > per_byte.saturating_mul(bytes.saturating_add(8)) {
            let problem = format!(
                "frame {} has {nodes} nodes and {points} points in {bytes} bytes",
                self.frame
            );
            return Err(Fault::new(problem).at(file.path(), data));
        }
        let needed = (nodes + points).saturating_mul(point_bytes).saturating_add(bytes);
        if needed > self.allowed {
            return Err(ReelError::TooLarge {
                path: file.path().to_owned(),
                frame: self.frame,
                needed,
                allowed: self.allowed,
            });
        }
        Ok(())
    }
}

/// The streams of sections, those that stand together in one go.
fn read_sections(file: &ReelFile, records: &[SectionRecord], data: u64) -> Result<Vec<CodedSection>, ReelError> {
    let mut sections = Vec::new();
    let mut rest = records;
    while let Some(first) = rest.first() {
        let mut end = first.offset.saturating_add(first.bytes());
        let mut together = 1;
        while let Some(next) = rest.get(together).filter(|next| next.offset == end) {
            end = end.saturating_add(next.bytes());
            together += 1;
        }
        let start = data.saturating_add(first.offset);
        let bytes = file.data(start, end - first.offset)?;
        let mut left = bytes.as_slice();
        for record in &rest[..together] {
            let (own, others) = left.split_at(record.bytes() as usize);
            left = others;
            let found = crc32fast::hash(own);
            if !is_right(found, record.crc) {
                let byte = data.saturating_add(record.offset);
                return Err(checksum("a part of a frame", found, record.crc).at(file.path(), byte));
            }
            sections.push(section_of(record, own));
        }
        rest = &rest[together..];
    }
    Ok(sections)
}

fn section_of(record: &SectionRecord, mut bytes: &[u8]) -> CodedSection {
    let streams = record.streams.iter().map(|stream| {
        let (own, rest) = bytes.split_at(stream.bytes);
        bytes = rest;
        (stream.kind, own.to_vec())
    });
    CodedSection {
        levels: record.levels.clone(),
        streams: streams.collect(),
    }
}

/// Adds the metadata of the frame to its points.
fn finished(frame: &FrameRecord, mut cloud: RawCloud, choice: Choice) -> RawCloud {
    cloud.sensor = frame.sensor;
    cloud.convention = frame.convention;
    cloud.unit = frame.unit;
    cloud.grid = frame.image.filter(|_| choice.is_whole);
    if let Some(cut) = frame.cut.filter(|_| choice.levels == frame.counts_there().len()) {
        cloud.warnings.push(format!(
            "the file ends early: {}; {} of {} points",
            share_there(frame, cut),
            cloud.positions.len(),
            cut.points
        ));
    }
    cloud
}
