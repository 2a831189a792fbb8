//! Packed bytes to plain ones, never more than was claimed and is allowed.
//!
//! What a file claims is held against the limit before anything is unpacked; memory then grows with what really comes
//! out, so that neither a false claim nor a bomb takes more than it is allowed to.

use super::options::ReadOptions;
use std::io::{self, Read};

/// How bytes are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    /// As they are.
    Stored,
    /// Deflate without header (ZIP).
    Deflate,
    /// Gzip, one or more streams.
    Gzip,
    /// Zstandard.
    Zstd,
    /// LZ4 frames.
    Lz4,
    /// Bzip2, one or more streams.
    Bzip2,
}

/// Windows of 128 MiB are the largest that `zstd` itself unpacks unasked.
const ZSTD_WINDOW_LOG_MAX: u32 = 27;

/// The bytes that come out of `packed`.
pub(super) fn reader<'a>(packing: Packing, packed: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
    Ok(match packing {
        Packing::Stored => Box::new(packed),
        Packing::Deflate => Box::new(flate2::read::DeflateDecoder::new(packed)),
        Packing::Gzip => Box::new(flate2::read::MultiGzDecoder::new(packed)),
        Packing::Zstd => {
            let mut decoder = zstd::Decoder::new(packed)?;
            decoder.window_log_max(ZSTD_WINDOW_LOG_MAX)?;
            Box::new(decoder)
        }
        Packing::Lz4 => Box::new(lz4_flex::frame::FrameDecoder::new(packed)),
        Packing::Bzip2 => Box::new(bzip2::read::MultiBzDecoder::new(packed)),
    })
}

/// Unpacks what claims to be `claimed_bytes`; the error is a sentence without its place.
pub(super) fn unpack(
    packing: Packing,
    packed: impl Read,
    claimed_bytes: u64,
    options: &ReadOptions,
) -> Result<Vec<u8>, String> {
    if claimed_bytes > options.max_memory_bytes {
        return Err(too_large(claimed_bytes, options));
    }
    let bytes = drain(packing, packed, claimed_bytes)?;
    if bytes.len() as u64 != claimed_bytes {
        return Err(format!(
            "it unpacks to {} {} bytes, expected {claimed_bytes}: it is damaged",
            if bytes.len() as u64 > claimed_bytes {
                "more than"
            } else {
                "only"
            },
            (bytes.len() as u64).min(claimed_bytes)
        ));
    }
    Ok(bytes)
}

/// Unpacks what does not say how much it is.
pub(super) fn unpack_unknown(packing: Packing, packed: impl Read, options: &ReadOptions) -> Result<Vec<u8>, String> {
    let bytes = drain(packing, packed, options.max_memory_bytes)?;
    if bytes.len() as u64 > options.max_memory_bytes {
        return Err(too_large(bytes.len() as u64, options));
    }
    Ok(bytes)
}

/// At most one byte more than `limit_bytes`.
fn drain(packing: Packing, packed: impl Read, limit_bytes: u64) -> Result<Vec<u8>, String> {
    let failed = |error: io::Error| format!("it cannot be unpacked ({error}): it is damaged");
    let mut bytes = Vec::new();
    reader(packing, packed)
        .map_err(failed)?
        .take(limit_bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    Ok(bytes)
}

fn too_large(needed: u64, options: &ReadOptions) -> String {
    super::error::Fault::too_large("it", needed, options).problem
}
