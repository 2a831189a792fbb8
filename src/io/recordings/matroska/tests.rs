//! Files by hand, element by element.

use super::found::MatroskaError;
use super::{Matroska, is_one};
use proptest::prelude::*;
use std::io::Write as _;

/// An element with its length in as few bytes as it takes, or in eight.
fn element(id: u32, body: &[u8], is_long: bool) -> Vec<u8> {
    let id: Vec<u8> = id.to_be_bytes().into_iter().skip_while(|&byte| byte == 0).collect();
    let count = body.len() as u64;
    let length = match count {
        _ if is_long => (count | 1 << 56).to_be_bytes().to_vec(),
        0..0x7f => vec![count as u8 | 0x80],
        0x7f..0x3fff => (count as u16 | 0x4000).to_be_bytes().to_vec(),
        _ => (count as u32 | 0x1000_0000).to_be_bytes().to_vec(),
    };
    [id, length, body.to_vec()].concat()
}

fn short(id: u32, body: &[u8]) -> Vec<u8> {
    element(id, body, false)
}

fn number(id: u32, value: u64) -> Vec<u8> {
    let bytes: Vec<u8> = value.to_be_bytes().into_iter().skip_while(|&byte| byte == 0).collect();
    short(id, &bytes)
}

/// The head of an element whose length is not known.
fn open(id: u32, length_bytes: usize) -> Vec<u8> {
    let length = match length_bytes {
        1 => vec![0xff],
        _ => vec![0x01, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
    };
    [id.to_be_bytes().to_vec(), length].concat()
}

fn header(kind: &str) -> Vec<u8> {
    short(0x1a45_dfa3, &short(0x4282, kind.as_bytes()))
}

fn tracks() -> Vec<u8> {
    let mut private = vec![0; 40];
    private[16..20].copy_from_slice(b"b16g");
    let video = [number(0xb0, 640), number(0xba, 576)].concat();
    let depth = [
        number(0xd7, 3),
        number(0x73c5, 0x1234_5678_9abc),
        short(0x536e, b"DEPTH\0\0"),
        short(0x86, b"V_MS/VFW/FOURCC"),
        short(0x63a2, &private),
        short(0xe0, &video),
    ];
    let packed = [number(0xd7, 200), short(0x86, b"S_TEXT"), short(0x6d80, &[])];
    let entries = [short(0xae, &depth.concat()), short(0xae, &packed.concat())];
    short(0x1654_ae6b, &entries.concat())
}

/// A block: the number of its track, a time, flags, and its data.
fn block(track: u8, time: i16, flags: u8, frame: &[u8]) -> Vec<u8> {
    [&[track | 0x80], time.to_be_bytes().as_slice(), &[flags], frame].concat()
}

const SIMPLE: u32 = 0xa3;

/// The elements before the clusters.
fn front() -> Vec<u8> {
    let tag = |name: &str, value: &str| {
        short(
            0x67c8,
            &[short(0x45a3, name.as_bytes()), short(0x4487, value.as_bytes())].concat(),
        )
    };
    let tags = [
        short(
            0x7373,
            &[short(0x63c0, &number(0x63c5, 3)), tag("MODE", "WIDE")].concat(),
        ),
        short(0x7373, &[tag("DELAY", "-5"), tag("EMPTY", "")].concat()),
    ];
    let file = [
        short(0x466e, b"calibration.json"),
        short(0x4660, b"application/octet-stream"),
        element(0x465c, b"{\"a\": 1}", true),
        number(0x46ae, 77),
    ];
    [
        short(0xec, &[0; 300]),
        short(0x1549_a966, &number(0x002a_d7b1, 1000)),
        tracks(),
        short(0x1941_a469, &short(0x61a7, &file.concat())),
        short(0x1254_c367, &tags.concat()),
    ]
    .concat()
}

/// Two clusters, the later frame first.
fn clusters() -> [Vec<u8>; 2] {
    let first = [
        number(0xe7, 50_000),
        short(SIMPLE, &block(3, -200, 0x80, b"late")),
        short(
            0xa0,
            &[number(0x9b, 7), short(0xa1, &block(3, 20, 0, b"later"))].concat(),
        ),
    ];
    let second = [
        number(0xe7, 0),
        short(SIMPLE, &block(3, 33, 0x80, b"early")),
        // Laces with one frame, and with three.
        short(SIMPLE, &block(3, 34, 0x86, b"\0laced")),
        short(SIMPLE, &block(3, 35, 0x82, b"\x02\x01\x01abc")),
        // A track that is not described anywhere.
        short(SIMPLE, &block(9, 0, 0x80, b"else")),
    ];
    [first.concat(), second.concat()]
}

/// The file with lengths or without.
fn file(are_known: bool) -> Vec<u8> {
    let [first, second] = clusters();
    if are_known {
        let clusters = [element(0x1f43_b675, &first, true), short(0x1f43_b675, &second)].concat();
        return [
            header("matroska"),
            element(0x1853_8067, &[front(), clusters].concat(), true),
        ]
        .concat();
    }
    let clusters = [open(0x1f43_b675, 1), first, open(0x1f43_b675, 8), second].concat();
    [header("webm"), open(0x1853_8067, 8), front(), clusters].concat()
}

fn read(bytes: &[u8]) -> (Result<Matroska, MatroskaError>, tempfile::NamedTempFile) {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    (Matroska::read(file.path()), file)
}

#[test]
fn frames_are_found_with_known_and_unknown_lengths() {
    for are_known in [true, false] {
        let (found, file) = read(&file(are_known));
        let found = found.unwrap();
        assert!(!found.is_truncated);
        let [depth, packed] = found.tracks.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(
            (depth.number, depth.uid, depth.name.as_str()),
            (3, 0x1234_5678_9abc, "DEPTH")
        );
        assert_eq!((depth.size_px, depth.fourcc()), ([640, 576], Some(*b"b16g")));
        assert_eq!((depth.is_packed, depth.laced), (false, 1));
        assert_eq!((packed.number, packed.is_packed, packed.fourcc()), (200, true, None));
        let frames = depth.frames.iter().map(|block| {
            let bytes = block.read(file.path(), 100).unwrap();
            (block.time.as_micros(), String::from_utf8(bytes).unwrap())
        });
        let expected = [(33, "early"), (34, "laced"), (49_800, "late"), (50_020, "later")];
        assert!(frames.eq(expected.map(|(time, text)| (time, text.to_owned()))));
        assert_eq!(
            (found.tag("MODE"), found.tag("DELAY"), found.tag("EMPTY")),
            (Some("WIDE"), Some("-5"), Some(""))
        );
        assert_eq!(found.tag("ELSE"), None);
        let [attached] = found.attachments.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(attached.name, "calibration.json");
        assert_eq!(attached.content.read(file.path(), 8).unwrap(), b"{\"a\": 1}");
        assert!(
            attached
                .content
                .read(file.path(), 7)
                .unwrap_err()
                .contains("--max-memory")
        );
    }
}

#[test]
fn times_are_milliseconds_unless_stated_otherwise() {
    let cluster = [
        number(0xe7, 5),
        short(SIMPLE, &block(3, -7, 0, b"a")),
        short(SIMPLE, &block(3, 2, 0, b"b")),
    ];
    let bytes = [
        header("matroska"),
        open(0x1853_8067, 1),
        tracks(),
        open(0x1f43_b675, 1),
        cluster.concat(),
    ]
    .concat();
    let found = read(&bytes).0.unwrap();
    let times: Vec<u128> = found.tracks[0]
        .frames
        .iter()
        .map(|block| block.time.as_millis())
        .collect();
    // No time is before the beginning.
    assert_eq!(times, [0, 7]);
}

#[test]
fn a_truncated_file_is_read_as_far_as_it_goes() {
    let whole = file(false);
    let start = header("webm").len() + 12 + front().len();
    let mut counts = Vec::new();
    for end in start..whole.len() {
        let found = read(&whole[..end]).0.unwrap();
        counts.push(found.tracks[0].frames.len());
    }
    assert!(
        counts.is_sorted() && counts[0] == 0 && *counts.last().unwrap() == 4,
        "{counts:?}"
    );
    assert!(read(&whole[..whole.len() - 1]).0.unwrap().is_truncated);
    for end in 0..header("webm").len() + 12 + 300 {
        assert!(read(&whole[..end]).0.is_err(), "{end}");
    }
}

#[test]
fn other_files_are_rejected() {
    for (bytes, expected) in [
        (Vec::new(), "first bytes"),
        (b"ply\nformat".to_vec(), "first bytes"),
        (header("avi"), "kind `avi`"),
        (header("matroska"), "no track"),
        ([header("matroska"), vec![0; 100]].concat(), "no track"),
        // A length beyond the file, for a body that would be read.
        (
            [header("matroska"), short(0x1654_ae6b, &[]), open(0x1549_a966, 8)].concat(),
            "no track",
        ),
    ] {
        let error = read(&bytes).0.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let (found, file) = read(&self::file(true));
    let block = found.unwrap().tracks[0].frames[0];
    std::fs::write(file.path(), b"changed").unwrap();
    assert!(block.read(file.path(), 100).unwrap_err().contains("has changed"));
    assert!(is_one(&self::file(true)) && !is_one(b"\x1a\x45\xdf"));
}

proptest! {
    /// Frames never extend beyond the file, whatever it claims.
    #[test]
    fn damage_never_panics(places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12)) {
        let mut bytes = file(true);
        for (place, byte) in places {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let (Ok(found), file) = read(&bytes) {
            for block in found.tracks.iter().flat_map(|track| &track.frames) {
                prop_assert!(block.offset + block.byte_count <= bytes.len() as u64);
                prop_assert!(block.read(file.path(), 1 << 20).is_ok());
            }
        }
    }
}
