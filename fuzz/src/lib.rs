//! The readers alone, by their sources: with the window and wgpu around them every target would take ten minutes to
//! build.

#![allow(dead_code, unused_imports, reason = "the readers are made for the whole program")]

use std::path::{Path, PathBuf};

#[path = "../../src/analysis/mod.rs"]
pub mod analysis;

#[path = "../../src/assumption.rs"]
pub mod assumption;

#[path = "../../src/binary/mod.rs"]
pub mod binary;

#[path = "../../src/cloud/mod.rs"]
pub mod cloud;

#[path = "../../src/io/mod.rs"]
pub mod io;

#[path = "../../src/locks.rs"]
pub mod locks;

#[path = "../../src/math/mod.rs"]
pub mod math;

#[path = "../../src/natural.rs"]
pub mod natural;

#[path = "../../src/photos/mod.rs"]
pub mod photos;

#[path = "../../src/printable.rs"]
pub mod printable;

#[path = "../../src/progress.rs"]
pub mod progress;

#[path = "../../src/reel/mod.rs"]
pub mod reel;

#[path = "../../src/regular_file.rs"]
pub mod regular_file;

#[path = "../../src/rgbd/mod.rs"]
pub mod rgbd;

#[path = "../../src/wire/mod.rs"]
pub mod wire;

/// Crates whose panics the readers catch.
const CAUGHT: [&str; 2] = ["/laz-", "/draco-core-"];

/// A panic that the readers catch is a refusal like any other; every other one ends the run as a finding.
pub fn let_caught_panics_pass() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let file = panic.location().map_or("", |place| place.file());
        if !CAUGHT.iter().any(|name| file.contains(name)) {
            abort(panic);
        }
    }));
}

/// Unpacks an image of a live stream: its size.
pub fn unpacked_size_px(image: &wire::PackedImage, most_bytes: u64) -> Option<[u32; 2]> {
    image.raster(most_bytes).ok().map(|raster| raster.size_px)
}

mod memory {
    use std::collections::TryReserveError;

    pub(crate) fn try_reserve<T>(vector: &mut Vec<T>, count: usize) -> Result<(), TryReserveError> {
        vector.try_reserve_exact(count)
    }

    /// The same on every machine, so that a finding is one everywhere.
    pub(crate) fn machine_bytes() -> Option<u64> {
        Some(1 << 30)
    }
}

/// Memory that looks like a disk, where there is such.
pub fn memory_folder() -> PathBuf {
    let folder = Path::new("/dev/shm");
    if folder.is_dir() { folder.to_owned() } else { std::env::temp_dir() }
}

/// Hands a file of these bytes to `read`.
pub fn with_file(extension: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    let name = format!("pointreel-fuzz-{}.{extension}", std::process::id());
    let path = memory_folder().join(name);
    if std::fs::write(&path, bytes).is_ok() {
        read(&path);
    }
    let _ = std::fs::remove_file(&path);
}

/// Reads the first messages of all topics of cameras in the recording at `path`. A refusal is as good as an image.
pub fn read_cameras(path: &Path) {
    use io::recording::camera::{CameraMessage, camera_info, extrinsics, links, number};
    use io::recording::{read_image, read_parsed};
    const READ: usize = 3;
    let options = io::ReadOptions::default();
    let Ok(topics) = io::cameras(path, true, &options) else {
        return;
    };
    for topic in &topics.topics {
        for (_, message) in topic.messages.iter().take(READ) {
            match topic.kind {
                CameraMessage::Image | CameraMessage::CompressedImage => {
                    let _ = read_image(path, message, topic.kind, &options);
                }
                CameraMessage::CameraInfo => drop(read_parsed(path, message, &options, camera_info)),
                CameraMessage::StaticTransforms | CameraMessage::Transforms => {
                    drop(read_parsed(path, message, &options, links));
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

/// Reads the first frames of all tracks of the Matroska file at `path`, and what is attached to it.
pub fn read_matroska(path: &Path) {
    use io::matroska::Matroska;
    use io::recording::camera::bare_image;
    const READ: usize = 3;
    const MOST_BYTES: u64 = 1 << 24;
    let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    let Ok(file) = Matroska::read(path) else {
        return;
    };
    for attached in &file.attachments {
        let content = attached.content;
        assert!(content.offset + content.byte_count <= bytes);
        let _ = content.read(path, MOST_BYTES);
    }
    for track in &file.tracks {
        assert!(track.frames.is_sorted_by_key(|frame| frame.time));
        for block in track.frames.iter().take(READ) {
            let frame = block.read(path, MOST_BYTES).expect("what was found is in the file");
            for encoding in ["16UC1", "nv12", "yuyv", "bgra8", "bayer_rggb8"] {
                let _ = bare_image(encoding, track.size_px, true, &frame, MOST_BYTES);
            }
        }
    }
}
