//! Parsing of the bodies of small elements: tracks and tags.

use super::element::{children, text, unsigned};
use super::found::{Tag, Track};

const TRACK_ENTRY: u32 = 0xae;
const TRACK_NUMBER: u32 = 0xd7;
const TRACK_UID: u32 = 0x73c5;
const NAME: u32 = 0x536e;
const CODEC_ID: u32 = 0x86;
const CODEC_PRIVATE: u32 = 0x63a2;
const CONTENT_ENCODINGS: u32 = 0x6d80;
const VIDEO: u32 = 0xe0;
const PIXEL_WIDTH: u32 = 0xb0;
const PIXEL_HEIGHT: u32 = 0xba;
const TAG: u32 = 0x7373;
const SIMPLE_TAG: u32 = 0x67c8;
const TAG_NAME: u32 = 0x45a3;
const TAG_STRING: u32 = 0x4487;

/// The tracks in the body of `Tracks`.
pub(super) fn tracks(body: &[u8]) -> Vec<Track> {
    let entries = children(body).filter(|&(id, _)| id == TRACK_ENTRY);
    entries.map(|(_, entry)| track(entry)).collect()
}

fn track(entry: &[u8]) -> Track {
    let mut track = Track::default();
    for (id, body) in children(entry) {
        match id {
            TRACK_NUMBER => track.number = unsigned(body),
            TRACK_UID => track.uid = unsigned(body),
            NAME => track.name = text(body),
            CODEC_ID => track.codec = text(body),
            CODEC_PRIVATE => track.codec_private = body.to_vec(),
            CONTENT_ENCODINGS => track.is_packed = true,
            VIDEO => {
                for (id, body) in children(body) {
                    let side = || u32::try_from(unsigned(body)).unwrap_or(u32::MAX);
                    match id {
                        PIXEL_WIDTH => track.size_px[0] = side(),
                        PIXEL_HEIGHT => track.size_px[1] = side(),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    track
}

/// The tags in the body of `Tags`, of any target.
pub(super) fn tags(body: &[u8]) -> Vec<Tag> {
    let groups = children(body).filter(|&(id, _)| id == TAG);
    let pairs = groups.flat_map(|(_, group)| children(group).filter(|&(id, _)| id == SIMPLE_TAG));
    pairs.map(|(_, pair)| tag(pair)).collect()
}

fn tag(pair: &[u8]) -> Tag {
    let mut tag = Tag::default();
    for (id, body) in children(pair) {
        match id {
            TAG_NAME => tag.name = text(body),
            TAG_STRING => tag.value = text(body),
            _ => {}
        }
    }
    tag
}
