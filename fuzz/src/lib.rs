//! The readers alone, by their sources: with the window and wgpu around them every target would take ten minutes to
//! build.

#![allow(dead_code, reason = "the readers are made for the whole program")]

pub mod cloud;

#[path = "../../src/io/mod.rs"]
pub mod io;

#[path = "../../src/locks.rs"]
pub mod locks;

#[path = "../../src/progress.rs"]
pub mod progress;

#[path = "../../src/math/mod.rs"]
pub mod math;

#[path = "../../src/reel/mod.rs"]
pub mod reel;

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

mod memory {
    /// The same on every machine, so that a finding is one everywhere.
    pub(crate) fn machine_bytes() -> Option<u64> {
        Some(1 << 30)
    }
}
