//! For the targets in `fuzz/` alone: readers that the program reaches through others.

use crate::io::recordings::matroska::Matroska;
use crate::io::recordings::recording::camera::{CameraMessage, bare_image, camera_info, extrinsics, links, number};
use crate::io::recordings::recording::{read_image, read_parsed};
use crate::io::{self, ReadOptions};
use crate::wire::PackedImage;
use std::path::Path;

/// Messages of a topic and frames of a track that are read.
const READ: usize = 3;

/// Unpacks an image of a live stream: its size.
pub fn unpacked_size_px(image: &PackedImage, max_bytes: u64) -> Option<[u32; 2]> {
    image.raster(max_bytes).ok().map(|raster| raster.size_px)
}

/// Reads the first messages of all topics of cameras in the recording at `path`. A refusal is as good as an image.
pub fn read_cameras(path: &Path) {
    let options = ReadOptions::default();
    let Ok(topics) = io::cameras(path, true, &options) else {
        return;
    };
    for topic in &topics.topics {
        for (_, message) in topic.messages.iter().take(READ) {
            match topic.kind {
                CameraMessage::Image | CameraMessage::CompressedImage => {
                    let _ = read_image(path, message, topic.kind, &options);
                }
                CameraMessage::CameraInfo => {
                    let _ = read_parsed(path, message, &options, camera_info);
                }
                CameraMessage::StaticTransforms | CameraMessage::Transforms => {
                    let _ = read_parsed(path, message, &options, links);
                }
                CameraMessage::Extrinsics => {
                    let place = read_parsed(path, message, &options, extrinsics);
                    assert!(place.is_none_or(|place| place.is_finite()));
                }
                CameraMessage::Number => {
                    let _ = read_parsed(path, message, &options, number);
                }
            }
        }
    }
}

/// Reads the first frames of all tracks of the Matroska file at `path`, and its attachments.
pub fn read_matroska(path: &Path) {
    const MAX_BYTES: u64 = 1 << 24;
    let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    let Ok(file) = Matroska::read(path) else {
        return;
    };
    for attached in &file.attachments {
        let content = attached.content;
        assert!(content.offset + content.byte_count <= bytes);
        let _ = content.read(path, MAX_BYTES);
    }
    for track in &file.tracks {
        assert!(track.frames.is_sorted_by_key(|frame| frame.time));
        for block in track.frames.iter().take(READ) {
            let frame = block.read(path, MAX_BYTES).expect("what was found is in the file");
            for encoding in ["16UC1", "nv12", "yuyv", "bgra8", "bayer_rggb8"] {
                let _ = bare_image(encoding, track.size_px, true, &frame, MAX_BYTES);
            }
        }
    }
}
