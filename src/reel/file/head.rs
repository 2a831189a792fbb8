//! File header: magic, version, and a chunk that states how the file was made.

use super::bytes::{ByteReader, ByteWriter};
use super::part::FilePart;
use crate::reel::error::Fault;

/// Versions with another first number cannot be read; a higher second one adds only skippable data.
pub(in crate::reel) const VERSION: [u16; 2] = [3, 3];

/// Bytes before the first chunk.
pub(in crate::reel) const MAGIC_AND_VERSION_BYTES: usize = 12;

/// File header with the metadata that a file states about itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct Head {
    /// Frame rate in frames per second, if timestamps do not determine it.
    pub(in crate::reel) fps: Option<f64>,
    /// Frames of a group.
    pub(in crate::reel) keyframes: u32,
    /// Names and values, for people.
    pub(in crate::reel) settings: Vec<(String, String)>,
    /// Part of a conversion, i.e. the frames that the file has of it; `None` for files of other writers and before
    /// version 3.2.
    pub(in crate::reel) part: Option<FilePart>,
}

impl Head {
    pub(in crate::reel) fn to_bytes(&self) -> Vec<u8> {
        let mut writer = ByteWriter::default();
        writer.f64(self.fps.unwrap_or(0.0));
        writer.number(u64::from(self.keyframes));
        writer.number(self.settings.len() as u64);
        for (name, value) in &self.settings {
            writer.text(name);
            writer.text(value);
        }
        if let Some(part) = &self.part {
            part.write(&mut writer);
        }
        writer.bytes
    }

    /// Reads the header; anything after the part belongs to later versions.
    pub(in crate::reel) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut reader = ByteReader::new(bytes);
        let fps = reader.f64()?;
        let keyframes = reader.number()?.min(u64::from(u32::MAX)) as u32;
        let mut settings = Vec::new();
        for _ in 0..reader.count("settings")? {
            settings.push((reader.text()?, reader.text()?));
        }
        let part = (reader.left() > 0).then(|| FilePart::read(&mut reader)).transpose()?;
        Ok(Self {
            part,
            fps: Some(fps).filter(|fps| *fps > 0.0 && fps.is_finite()),
            keyframes,
            settings,
        })
    }
}
