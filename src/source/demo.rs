//! The demo sequence, embedded so that the program has something to show without an input. Licence, credit and how it
//! was made: `assets/demo/README.md`.

use super::opener::Made;
use super::{FrameEntry, FrameList};
use crate::io;
use std::sync::Arc;

/// The built-in sequence, where an input is expected.
pub const DEMO_INPUT: &str = "demo:";

/// Nothing may follow the colon.
pub(super) const DEMO: Made = Made {
    has_word: |word| word == "demo",
    said: || DEMO_INPUT.to_owned(),
    make: |_, rest| rest.is_empty().then(|| Arc::new(demo()) as _),
};

/// One embedded frame a number.
macro_rules! frames {
    ($($number:literal)*) => {
        &[$((
            concat!("frame_", $number, ".ply"),
            include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo/frame_", $number, ".ply")),
        )),*]
    };
}

const FRAMES: &[(&str, &[u8])] = frames!(
    "0000" "0001" "0002" "0003" "0004" "0005" "0006" "0007" "0008" "0009" "0010" "0011"
    "0012" "0013" "0014" "0015" "0016" "0017" "0018" "0019" "0020" "0021" "0022" "0023"
);

/// 24 poses of about 8,000 coloured points.
pub fn demo() -> FrameList {
    let entries = FRAMES.iter().zip(0..).map(|(&(name, bytes), number)| FrameEntry {
        number: Some(number),
        ..FrameEntry::embedded(format!("demo/{name}"), bytes)
    });
    FrameList::new(entries.collect(), |entry, _| {
        Ok(io::read_bytes(&entry.path, entry.content.embedded())?)
    })
}
