//! Parts of symbols, each with a coder in each section.

use crate::reel::coder::SymbolCoder;
use crate::reel::error::Fault;

/// Coding direction: source of the symbol coders, and handling of their output.
pub(super) trait Direction: Sync {
    type Coder: SymbolCoder;

    /// Opens the coder of a part in a section.
    fn open(&self, part: usize, section: usize) -> Result<Self::Coder, Fault>;

    /// The bytes that it wrote, if it did.
    fn close(&self, part: usize, coder: Self::Coder) -> Result<Vec<u8>, Fault>;
}

/// A part of a frame, section after section: tables of no more than one of them are in memory.
pub(super) struct Part<'a, D: Direction> {
    direction: &'a D,
    number: usize,
    coder: D::Coder,
    /// Bytes of the sections before this one.
    bytes: Vec<Vec<u8>>,
}

impl<'a, D: Direction> Part<'a, D> {
    pub(super) fn open(direction: &'a D, part: usize) -> Result<Self, Fault> {
        Ok(Self {
            direction,
            number: part,
            coder: direction.open(part, 0)?,
            bytes: Vec::new(),
        })
    }

    /// Its coder in a section, none before the last one requested.
    pub(super) fn at(&mut self, section: usize) -> Result<&mut D::Coder, Fault> {
        while self.bytes.len() < section {
            let next = self.direction.open(self.number, self.bytes.len() + 1)?;
            let coder = std::mem::replace(&mut self.coder, next);
            self.bytes.push(self.direction.close(self.number, coder)?);
        }
        Ok(&mut self.coder)
    }

    /// Returns the bytes written in each section.
    pub(super) fn close(mut self) -> Result<Vec<Vec<u8>>, Fault> {
        self.bytes.push(self.direction.close(self.number, self.coder)?);
        Ok(self.bytes)
    }
}
