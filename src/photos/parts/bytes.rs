//! Numbers of a binary file, little-endian, and claimed counts checked against the bytes left in it.

use crate::photos::error::PhotosError;
use std::path::Path;

/// A place in the bytes of a file.
#[derive(Debug)]
pub(in crate::photos) struct Bytes<'a> {
    path: &'a Path,
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    /// `all`, which is the content of the file `path`.
    pub(in crate::photos) fn new(path: &'a Path, all: &'a [u8]) -> Self {
        Self { path, all, at: 0 }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], PhotosError> {
        let Some(bytes) = self.all[self.at..].first_chunk::<N>() else {
            return Err(self.error(format!(
                "the file ends where {N} bytes were expected: it may have been cut"
            )));
        };
        self.at += N;
        Ok(*bytes)
    }

    pub(in crate::photos) fn u8(&mut self) -> Result<u8, PhotosError> {
        self.array().map(u8::from_le_bytes)
    }

    pub(in crate::photos) fn u32(&mut self) -> Result<u32, PhotosError> {
        self.array().map(u32::from_le_bytes)
    }

    pub(in crate::photos) fn u64(&mut self) -> Result<u64, PhotosError> {
        self.array().map(u64::from_le_bytes)
    }

    pub(in crate::photos) fn f32(&mut self) -> Result<f32, PhotosError> {
        self.array().map(f32::from_le_bytes)
    }

    pub(in crate::photos) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], PhotosError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.array()?);
        }
        Ok(numbers)
    }

    /// A number of `what`, each of which takes at least `min_bytes`.
    pub(in crate::photos) fn count(&mut self, what: &str, min_bytes: usize) -> Result<u64, PhotosError> {
        let start = self.at;
        let count = self.u64()?;
        let space = (self.all.len() - self.at) / min_bytes;
        if count > space as u64 {
            self.at = start;
            return Err(self.error(format!(
                "{count} {what} are claimed, and the file has room for {space} at most: it was cut, or is none of these"
            )));
        }
        Ok(count)
    }

    /// Characters up to a zero.
    pub(in crate::photos) fn name(&mut self) -> Result<String, PhotosError> {
        let rest = &self.all[self.at..];
        let Some(length) = rest.iter().position(|&byte| byte == 0) else {
            return Err(self.error("a name without an end: the file may have been cut"));
        };
        self.at += length + 1;
        Ok(String::from_utf8_lossy(&rest[..length]).into_owned())
    }

    /// Creates an error for the problem at this position.
    pub(in crate::photos) fn error(&self, problem: impl Into<String>) -> PhotosError {
        PhotosError::invalid(self.path, format!("byte {}", self.at), problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_checked_against_the_remaining_bytes() {
        let mut all = 3_u64.to_le_bytes().to_vec();
        all.extend([0; 24]);
        let path = Path::new("images.bin");
        assert_eq!(Bytes::new(path, &all).count("images", 8).unwrap(), 3);
        let error = Bytes::new(path, &all).count("images", 9).unwrap_err().to_string();
        assert!(error.starts_with("images.bin, byte 0: 3 images are claimed, and the file has room for 2"));
        all[7] = 0xff;
        assert!(Bytes::new(path, &all).count("images", 1).is_err());
    }

    #[test]
    fn names_are_zero_terminated() {
        let mut bytes = Bytes::new(Path::new("a"), b"one\0two");
        assert_eq!(bytes.name().unwrap(), "one");
        assert!(bytes.name().is_err() && bytes.u64().is_err() && bytes.u8().is_ok());
    }
}
