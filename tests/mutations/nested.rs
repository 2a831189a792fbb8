//! Files within files: the contents are changed before they are packed, since hardly any change of packed bytes can be
//! unpacked.

use crate::kinds::{Kind, kind_of};
use crate::mutate::{Shape, mutate};
use crate::random::Random;
use crate::repair::{Repair, repair, repair_all};
use std::io::{Cursor, Read as _, Write as _};

/// No file is unpacked further than this.
const MAX_BYTES: u64 = 1 << 22;

/// Changes a file, and makes its checksums right again; `other` is another one of the same kind.
pub(crate) fn mutate_file(kind: Kind, bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let is_nested = !random.one_in(4);
    let changed = match kind.repair {
        Repair::Gzip if is_nested => in_gzip(kind, bytes, random),
        Repair::Zip if is_nested => in_zip(bytes, random),
        Repair::Gltf if is_nested => in_glb(bytes, random),
        _ => None,
    };
    if let Some(changed) = changed {
        *bytes = changed;
    } else {
        mutate(kind.shape, bytes, other, random);
        repair(kind.repair, bytes, random);
    }
}

fn in_gzip(kind: Kind, bytes: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let mut inner = Vec::new();
    let unpacking = flate2::read::GzDecoder::new(bytes).take(MAX_BYTES);
    { unpacking }.read_to_end(&mut inner).ok()?;
    let is_text = inner
        .iter()
        .take(64)
        .all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
    let shape = if is_text { Shape::TextHead } else { Shape::Binary };
    mutate(shape, &mut inner, &[], random);
    if kind.extension == "tgz" {
        repair_all(Repair::Tar, &mut inner);
    }
    let mut packing = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packing.write_all(&inner).ok()?;
    packing.finish().ok()
}

fn in_zip(bytes: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).ok()?;
    let changed = random.below(archive.len());
    let mut packing = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for place in 0..archive.len() {
        let mut member = archive.by_index(place).ok()?;
        let name = member.name().ok()?.into_owned();
        let mut inner = Vec::new();
        member.by_ref().take(MAX_BYTES).read_to_end(&mut inner).ok()?;
        if place == changed {
            let kind = kind_of("", &name);
            mutate(kind.shape, &mut inner, &[], random);
            repair(kind.repair, &mut inner, random);
        }
        let method = [zip::CompressionMethod::Stored, zip::CompressionMethod::Deflated][random.below(2)];
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        packing.start_file(name, options).ok()?;
        packing.write_all(&inner).ok()?;
    }
    Some(packing.finish().ok()?.into_inner())
}

/// The description, which defines the rest.
fn in_glb(bytes: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    const HEAD_BYTES: usize = 20;
    let count = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
    let mut json = bytes.get(HEAD_BYTES..HEAD_BYTES.checked_add(count)?)?.to_vec();
    let rest = &bytes[HEAD_BYTES + count..];
    mutate(Shape::Json, &mut json, &[], random);
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut head = bytes[..HEAD_BYTES].to_vec();
    head[12..16].copy_from_slice(&(json.len() as u32).to_le_bytes());
    let mut changed = [head, json, rest.to_vec()].concat();
    repair_all(Repair::Gltf, &mut changed);
    Some(changed)
}
