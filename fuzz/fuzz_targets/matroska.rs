//! Any bytes as a Matroska file: its tracks, the first frames of each, and its attachments.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    pointreel_fuzz::with_file("mkv", data, pointreel::fuzzing::read_matroska);
});
