//! The directory of a ZIP archive.

use super::member::{Member, MemberPlace, clean};
use crate::io::error::Fault;
use crate::io::files::unpack::Packing;
use std::fs::File;
use zip::{CompressionMethod, ZipArchive};

/// All files in the archive.
pub(super) fn members(file: File) -> Result<Vec<Member>, Fault> {
    let mut archive = ZipArchive::new(std::io::BufReader::new(file)).map_err(|error| {
        Fault::header(format!(
            "the directory of the archive is not understood ({error}): the file is truncated or damaged"
        ))
    })?;
    let mut members = Vec::new();
    for index in 0..archive.len() {
        let raw_name = match archive.name_for_index(index) {
            Some(Ok(name)) => name.into_owned(),
            _ => continue,
        };
        if raw_name.ends_with(['/', '\\']) {
            continue;
        }
        // Members are only located: each is read without the others, and nothing is unpacked to disk.
        let place = match archive.by_index_raw(index) {
            Ok(found) => place(&found),
            Err(error) => MemberPlace::Unreadable(format!("its header is not understood ({error}): it is damaged")),
        };
        members.push(Member {
            name: clean(&raw_name),
            place,
        });
    }
    Ok(members)
}

fn place(found: &zip::read::ZipFile<'_, std::io::BufReader<File>>) -> MemberPlace {
    if found.encrypted() {
        return MemberPlace::Unreadable(
            "it is encrypted, which is not read: unpack the archive with its password".to_owned(),
        );
    }
    let packing = match found.compression() {
        CompressionMethod::Stored => Packing::Stored,
        CompressionMethod::Deflated => Packing::Deflate,
        CompressionMethod::Zstd => Packing::Zstd,
        other => {
            return MemberPlace::Unreadable(format!(
                "it is compressed with {other}, expected deflate, zstd or none: compress it again"
            ));
        }
    };
    let Some(offset) = found.data_start() else {
        return MemberPlace::Unreadable("its data is not found: it is damaged".to_owned());
    };
    MemberPlace::Packed {
        offset,
        packed_bytes: found.compressed_size(),
        unpacked_bytes: found.size(),
        packing,
        crc: Some(found.crc32()),
    }
}
