//! The headers of a TAR archive.

use super::member::{Member, MemberPlace, Unpacked, clean};
use crate::io::error::Fault;
use crate::io::files::unpack::Packing;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};

/// Size of a header.
pub(super) const BLOCK_BYTES: usize = 512;

/// Contents of an archive.
#[derive(Debug)]
pub(super) struct Listed {
    /// All files.
    pub(super) members: Vec<Member>,
    /// Damage: the position at which the archive is truncated, if it is.
    pub(super) damage: Option<String>,
}

/// All files in an archive that is not compressed.
pub(super) fn members_of_file(file: File) -> Result<Listed, Fault> {
    members(BufReader::new(file), |offset, size| MemberPlace::Packed {
        offset,
        packed_bytes: size,
        unpacked_bytes: size,
        packing: Packing::Stored,
        crc: None,
    })
}

/// All files in an archive that was.
pub(super) fn members_of_memory(unpacked: &Unpacked) -> Result<Listed, Fault> {
    members(Cursor::new(unpacked.0.as_slice()), |offset, size| {
        let end = offset.saturating_add(size);
        MemberPlace::Memory(unpacked.clone(), offset as usize..end as usize)
    })
}

fn members(mut reader: impl Read + Seek, place: impl Fn(u64, u64) -> MemberPlace) -> Result<Listed, Fault> {
    let broken =
        |error: &std::io::Error| format!("the archive is not understood ({error}): it is truncated or damaged");
    let length = reader
        .seek(SeekFrom::End(0))
        .and_then(|length| reader.rewind().map(|()| length));
    let length = length.map_err(|error| Fault::header(broken(&error)))?;
    let mut archive = tar::Archive::new(reader);
    let mut members = Vec::new();
    // End of the last member, including the padding of its last block.
    let mut end = 0;
    let mut damage = None;
    let entries = archive
        .entries_with_seek()
        .map_err(|error| Fault::header(broken(&error)))?;
    for entry in entries {
        let entry = match entry {
            Ok(entry) => entry,
            // Members before the damage can be read.
            Err(error) if !members.is_empty() => {
                damage = Some(format!(
                    "{}; the {} files before that are read",
                    broken(&error),
                    members.len()
                ));
                break;
            }
            Err(error) => return Err(Fault::header(broken(&error))),
        };
        let begin = entry.raw_file_position();
        end = begin.saturating_add(entry.size().next_multiple_of(BLOCK_BYTES as u64));
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
    if damage.is_none() && end.saturating_add(BLOCK_BYTES as u64) > length {
        damage = Some(format!(
            "the archive ends at byte {length} without its end mark: it was cut, and the {} files before that are read",
            members.len()
        ));
    }
    Ok(Listed { members, damage })
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
    // The checksum field itself counts as spaces.
    let sum: u32 = (0..BLOCK_BYTES)
        .map(|at| u32::from(if SUM.contains(&at) { b' ' } else { block[at] }))
        .sum();
    let written = std::str::from_utf8(&block[SUM])
        .ok()
        .and_then(|text| u32::from_str_radix(text.trim_matches(['\0', ' ']), 8).ok());
    written == Some(sum) && block[0] != 0
}
