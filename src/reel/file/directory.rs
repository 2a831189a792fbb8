//! The directory of a group: its grid, its schemas, and for each frame where its sections are.

use super::bytes::{ByteReader, ByteWriter};
use crate::cloud::codes::{AXES, UNITS, choice_of, code_of};
use crate::cloud::{AxisConvention, ImageGrid, LengthUnit};
use crate::reel::error::Fault;
use crate::reel::frame::{Grid, Schema, StreamKind};
use glam::DVec3;
use std::ops::Range;
use std::time::Duration;

/// Flags of a frame.
const INTER: u8 = 1 << 0;
const SENSOR: u8 = 1 << 1;
const IMAGE: u8 = 1 << 2;

/// A stream of a section: its bytes follow those of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct StreamRecord {
    pub(in crate::reel) kind: StreamKind,
    pub(in crate::reel) bytes: usize,
}

/// A part of a frame that is read as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::reel) struct SectionRecord {
    /// Levels that it adds; none if it adds the points.
    pub(in crate::reel) levels: Range<usize>,
    /// Byte offset of the section, from the end of the directory on.
    pub(in crate::reel) offset: u64,
    pub(in crate::reel) crc: u32,
    pub(in crate::reel) streams: Vec<StreamRecord>,
}

impl SectionRecord {
    /// Bytes of all streams.
    pub(in crate::reel) fn bytes(&self) -> u64 {
        self.streams.iter().map(|stream| stream.bytes as u64).sum()
    }
}

/// Metadata of a frame, known before it is decoded.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct FrameRecord {
    pub(in crate::reel) name: String,
    pub(in crate::reel) time: Option<Duration>,
    /// True if it is encoded relative to the previous frame.
    pub(in crate::reel) is_inter: bool,
    /// Index of its schema in the group.
    pub(in crate::reel) schema: usize,
    /// Points of the cloud that was written.
    pub(in crate::reel) points_written: u64,
    /// Points stored individually, in cells and outside.
    pub(in crate::reel) points: [usize; 2],
    /// Nodes of each level.
    pub(in crate::reel) counts: Vec<usize>,
    /// Offset to be added to each scalar.
    pub(in crate::reel) scalar_offsets: Vec<f64>,
    pub(in crate::reel) sensor: Option<DVec3>,
    pub(in crate::reel) convention: Option<AxisConvention>,
    pub(in crate::reel) unit: Option<LengthUnit>,
    pub(in crate::reel) image: Option<ImageGrid>,
    /// The sections that are there.
    pub(in crate::reel) sections: Vec<SectionRecord>,
    /// Extent present of a frame that the end of the file truncates.
    pub(in crate::reel) cut: Option<FrameCut>,
}

/// Extent present of a frame that the end of the file truncates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct FrameCut {
    /// Bytes that are there.
    pub(in crate::reel) bytes_there: u64,
    /// Bytes of the whole frame.
    pub(in crate::reel) bytes: u64,
    /// Points of the whole frame.
    pub(in crate::reel) points: usize,
}

/// The directory of a group.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct Directory {
    pub(in crate::reel) grid: Grid,
    pub(in crate::reel) schemas: Vec<Schema>,
    pub(in crate::reel) frames: Vec<FrameRecord>,
}

impl Directory {
    pub(in crate::reel) fn to_bytes(&self) -> Vec<u8> {
        let mut writer = ByteWriter::default();
        for number in self.grid.min.to_array().into_iter().chain([self.grid.cell]) {
            writer.f64(number);
        }
        writer.byte(self.grid.depth as u8);
        writer.number(self.schemas.len() as u64);
        for schema in &self.schemas {
            schema.write(&mut writer);
        }
        writer.number(self.frames.len() as u64);
        for frame in &self.frames {
            frame.write(&mut writer);
        }
        writer.bytes
    }

    /// Reads the directory of a group that has `data_bytes` bytes of data, as its chunk states.
    pub(in crate::reel) fn read(bytes: &[u8], data_bytes: u64) -> Result<Self, Fault> {
        let mut reader = ByteReader::new(bytes);
        let min = DVec3::new(reader.f64()?, reader.f64()?, reader.f64()?);
        let grid = Grid {
            min,
            cell: reader.f64()?,
            depth: u32::from(reader.byte()?),
        };
        if !grid.is_usable() {
            return Err(Fault::new(format!("a cube that cannot be ({grid:?})")));
        }
        let mut schemas = Vec::new();
        for _ in 0..reader.count("schemas")? {
            schemas.push(Schema::read(&mut reader)?);
        }
        let mut frames = Vec::new();
        for _ in 0..reader.count("frames")? {
            frames.push(FrameRecord::read(&mut reader, &grid, &schemas)?);
        }
        reader.end()?;
        let directory = Self { grid, schemas, frames };
        directory.check(data_bytes)?;
        Ok(directory)
    }

    /// Retains the data in the first `bytes`, as the file has no more: the complete sections of each frame, without
    /// frames that have none. Returns the number of frames that are absent altogether.
    pub(in crate::reel) fn cut(&mut self, bytes: u64) -> usize {
        let mut before = usize::MAX;
        for frame in &mut self.frames {
            let is_there = |section: &SectionRecord| section.offset.saturating_add(section.bytes()) <= bytes;
            let mut whole = frame.sections.iter().take_while(|section| is_there(section)).count();
            if frame.is_inter {
                // It moves the levels that are present of the preceding frame.
                whole = whole.min(before);
            }
            before = whole;
            if whole < frame.sections.len() {
                let there = |section: &SectionRecord| section.bytes().min(bytes.saturating_sub(section.offset));
                frame.cut = Some(FrameCut {
                    bytes_there: frame.sections.iter().map(there).sum(),
                    bytes: frame.sections.iter().map(SectionRecord::bytes).sum(),
                    points: frame.all_points(),
                });
                frame.sections.truncate(whole);
            }
        }
        let count = self.frames.len();
        let there = self
            .frames
            .iter()
            .take_while(|frame| !frame.sections.is_empty())
            .count();
        self.frames.truncate(there);
        count - there
    }
}

/// A time as it is written: nanoseconds and 1, since zero stands for no time. A foreign time may be the last number
/// there is, or beyond.
pub(super) fn time_number(time: Option<Duration>) -> u64 {
    let number = |time: Duration| u64::try_from(time.as_nanos()).map_or(u64::MAX, |nanos| nanos.saturating_add(1));
    time.map_or(0, number)
}

impl FrameRecord {
    /// Returns true if individually stored points are present.
    pub(in crate::reel) fn has_points(&self) -> bool {
        self.sections.last().is_some_and(|section| section.levels.is_empty())
    }

    /// Points of the whole frame.
    pub(in crate::reel) fn all_points(&self) -> usize {
        match self.cut {
            Some(cut) => cut.points,
            None if self.has_points() => self.points[0] + self.points[1],
            None => self.counts.last().copied().unwrap_or(0),
        }
    }

    /// Nodes of each level that is there.
    pub(in crate::reel) fn counts_there(&self) -> &[usize] {
        let levels = self.sections.last().map_or(0, |section| section.levels.end);
        self.counts.get(..levels).unwrap_or(&self.counts)
    }

    fn write(&self, writer: &mut ByteWriter) {
        writer.text(&self.name);
        writer.number(time_number(self.time));
        let sensor = if self.sensor.is_some() { SENSOR } else { 0 };
        let image = if self.image.is_some() { IMAGE } else { 0 };
        let inter = if self.is_inter { INTER } else { 0 };
        writer.byte(inter | sensor | image);
        writer.number(self.schema as u64);
        writer.number(self.points_written);
        writer.number(self.points[0] as u64);
        writer.number(self.points[1] as u64);
        writer.number(self.counts.len() as u64);
        for &count in &self.counts {
            writer.number(count as u64);
        }
        for &offset in &self.scalar_offsets {
            writer.f64(offset);
        }
        for number in self.sensor.into_iter().flat_map(|sensor| sensor.to_array()) {
            writer.f64(number);
        }
        writer.byte(code_of(&AXES, self.convention));
        writer.byte(code_of(&UNITS, self.unit));
        if let Some(image) = self.image {
            writer.number(u64::from(image.width()));
            writer.number(u64::from(image.height()));
        }
        writer.number(self.sections.len() as u64);
        for section in &self.sections {
            writer.number(section.levels.len() as u64);
            writer.number(section.offset);
            writer.u32(section.crc);
            writer.byte(section.streams.len() as u8);
            for stream in &section.streams {
                writer.byte(stream.kind as u8);
                writer.number(stream.bytes as u64);
            }
        }
    }

    fn read(reader: &mut ByteReader<'_>, grid: &Grid, schemas: &[Schema]) -> Result<Self, Fault> {
        let name = reader.text()?;
        let time = reader.number()?.checked_sub(1).map(Duration::from_nanos);
        let flags = reader.byte()?;
        if flags & !(INTER | SENSOR | IMAGE) != 0 {
            let problem = format!("frame {name} is coded in a way that only later versions know ({flags:#b})");
            return Err(Fault::new(problem));
        }
        let schema = reader.number()? as usize;
        let Some(of_schema) = schemas.get(schema) else {
            return Err(Fault::new(format!(
                "frame {name} has schema {schema} of {}",
                schemas.len()
            )));
        };
        let points_written = reader.number()?;
        let placed = reader.number()?;
        let outside = reader.number()?;
        if placed.saturating_add(outside) > 1 << 31 {
            return Err(Fault::new(format!(
                "frame {name} has {placed} and {outside} points: at most 2^31 can be"
            )));
        }
        let counts = read_counts(reader, grid, &name)?;
        let mut scalar_offsets = Vec::new();
        for _ in &of_schema.scalars {
            scalar_offsets.push(reader.f64()?);
        }
        let sensor = match flags & SENSOR {
            0 => None,
            _ => Some(DVec3::new(reader.f64()?, reader.f64()?, reader.f64()?)),
        };
        let convention = choice_of(&AXES, reader.byte()?.into());
        let unit = choice_of(&UNITS, reader.byte()?.into());
        let image = if flags & IMAGE == 0 {
            None
        } else {
            let [width, height] = [reader.number()?, reader.number()?].map(|side| side.min(u64::from(u32::MAX)) as u32);
            ImageGrid::of(width, height, (placed + outside) as usize)
        };
        let mut sections = Vec::new();
        let mut level = 0;
        for _ in 0..reader.count("sections")? {
            let section = SectionRecord::read(reader, level)?;
            if section.levels.end > counts.len() {
                return Err(Fault::new(format!(
                    "frame {name} has sections of more levels than {}",
                    counts.len()
                )));
            }
            level = section.levels.end;
            sections.push(section);
        }
        Ok(Self {
            name,
            time,
            is_inter: flags & INTER != 0,
            schema,
            points_written,
            points: [placed as usize, outside as usize],
            counts,
            scalar_offsets,
            sensor,
            convention,
            unit,
            image,
            sections,
            cut: None,
        })
    }

    /// Bytes of each kind of stream.
    pub(in crate::reel) fn bytes_by_stream(&self) -> [u64; StreamKind::ALL.len()] {
        let mut bytes = [0; StreamKind::ALL.len()];
        for stream in self.sections.iter().flat_map(|section| &section.streams) {
            bytes[stream.kind as usize] += stream.bytes as u64;
        }
        bytes
    }
}

/// Nodes of each level: a root, and below each node up to eight.
fn read_counts(reader: &mut ByteReader<'_>, grid: &Grid, name: &str) -> Result<Vec<usize>, Fault> {
    let levels = reader.count("levels")?;
    if levels != grid.depth as usize + 1 {
        return Err(Fault::new(format!(
            "frame {name} has {levels} levels of {}",
            grid.depth + 1
        )));
    }
    let mut counts = Vec::new();
    let mut above = None;
    for _ in 0..levels {
        let count = reader.number()?;
        let most = above.map_or(1, |above: u64| 8 * above);
        let least = above.unwrap_or(0);
        if !(least..=most).contains(&count) || count > 1 << 31 {
            return Err(Fault::new(format!(
                "frame {name} has {count} nodes below {}",
                above.unwrap_or(0)
            )));
        }
        above = Some(count);
        counts.push(count as usize);
    }
    Ok(counts)
}

impl SectionRecord {
    fn read(reader: &mut ByteReader<'_>, first_level: usize) -> Result<Self, Fault> {
        let levels = reader.number()?.min(64) as usize;
        let offset = reader.number()?;
        let crc = reader.u32()?;
        let mut streams = Vec::new();
        for _ in 0..reader.byte()? {
            let kind = reader.byte()?;
            let Some(&kind) = StreamKind::ALL.get(usize::from(kind)) else {
                return Err(Fault::new(format!("a stream of an unknown kind ({kind})")));
            };
            let bytes = reader.number()?;
            if bytes > 1 << 40 {
                return Err(Fault::new(format!("a stream of {bytes} bytes")));
            }
            streams.push(StreamRecord {
                kind,
                bytes: bytes as usize,
            });
        }
        Ok(Self {
            levels: first_level..first_level + levels,
            offset,
            crc,
            streams,
        })
    }
}
