//! Repairs that get a changed file past the first check: correct checksums and lengths, as an attacker would write.
//! Each repair leaves an unchanged file as it is.

mod archives;
mod chunks;
mod reel;

use crate::random::Random;

/// A checksum, or a length that others are compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Repair {
    Nothing,
    Reel,
    /// Messages of a live stream.
    Stream,
    /// Pages of E57.
    E57,
    Png,
    Gltf,
    Mcap,
    PcapNg,
    Tar,
    Zip,
    Gzip,
}

/// Makes `bytes` right again, mostly: that a wrong checksum is refused is to be tried as well.
pub(crate) fn repair(kind: Repair, bytes: &mut Vec<u8>, random: &mut Random) {
    if random.one_in(16) {
        return;
    }
    if kind == Repair::Reel && random.one_in(3) {
        // Without an index, groups need not agree with it.
        reel::drop_index(bytes);
    }
    // Without this, a wrong checksum would be all that is ever found.
    repair_all(kind, bytes);
}

/// Makes all of `bytes` right again.
pub(crate) fn repair_all(kind: Repair, bytes: &mut [u8]) {
    match kind {
        Repair::Nothing => {}
        Repair::Reel => reel::repair(bytes),
        Repair::Stream => chunks::repair_stream(bytes),
        Repair::E57 => chunks::repair_e57(bytes),
        Repair::Png => chunks::repair_png(bytes),
        Repair::Gltf => chunks::repair_glb(bytes),
        Repair::Mcap => chunks::repair_mcap(bytes),
        Repair::PcapNg => chunks::repair_pcapng(bytes),
        Repair::Tar => archives::repair_tar(bytes),
        Repair::Zip => archives::repair_zip(bytes),
        Repair::Gzip => archives::repair_gzip(bytes),
    }
}

/// Four bytes of `bytes` as a number, lowest first.
fn u32_at(bytes: &[u8], place: usize) -> Option<u32> {
    let field = bytes.get(place..place.checked_add(4)?)?;
    Some(u32::from_le_bytes(field.try_into().ok()?))
}

fn u16_at(bytes: &[u8], place: usize) -> Option<usize> {
    let field = bytes.get(place..place.checked_add(2)?)?;
    Some(usize::from(u16::from_le_bytes(field.try_into().ok()?)))
}

/// Eight bytes of `bytes` as a number, lowest first; `usize::MAX` if it does not fit.
fn u64_at(bytes: &[u8], place: usize) -> Option<usize> {
    let field = bytes.get(place..place.checked_add(8)?)?;
    Some(usize::try_from(u64::from_le_bytes(field.try_into().ok()?)).unwrap_or(usize::MAX))
}

/// Writes `field` at `place`, if there is space.
fn put(bytes: &mut [u8], place: usize, field: &[u8]) {
    if let Some(there) = bytes.get_mut(place..).and_then(|rest| rest.get_mut(..field.len())) {
        there.copy_from_slice(field);
    }
}
