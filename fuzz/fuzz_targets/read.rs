//! Any bytes as a file of any name: the first byte chooses the extension, so that formats without magic are reached
//! too.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::io;
use std::path::PathBuf;

fuzz_target!(init: pointreel_fuzz::let_caught_panics_pass(), |data: &[u8]| {
    let Some((&choice, bytes)) = data.split_first() else {
        return;
    };
    let extensions: Vec<&str> = io::supported_extensions().collect();
    let extension = extensions[usize::from(choice) % extensions.len()];
    let name = PathBuf::from(format!("fuzz.{extension}"));
    if let Ok(cloud) = io::read_bytes(&name, bytes) {
        let count = cloud.positions.len();
        assert_eq!(cloud.attributes.other_length(count), None);
        let indices = cloud.faces.iter().flatten();
        assert!(indices.into_iter().all(|&index| (index as usize) < count));
    }
});
