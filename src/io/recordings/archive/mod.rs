//! ZIP and TAR archives of frames, and single files packed with gzip.
//!
//! The directory is read once, by `zip` and `tar`; each [`Member`] then knows where its bytes are, so that one is read
//! without the others. Nothing is ever unpacked to disk: names in an archive are for display, not paths. A compressed
//! TAR offers no random access, so it is unpacked once into memory that its members share.

mod member;
mod refusal;
mod tar;
mod zip;

pub use member::Member;

use super::containers;
use crate::io::contents::{Contents, Entry, Part};
use crate::io::error::{Fault, IoError, Place};
use crate::io::files::timestamps;
use crate::io::files::unpack::{Packing, reader, unpack, unpack_gzip};
use crate::io::files::watched::Watched;
use crate::io::format::Format;
use crate::io::formats::xyz;
use crate::io::options::ReadOptions;
use crate::natural::natural_order;
use crate::progress::Progress;
use member::{MemberPlace, Unpacked, clean};
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tar::Listed;

/// The frames in the archive at `path`, in natural order of their names.
pub(in crate::io) fn list(path: &Path, format: Format, options: &ReadOptions) -> Result<Contents, IoError> {
    refusal::check_name(path)?;
    let failed = io_error(path);
    let mut file = File::open(path).map_err(failed)?;
    let invalid = |fault: Fault| fault.of(path, format);
    let mut magic = [0; 2];
    let is_gzip = file.read(&mut magic).map_err(failed)? == 2 && magic == *b"\x1f\x8b";
    file.rewind().map_err(failed)?;
    let Listed { mut members, damage } = if format == containers::ZIP {
        Listed {
            members: zip::members(file).map_err(invalid)?,
            damage: None,
        }
    } else if is_gzip {
        // Its content is detected from the first unpacked bytes.
        let mut start = Vec::with_capacity(tar::BLOCK_BYTES);
        let unpacked = reader(Packing::Gzip, &mut file)
            .and_then(|packed| packed.take(tar::BLOCK_BYTES as u64).read_to_end(&mut start));
        if unpacked.is_err() && start.is_empty() {
            return Err(invalid(Fault::new(
                Place::Byte(0),
                "this is not a gzip stream, or it ends before its first byte: it is damaged",
            )));
        }
        if !tar::is_header(&start) {
            return Ok(Contents::of_entries(vec![Entry {
                name: String::new(),
                time: None,
                part: Part::Member(Member {
                    name: clean(&path.file_stem().unwrap_or_default().to_string_lossy()),
                    place: MemberPlace::Gzip,
                }),
            }]));
        }
        let bytes =
            unpack_gzip(file, options).map_err(|problem| invalid(Fault::header(format!("the archive: {problem}"))))?;
        tar::members_of_memory(&Unpacked(Arc::new(bytes))).map_err(invalid)?
    } else {
        tar::members_of_file(file).map_err(invalid)?
    };
    let all = members.clone();
    members.retain(|member| is_frame(path, member));
    let is_text = |member: &Member| Format::of_extension(Path::new(&member.name)) == Some(xyz::FORMAT);
    // Text next to clouds of other formats is about them: README.txt, poses.txt.
    if members.iter().all(is_text) {
        refusal::check(path, &all)?;
    } else {
        members.retain(|member| !is_text(member));
    }
    if members.is_empty() {
        return Ok(Contents {
            without_frames: refusal::describe(&all),
            damage: damage.into_iter().collect(),
            ..Contents::default()
        });
    }
    members.sort_by(|left, right| natural_order(Path::new(&left.name), Path::new(&right.name)));
    let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
    let times = timestamps::times_of_names(&names);
    let entries = members.into_iter().zip(times).map(|(member, time)| Entry {
        name: member.name.clone(),
        time,
        part: Part::Member(member),
    });
    Ok(Contents {
        damage: damage.into_iter().collect(),
        ..Contents::of_entries(entries.collect())
    })
}

/// Reads a member: its name (the archive's path and the member's within it) and bytes; `progress` reports the
/// compressed ones.
pub(in crate::io) fn read(
    path: &Path,
    member: &Member,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<(PathBuf, Vec<u8>), IoError> {
    let failed = io_error(path);
    let name = path.join(&member.name);
    let format = match member.place {
        MemberPlace::Packed { crc: Some(_), .. } => containers::ZIP,
        _ => containers::TAR,
    };
    let invalid = |offset: u64, problem: String| Fault::new(Place::Byte(offset as usize), problem).of(&name, format);
    let bytes = match &member.place {
        &MemberPlace::Packed {
            offset,
            packed_bytes,
            unpacked_bytes,
            packing,
            crc,
        } => {
            let mut file = File::open(path).map_err(failed)?;
            file.seek(SeekFrom::Start(offset)).map_err(failed)?;
            progress.set(0, packed_bytes as usize);
            let packed = Watched {
                reader: file.take(packed_bytes),
                progress,
            };
            let bytes = unpack(packing, packed, unpacked_bytes, options).map_err(|problem| invalid(offset, problem))?;
            if crc.is_some_and(|crc| crc32fast::hash(&bytes) != crc) {
                return Err(invalid(
                    offset,
                    "its checksum is not the one in the archive: it is damaged".to_owned(),
                ));
            }
            bytes
        }
        MemberPlace::Memory(unpacked, range) => match unpacked.0.get(range.clone()) {
            Some(bytes) => {
                let claim = options.holding(unpacked.0.capacity());
                let claim = claim.claim("the member", bytes.len() as u64);
                claim.map_err(|fault| invalid(range.start as u64, fault.problem))?;
                bytes.to_vec()
            }
            None => {
                return Err(invalid(
                    range.start as u64,
                    format!(
                        "it should have {} bytes, but the archive ends at byte {}: the archive is truncated",
                        range.len(),
                        unpacked.0.len()
                    ),
                ));
            }
        },
        MemberPlace::Gzip => {
            let file = File::open(path).map_err(failed)?;
            progress.set(0, file.metadata().map_err(failed)?.len() as usize);
            let packed = Watched { reader: file, progress };
            unpack_gzip(packed, options).map_err(|problem| invalid(0, problem))?
        }
        MemberPlace::Unreadable(problem) => return Err(invalid(0, problem.clone())),
    };
    progress.set(0, 0);
    Ok((name, bytes))
}

fn io_error(path: &Path) -> impl Fn(std::io::Error) -> IoError + Copy {
    move |source| IoError::Io {
        path: path.to_owned(),
        source,
    }
}

/// True for files that hold a frame: in a format of single clouds by its extension, or else by its first bytes; not
/// hidden, not added by macOS.
fn is_frame(path: &Path, member: &Member) -> bool {
    let is_skipped = |part: &str| part.starts_with('.') || part == "__MACOSX";
    if member.name.split('/').any(is_skipped) {
        return false;
    }
    let name = Path::new(&member.name);
    let format =
        Format::of_extension(name).or_else(|| Format::detect(name, &first_bytes(path, member).unwrap_or_default()));
    format.is_some_and(|format| !format.is_container())
}

/// Returns the first bytes of a member; none of it where it cannot be read.
fn first_bytes(path: &Path, member: &Member) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match &member.place {
        MemberPlace::Memory(unpacked, range) => {
            let end = range.end.min(range.start.saturating_add(Format::MAGIC_BYTES));
            bytes.extend(unpacked.0.get(range.start..end).unwrap_or_default());
        }
        &MemberPlace::Packed {
            offset,
            packed_bytes,
            packing,
            ..
        } => {
            let mut file = File::open(path)?;
            file.seek(SeekFrom::Start(offset))?;
            reader(packing, file.take(packed_bytes))?
                .take(Format::MAGIC_BYTES as u64)
                .read_to_end(&mut bytes)?;
        }
        MemberPlace::Gzip | MemberPlace::Unreadable(_) => {}
    }
    Ok(bytes)
}
