//! Decompression, limited to the claimed and the allowed size.
//!
//! The claim of a file is checked against the limit before anything is unpacked, and its memory is allocated at once:
//! lists that double as bytes come would take up to three times as much. A bomb ends at the byte behind its claim.

use crate::io::options::ReadOptions;
use crate::memory;
use std::io::{self, Read, Seek, SeekFrom};

/// Compression of the bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Packing {
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
pub(in crate::io) fn reader<'a>(packing: Packing, packed: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
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

/// Unpacks a stream that claims `claimed_bytes`; the error is a sentence without position.
pub(in crate::io) fn unpack(
    packing: Packing,
    packed: impl Read,
    claimed_bytes: u64,
    options: &ReadOptions,
) -> Result<Vec<u8>, String> {
    if claimed_bytes > options.left_bytes() {
        return Err(too_large(claimed_bytes, options));
    }
    let Drained { bytes, has_more } = drain(packing, packed, claimed_bytes)?;
    if has_more || bytes.len() as u64 != claimed_bytes {
        let min = if has_more { "more than" } else { "only" };
        return Err(format!(
            "it unpacks to {min} {} bytes, expected {claimed_bytes}: it is damaged",
            bytes.len()
        ));
    }
    Ok(bytes)
}

/// Unpacks all gzip streams of `packed`, whose size is only in their last bytes.
///
/// Those bytes are tried first. Where there are several streams, or more than 4 GiB, all is unpacked once to count it:
/// a list that doubles until it is large enough would take twice the unpacked size.
pub(in crate::io) fn unpack_gzip(mut packed: impl Read + Seek, options: &ReadOptions) -> Result<Vec<u8>, String> {
    let limit_bytes = options.left_bytes();
    let claimed_bytes = claim_of_gzip(&mut packed).map_err(failed)?;
    if claimed_bytes <= limit_bytes {
        let Drained { bytes, has_more } = drain(Packing::Gzip, &mut packed, claimed_bytes)?;
        if !has_more {
            return Ok(bytes);
        }
    }
    packed.rewind().map_err(failed)?;
    let counted = reader(Packing::Gzip, &mut packed).map_err(failed)?;
    let mut counted = counted.take(limit_bytes.saturating_add(1));
    let count = io::copy(&mut counted, &mut io::sink()).map_err(failed)?;
    drop(counted);
    if count > limit_bytes {
        return Err(too_large(count, options));
    }
    packed.rewind().map_err(failed)?;
    Ok(drain(Packing::Gzip, packed, count)?.bytes)
}

/// Bytes of the last stream by its trailer (RFC 1952), but no more than its packed bytes can unpack to.
fn claim_of_gzip(packed: &mut (impl Read + Seek)) -> io::Result<u64> {
    const TRAILER_BYTES: u64 = 4;
    /// A bit for 258 bytes, with its distance.
    const MAX_DEFLATED: u64 = 1032;
    let length = packed.seek(SeekFrom::End(0))?;
    let mut claim = [0; TRAILER_BYTES as usize];
    if length >= TRAILER_BYTES {
        packed.seek(SeekFrom::Start(length - TRAILER_BYTES))?;
        packed.read_exact(&mut claim)?;
    }
    packed.rewind()?;
    Ok(u64::from(u32::from_le_bytes(claim)).min(length.saturating_mul(MAX_DEFLATED)))
}

/// Result of decompression.
struct Drained {
    bytes: Vec<u8>,
    /// There is more of it.
    has_more: bool,
}

/// At most `expected_bytes`, in one allocation of that. Precondition: there is memory for them.
fn drain(packing: Packing, packed: impl Read, expected_bytes: u64) -> Result<Drained, String> {
    let mut bytes = Vec::new();
    let expected = usize::try_from(expected_bytes).unwrap_or(usize::MAX);
    // Reserved memory costs nothing until it is written to.
    memory::try_reserve(&mut bytes, expected).map_err(|error| failed(io::Error::other(error)))?;
    let mut unpacked = reader(packing, packed).map_err(failed)?;
    let read = unpacked.by_ref().take(expected_bytes).read_to_end(&mut bytes);
    read.map_err(failed)?;
    // Checksums follow the last byte, and are only verified when reading past it.
    let has_more = bytes.len() == expected && read_some(&mut unpacked, &mut [0]).map_err(failed)? > 0;
    Ok(Drained { bytes, has_more })
}

fn read_some(reader: &mut impl Read, bytes: &mut [u8]) -> io::Result<usize> {
    loop {
        match reader.read(bytes) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

#[expect(clippy::needless_pass_by_value, reason = "it is what errors are mapped by")]
fn failed(error: io::Error) -> String {
    format!("it cannot be unpacked ({error}): it is damaged")
}

fn too_large(needed: u64, options: &ReadOptions) -> String {
    crate::io::error::Fault::too_large("it", needed, options).problem
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write as _};

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packed.write_all(bytes).unwrap();
        packed.finish().unwrap()
    }

    #[test]
    fn gzip_streams_allocate_their_length_and_at_most_the_limit() {
        let options = ReadOptions::default().with_max_memory(5000);
        let one = gzip(&[7; 3000]);
        let unpacked = unpack_gzip(Cursor::new(&one), &options).unwrap();
        assert_eq!((unpacked.len(), unpacked.capacity()), (3000, 3000));
        // The trailer only describes the second stream.
        let two = [one.as_slice(), &gzip(&[8; 1500])].concat();
        let unpacked = unpack_gzip(Cursor::new(&two), &options).unwrap();
        assert_eq!((unpacked.len(), unpacked.capacity()), (4500, 4500));
        let refused = unpack_gzip(Cursor::new(&two), &options.holding(1000)).unwrap_err();
        assert!(refused.contains("--max-memory"), "{refused}");
        let mut damaged = one.clone();
        let end = damaged.len();
        damaged[end - 1] ^= 0x40;
        assert!(
            unpack_gzip(Cursor::new(&damaged), &options)
                .unwrap_err()
                .contains("damaged")
        );
        assert!(unpack_gzip(Cursor::new(&one[..end - 9]), &options).is_err());
        assert!(unpack_gzip(Cursor::new(b"\x1f"), &options).is_err());
    }

    #[test]
    fn data_that_unpacks_to_more_than_declared_is_rejected() {
        let options = ReadOptions::default().with_max_memory(5000);
        let unpack = |claimed: u64| unpack(Packing::Gzip, gzip(&[7; 3000]).as_slice(), claimed, &options);
        assert_eq!(unpack(3000).unwrap().len(), 3000);
        assert!(unpack(2999).unwrap_err().contains("more than 2999"));
        assert!(unpack(3001).unwrap_err().contains("only 3000"));
        assert!(unpack(5001).unwrap_err().contains("--max-memory"));
    }
}
