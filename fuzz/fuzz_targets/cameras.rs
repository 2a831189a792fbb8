//! Any bytes as a recording of cameras: their topics are found, and the first messages of each read.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: pointreel_fuzz::let_caught_panics_pass(), |data: &[u8]| {
    let Some((&choice, bytes)) = data.split_first() else {
        return;
    };
    let extensions = ["bag", "mcap", "db3"];
    let extension = extensions[usize::from(choice) % extensions.len()];
    pointreel_fuzz::with_file(extension, bytes, pointreel::fuzzing::read_cameras);
});
