//! Any bytes as a file that holds many frames: they are listed, and the first ones read.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::io::{self, ReadOptions};

/// Frames that are read of those that are listed.
const READ: usize = 3;

fuzz_target!(init: pointreel_fuzz::let_caught_panics_pass(), |data: &[u8]| {
    let Some((&choice, bytes)) = data.split_first() else {
        return;
    };
    let extensions = ["zip", "tar", "tgz", "mcap", "bag", "db3", "e57", "glb"];
    let extension = extensions[usize::from(choice) % extensions.len()];
    pointreel_fuzz::with_file(extension, bytes, |path| {
        let options = ReadOptions::default();
        if let Ok(entries) = io::list(path, &options) {
            for entry in entries.iter().take(READ) {
                // A refusal is as good as a cloud.
                let _ = io::read_part(path, &entry.part, &options);
            }
        }
    });
});
