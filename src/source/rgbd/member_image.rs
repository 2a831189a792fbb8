//! Images in the archives of `Record3D`: colours as files have them, depths as floats that are packed by LZFSE.

use super::error::RgbdError;
use crate::io::ReadOptions;
use crate::raster::{self, Raster, Samples};
use lzfse_rust::LzfseRingDecoder;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::sync::Arc;
use zip::ZipArchive;

/// An image in an archive.
#[derive(Debug, Clone)]
pub(super) struct MemberImage {
    pub(super) path: Arc<Path>,
    pub(super) name: String,
    /// Size of depth images, whose data does not contain it; `None` for images in ordinary file formats.
    pub(super) depth_px: Option<[u32; 2]>,
}

impl MemberImage {
    /// Its pixels.
    pub(super) fn raster(&self, options: &ReadOptions) -> Result<Raster, RgbdError> {
        let max_bytes = options.max_memory_bytes;
        let wrong = |reason: String| RgbdError::Image {
            path: self.path.join(&self.name),
            reason,
        };
        let bytes = member(&mut archive(&self.path)?, &self.path, &self.name, max_bytes)?;
        match self.depth_px {
            None => raster::decode(&bytes, max_bytes).map_err(wrong),
            Some(size_px) => Ok(Raster {
                size_px,
                samples: Samples::GrayF32(depths(&bytes, pixels(size_px)).map_err(wrong)?),
            }),
        }
    }

    /// Width and height.
    pub(super) fn size_px(&self, options: &ReadOptions) -> Option<[u32; 2]> {
        if self.depth_px.is_some() {
            return self.depth_px;
        }
        let bytes = member(
            &mut archive(&self.path).ok()?,
            &self.path,
            &self.name,
            options.max_memory_bytes,
        )
        .ok()?;
        raster::size_px(&bytes).ok()
    }
}

pub(super) fn archive(path: &Path) -> Result<ZipArchive<BufReader<File>>, RgbdError> {
    let unreadable = |reason| RgbdError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let file = File::open(path).map_err(unreadable)?;
    ZipArchive::new(BufReader::new(file)).map_err(|error| RgbdError::Image {
        path: path.to_owned(),
        reason: format!("the archive is not understood ({error})"),
    })
}

/// The unpacked file `name` of an archive, of at most `max_bytes`.
pub(super) fn member(
    archive: &mut ZipArchive<BufReader<File>>,
    path: &Path,
    name: &str,
    max_bytes: u64,
) -> Result<Vec<u8>, RgbdError> {
    let wrong = |reason: String| RgbdError::Image {
        path: path.join(name),
        reason,
    };
    let member = archive.by_name(name).map_err(|error| wrong(error.to_string()))?;
    let mut bytes = Vec::new();
    member
        .take(max_bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| wrong(error.to_string()))?;
    if bytes.len() as u64 > max_bytes {
        return Err(RgbdError::TooLarge {
            path: path.join(name),
            bytes: bytes.len() as u64,
            max_bytes,
        });
    }
    Ok(bytes)
}

pub(super) fn pixels([width, height]: [u32; 2]) -> usize {
    width as usize * height as usize
}

/// `count` floats packed by LZFSE. No more are unpacked, whatever the bytes claim.
fn depths(bytes: &[u8], count: usize) -> Result<Vec<f32>, String> {
    let unpacked = unpacked(bytes, 4 * count as u64 + 1)?;
    if unpacked.len() != 4 * count {
        let more = if unpacked.len() > 4 * count { "more than " } else { "" };
        let found = unpacked.len().min(4 * count) / 4;
        return Err(format!("it has {more}{found} depths, and its size is {count} pixels"));
    }
    let floats = unpacked.as_chunks::<4>().0.iter();
    Ok(floats.map(|&bytes| f32::from_le_bytes(bytes)).collect())
}

pub(super) fn unpacked(bytes: &[u8], max_bytes: u64) -> Result<Vec<u8>, String> {
    let mut decoder = LzfseRingDecoder::default();
    let mut unpacked = Vec::new();
    let read = decoder.reader_bytes(bytes).take(max_bytes).read_to_end(&mut unpacked);
    read.map_err(|error| format!("it is not packed by LZFSE, or damaged ({error})"))?;
    Ok(unpacked)
}
