//! The headers of a TAR archive.

use super::super::error::Fault;
use super::super::unpack::Packing;
use super::member::{Member, MemberPlace, Unpacked, clean};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};

/// Size of a header.
pub(super) const BLOCK_BYTES: usize = 512;

/// All files in an archive that is not compressed.
pub(super) fn members_of_file(file: File) -> Result<Vec<Member>, Fault> {
    members(BufReader::new(file), |offset, size| MemberPlace::Packed {
        offset,
        packed_bytes: size,
        unpacked_bytes: size,
        packing: Packing::Stored,
        crc: None,
    })
}

/// All files in an archive that was.
pub(super) fn members_of_memory(unpacked: &Unpacked) -> Result<Vec<Member>, Fault> {
    members(Cursor::new(unpacked.0.as_slice()), |offset, size| {
        let end = offset.saturating_add(size);
        MemberPlace::Memory(unpacked.clone(), offset as usize..end as usize)
    })
}

fn members(reader: impl Read + Seek, place: impl Fn(u64, u64) -> MemberPlace) -> Result<Vec<Member>, Fault> {
    let broken =
        |error: &std::io::Error| format!("the archive is not understood ({error}): it is truncated or damaged");
    let mut archive = tar::Archive::new(reader);
    let mut members = Vec::new();
    let entries = archive
        .entries_with_seek()
        .map_err(|error| Fault::header(broken(&error)))?;
    for entry in entries {
        let entry = match entry {
            Ok(entry) => entry,
            // What came before the damage can be read.
            Err(error) if !members.is_empty() => {
                log::warn!("{}; what lies before is read", broken(&error));
                break;
            }
            Err(error) => return Err(Fault::header(broken(&error))),
        };
        let kind = entry.header().entry_type();
        let place = if kind.is_file() || kind.is_contiguous() {
            place(entry.raw_file_position(), entry.size())
        } else if kind.is_gnu_sparse() {
            MemberPlace::Unreadable("it is a sparse file, which is not read: unpack the archive".to_owned())
        } else {
            continue;
        };
        members.push(Member {
            name: clean(&String::from_utf8_lossy(&entry.path_bytes())),
            place,
        });
    }
    Ok(members)
}

/// True when `block` is the header of a member: of this format for sure, or by the sum of its bytes as before 1988.
pub(super) fn is_header(block: &[u8]) -> bool {
    const MAGIC: std::ops::Range<usize> = 257..262;
    const SUM: std::ops::Range<usize> = 148..156;
    if block.len() < BLOCK_BYTES {
        return false;
    }
    if &block[MAGIC] == b"ustar" {
        return true;
    }
    // The sum itself counts as spaces.
    let sum: u32 = (0..BLOCK_BYTES)
        .map(|at| u32::from(if SUM.contains(&at) { b' ' } else { block[at] }))
        .sum();
    let written = std::str::from_utf8(&block[SUM])
        .ok()
        .and_then(|text| u32::from_str_radix(text.trim_matches(['\0', ' ']), 8).ok());
    written == Some(sum) && block[0] != 0
}
