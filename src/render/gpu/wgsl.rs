//! How the WGSL of a shader is put together. WGSL has no includes: a shader is the constants that it shares with Rust
//! (`constants.rs`), and its files one behind the other.

use super::constants;
use super::primitives::Amplification;

const VIEW: &str = include_str!("../../../shaders/common/view.wgsl");

/// What records become vertices with.
const AMPLIFYING: [&str; 3] = [
    include_str!("../../../shaders/common/records.wgsl"),
    include_str!("../../../shaders/common/light.wgsl"),
    include_str!("../../../shaders/common/quads.wgsl"),
];

/// Of a pass over records, by these files.
pub(super) fn of_records(amplification: &Amplification, files: &[&str]) -> String {
    let constants = constants::of_amplification(amplification.vertices_per_record, amplification.drawn_per_record());
    [&[&constants::shared(), &constants, VIEW], &AMPLIFYING[..], files]
        .concat()
        .join("\n")
}

/// Of a pass over the screen.
pub(super) fn of_screen(pass: &str) -> String {
    let fullscreen = include_str!("../../../shaders/common/fullscreen.wgsl");
    [&constants::shared(), VIEW, fullscreen, pass].join("\n")
}
