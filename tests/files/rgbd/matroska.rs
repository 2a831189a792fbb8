//! Matroska files as `k4arecorder` writes them (RFC 9559).

use std::fmt::Display;

/// A track with its frames: times in microseconds, and bytes.
pub(crate) struct TrackOf<'a> {
    pub(crate) name: &'a str,
    pub(crate) fourcc: &'a [u8; 4],
    pub(crate) size_px: [u32; 2],
    pub(crate) frames: Vec<(u64, Vec<u8>)>,
}

/// An element with its length in eight bytes.
pub(crate) fn element(id: u32, body: &[u8]) -> Vec<u8> {
    let id: Vec<u8> = id.to_be_bytes().into_iter().skip_while(|&byte| byte == 0).collect();
    let length = (body.len() as u64 | 1 << 56).to_be_bytes();
    [id, length.to_vec(), body.to_vec()].concat()
}

fn number(id: u32, value: u64) -> Vec<u8> {
    element(id, &value.to_be_bytes())
}

/// Numbers of tracks, counted from 1, by which tags know them.
fn uid(track: usize) -> u64 {
    1000 + track as u64
}

fn track(index: usize, track: &TrackOf<'_>) -> Vec<u8> {
    let [width, height] = track.size_px;
    // BITMAPINFOHEADER.
    let words = [40, width, height, 1 | 16 << 16].map(u32::to_le_bytes).concat();
    let private = [words, track.fourcc.to_vec(), vec![0; 20]].concat();
    let video = [number(0xb0, width.into()), number(0xba, height.into())].concat();
    let entry = [
        number(0xd7, index as u64 + 1),
        number(0x73c5, uid(index)),
        number(0x83, 1),
        element(0x536e, track.name.as_bytes()),
        element(0x86, b"V_MS/VFW/FOURCC"),
        element(0x63a2, &private),
        number(0x0023_e383, 33_333_333),
        element(0xe0, &video),
    ];
    element(0xae, &entry.concat())
}

fn tag(name: &str, value: impl Display) -> Vec<u8> {
    let pair = [
        element(0x45a3, name.as_bytes()),
        element(0x4487, value.to_string().as_bytes()),
    ];
    element(
        0x7373,
        &[element(0x63c0, &[]), element(0x67c8, &pair.concat())].concat(),
    )
}

/// The file of these tracks, with tags and an attached calibration.
pub(crate) fn mkv(tracks: &[TrackOf<'_>], tags: &[(&str, String)], calibration: Option<&str>) -> Vec<u8> {
    let header = [
        number(0x4286, 1),
        number(0x42f7, 1),
        number(0x42f2, 4),
        number(0x42f3, 8),
        element(0x4282, b"matroska"),
        number(0x4287, 4),
        number(0x4285, 2),
    ];
    let info = [
        number(0x002a_d7b1, 1000),
        element(0x4d80, b"libmatroska-1.4.9"),
        element(0x5741, b"k4arecord-1.4.1"),
    ];
    let entries: Vec<u8> = tracks.iter().enumerate().flat_map(|(at, of)| track(at, of)).collect();
    let mut said: Vec<u8> = tags.iter().flat_map(|(name, value)| tag(name, value)).collect();
    for (at, track) in tracks.iter().enumerate() {
        said.extend(tag(&format!("K4A_{}_TRACK", track.name), uid(at)));
    }
    let attachments = calibration.map_or_else(Vec::new, |json| {
        said.extend(tag("K4A_CALIBRATION_FILE", "calibration.json"));
        let file = [
            element(0x466e, b"calibration.json"),
            element(0x4660, b"application/octet-stream"),
            element(0x465c, json.as_bytes()),
            number(0x46ae, 7),
        ];
        element(0x1941_a469, &element(0x61a7, &file.concat()))
    });
    let body = [
        element(0x1549_a966, &info.concat()),
        element(0x1654_ae6b, &entries),
        attachments,
        element(0x1254_c367, &said),
        clusters(tracks),
    ];
    [
        element(0x1a45_dfa3, &header.concat()),
        element(0x1853_8067, &body.concat()),
    ]
    .concat()
}

/// A cluster for the frames taken within 32 milliseconds.
fn clusters(tracks: &[TrackOf<'_>]) -> Vec<u8> {
    let mut frames: Vec<(u64, u8, &[u8])> = Vec::new();
    for (at, track) in tracks.iter().enumerate() {
        let of_track = track.frames.iter();
        frames.extend(of_track.map(|(time, bytes)| (*time, at as u8 + 1, bytes.as_slice())));
    }
    frames.sort_by_key(|&(time, ..)| time);
    let mut clusters = Vec::new();
    for together in frames.chunk_by(|(a, ..), (b, ..)| a / 32_000 == b / 32_000) {
        let begin = together[0].0;
        let mut cluster = number(0xe7, begin);
        for &(time, track, bytes) in together {
            let head = [
                vec![track | 0x80],
                ((time - begin) as i16).to_be_bytes().to_vec(),
                vec![0x80],
            ];
            cluster.extend(element(0xa3, &[head.concat(), bytes.to_vec()].concat()));
        }
        clusters.extend(element(0x1f43_b675, &cluster));
    }
    clusters
}
