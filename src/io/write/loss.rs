//! Losses: the parts of a cloud that a target cannot hold, which are reported, and never dropped silently.
//!
//! Losses of many frames are summed up in [`Losses`]: one line per kind.

use crate::cloud::RawCloud;
use std::collections::BTreeMap;

/// Something that a written file lacks.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Loss {
    /// Points without coordinates.
    Holes,
    /// Something that a point has, by its name.
    Field(String),
    /// Triangles.
    Faces,
    /// Textures of triangles.
    Textures,
    /// Rows and columns of an organised cloud.
    Rows,
    /// The position of the sensor.
    Sensor,
    /// The name of a scalar, and its name in the output.
    Name(String, String),
    /// Values of a scalar that are rounded or clamped, and their target.
    Values(String, String),
    /// Source data that was not read, in words.
    Dropped(String),
    /// Coordinates that are rounded; the amount is the largest error.
    Precision,
}

/// Losses of frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Losses(BTreeMap<Loss, Tally>);

/// Tally of one kind of loss.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Tally {
    frames: usize,
    /// Number of losses, or size of the error.
    amount: f64,
}

impl Loss {
    /// Returns true if the maximum over all frames is counted instead of their sum.
    fn is_largest(&self) -> bool {
        matches!(self, Self::Precision)
    }

    fn line(&self, format: &str, amount: f64) -> String {
        match self {
            Self::Holes => format!("{format} cannot hold points without coordinates: {amount} are not written"),
            Self::Field(name) => format!("{format} cannot hold {name}: not written"),
            Self::Faces => format!("{format} cannot hold faces: {amount} are not written, only their points"),
            Self::Textures => format!("{format} cannot hold texture images: not written"),
            Self::Rows => {
                format!(
                    "{format} cannot hold the rows and columns of an organised cloud: points are written one by one"
                )
            }
            Self::Sensor => format!("{format} cannot hold the position of the sensor: not written"),
            Self::Name(from, to) => format!("{format} cannot hold the field name `{from}`: it is written as `{to}`"),
            Self::Values(name, to) => format!("{format} holds {name} as {to}: values are rounded"),
            Self::Dropped(what) => what.clone(),
            Self::Precision => format!("{format} rounds coordinates here, by up to {amount:.3e}"),
        }
    }
}

impl Losses {
    /// Adds a loss of one frame: a count or an error.
    pub fn add(&mut self, loss: Loss, amount: f64) {
        self.add_tally(loss, Tally { frames: 1, amount });
    }

    fn add_tally(&mut self, loss: Loss, more: Tally) {
        let is_largest = loss.is_largest();
        let tally = self.0.entry(loss).or_default();
        tally.frames += more.frames;
        tally.amount = if is_largest {
            tally.amount.max(more.amount)
        } else {
            tally.amount + more.amount
        };
    }

    /// Adds the unread parts of the file of `cloud`.
    pub fn add_dropped(&mut self, cloud: &RawCloud) {
        for entry in &cloud.dropped {
            self.add(Loss::Dropped(entry.what.clone()), 0.0);
        }
    }

    /// Adds losses of other frames.
    pub fn merge(&mut self, others: Self) {
        for (loss, tally) in others.0 {
            self.add_tally(loss, tally);
        }
    }

    /// True if nothing is lost.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the kinds of losses.
    pub fn kinds(&self) -> impl Iterator<Item = &Loss> {
        self.0.keys()
    }

    /// One line per kind: the loss in `format`, and the number of affected frames if not all of `frame_count`. Fields
    /// of the same number of frames share a line.
    pub fn lines(&self, format: &str, frame_count: usize) -> Vec<String> {
        let of_frames = |line: String, frames: usize| match frames {
            frames if frames >= frame_count => line,
            frames => format!("{line} ({frames} of {frame_count} frames)"),
        };
        let mut fields: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
        let mut others = Vec::new();
        for (loss, tally) in &self.0 {
            match loss {
                Loss::Field(name) => fields.entry(tally.frames).or_default().push(name),
                loss => others.push(of_frames(loss.line(format, tally.amount), tally.frames)),
            }
        }
        let line = |(frames, names): (usize, Vec<&str>)| {
            of_frames(
                format!("{format} cannot hold {}: not written", names.join(", ")),
                frames,
            )
        };
        fields.into_iter().rev().map(line).chain(others).collect()
    }
}
