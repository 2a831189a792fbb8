//! Any bytes as a sequence file: it is opened, and its first frames are decoded, coarse and whole. Checksums count as
//! right, or else nothing behind them would ever be reached.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::progress::Progress;
use pointreel::reel::{ReelDecoder, ReelFile};
use std::path::Path;
use std::sync::Arc;

/// Frames that are decoded of those that are listed.
const READ: usize = 3;

/// Bytes that a frame may take.
const MEMORY: u64 = 1 << 25;

fuzz_target!(|data: &[u8]| {
    let Ok(file) = ReelFile::open(Arc::new(data.to_vec()), Path::new("fuzz.reel")) else {
        return;
    };
    let mut decoder = ReelDecoder::new(Arc::new(file), MEMORY);
    for index in 0..decoder.file().frame_count().min(READ) {
        for max_points in [100, usize::MAX] {
            // A refusal is as good as a frame.
            if let Ok(frame) = decoder.decode(index, max_points, &Progress::default()) {
                let count = frame.cloud.positions.len();
                assert_eq!(frame.cloud.attributes.other_length(count), None);
            }
        }
    }
});
