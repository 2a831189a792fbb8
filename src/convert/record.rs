//! What a folder of converted frames was made with, so that nobody mixes two conversions in it.

use super::conversion::{Conversion, Output};
use super::error::ConvertError;
use crate::sequence::{FrameEntry, Sequence};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Name of the file in the folder.
const FILE_NAME: &str = ".pointreel-convert.json";

/// The options that a converted frame depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    format: String,
    edit: String,
    /// Topics of recordings that are read.
    #[serde(default)]
    topics: Vec<String>,
}

impl Record {
    pub(super) fn of(conversion: &Conversion, sequence: &Sequence) -> Self {
        let mut topics = sequence.source().topics();
        topics.retain(|topic| topic.is_read);
        Self {
            topics: topics.into_iter().map(|topic| topic.name).collect(),
            format: match &conversion.output {
                Output::Reel(_, options) => format!("{options:?}"),
                Output::File(_) | Output::Folder(_) => conversion.format.to_string(),
            },
            edit: conversion.edit.to_string(),
        }
    }

    /// The same as a text, with a number that stands for the names and times of what is read.
    pub(super) fn made_of(&self, frames: &[Arc<FrameEntry>]) -> String {
        let mut names = crc32fast::Hasher::new();
        for entry in frames {
            names.update(entry.name.as_bytes());
            names.update(&entry.time.map_or(0, |time| time.as_nanos()).to_le_bytes());
        }
        let options = serde_json::to_string(self).unwrap_or_default();
        format!("{} frames {:08x} {options}", frames.len(), names.finalize())
    }

    /// What a conversion has left in `folder`.
    pub(super) fn read(folder: &Path) -> Option<Self> {
        let bytes = std::fs::read(folder.join(FILE_NAME)).ok()?;
        serde_json::from_slice(&bytes).ok()
    }

    /// Leaves itself in `folder`, unless another one is there and is not to be overwritten. Several shards may do so at
    /// once: they write the same.
    pub(super) fn keep_in(&self, folder: &Path, overwrites: bool) -> Result<(), ConvertError> {
        let path = folder.join(FILE_NAME);
        match Self::read(folder) {
            Some(known) if known == *self => return Ok(()),
            Some(known) if !overwrites => {
                return Err(ConvertError::OtherConversion {
                    path: folder.to_owned(),
                    difference: self.difference(&known),
                });
            }
            _ => {}
        }
        let text = serde_json::to_vec_pretty(self).unwrap_or_default();
        crate::kept::write_whole(&path, &text).map_err(|reason| ConvertError::Write { path, reason })
    }

    fn difference(&self, known: &Self) -> String {
        let (there, now) = if self.format != known.format {
            (known.format.clone(), self.format.clone())
        } else if self.edit != known.edit {
            (known.edit.clone(), self.edit.clone())
        } else {
            let topics = |topics: &[String]| match topics {
                [] => "no topic".to_owned(),
                topics => format!("topic {}", topics.join(", ")),
            };
            (topics(&known.topics), topics(&self.topics))
        };
        format!("{there} there, {now} now")
    }
}
