//! The allocator of the program and of its benchmarks.
//!
//! Frames are tens of megabytes that come and go many times per second. The system's allocator gives such pieces back
//! at once and pays for every page again; this one keeps them for the next frame.

mod allocator;
mod control_group;

pub use allocator::Allocator;
pub(crate) use allocator::{before_the_end, try_reserve};

use std::ffi::c_long;

/// Retention time of freed memory, in milliseconds, before the allocator gives it back to the system, which it does
/// when it next has something to do. One second, the default, gives back memory that the next frames need.
// The system's allocator returns memory to the system: 350 page faults per octree, 1 to 4 ms, where an octree takes 3
// ms. With one second, the default, 70 pages per frame were returned and faulted in again.
const RETAINED_MS: c_long = 10_000;

/// `mi_option_purge_delay` of `mimalloc.h`, which the crate does not name.
const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;

/// Sets how long freed memory is retained. To be called once, when the program starts.
pub fn keep_freed_pages() {
    #[allow(unsafe_code, reason = "the allocator has options in its environment or in C alone")]
    // SAFETY: the function stores a number in an array of options, whose length is that of the library version bundled
    // with the crate, and may be called at any time.
    unsafe {
        libmimalloc_sys::mi_option_set(PURGE_DELAY, RETAINED_MS);
    }
}

/// Gives freed memory back to the system at once, where the next frame does not need it.
pub(crate) fn give_back_freed_pages() {
    #[allow(unsafe_code, reason = "the allocator has this in C alone")]
    // SAFETY: the function may be called at any time, from any thread.
    unsafe {
        libmimalloc_sys::mi_collect(true);
    }
}

/// Bytes of memory that this process may have: the machine's, or those of its control groups if they are fewer; `None`
/// if the system does not report it.
pub(crate) fn machine_bytes() -> Option<u64> {
    // The same on every machine, so that findings are reproducible everywhere.
    if cfg!(fuzzing) {
        return Some(1 << 30);
    }
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let machine = Some(system.total_memory()).filter(|&bytes| bytes > 0);
    machine.into_iter().chain(control_group::limit_bytes()).min()
}

/// A size for people, one decimal.
pub(crate) fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// Set in a process of this test: the value that the option must have there, in milliseconds.
    const EXPECTED_MS: &str = "POINTREEL_EXPECTED_PURGE_DELAY_MS";

    /// The allocator's own name for the option.
    const BY_NAME: &str = "MIMALLOC_PURGE_DELAY";

    /// The default in `mimalloc.h` of version 3.
    const DEFAULT_MS: &str = "1000";

    fn option_ms() -> c_long {
        #[allow(unsafe_code, reason = "the allocator has options in its environment or in C alone")]
        // SAFETY: the function reads a number from an array of options that is longer than this index.
        unsafe {
            libmimalloc_sys::mi_option_get(PURGE_DELAY)
        }
    }

    /// The number is the library's own affair: another version may give it to another option. The option read by number
    /// must be the one that the library reads from its environment by name, and hold the default otherwise.
    ///
    /// The environment is read once, so each value is seen in a process of its own: this test, run again.
    #[test]
    fn the_number_is_still_that_of_the_purge_delay() {
        if let Ok(expected) = std::env::var(EXPECTED_MS) {
            assert_eq!(option_ms().to_string(), expected);
            keep_freed_pages();
            assert_eq!(option_ms(), RETAINED_MS);
            return;
        }
        for (set, expected) in [(None, DEFAULT_MS), (Some("4321"), "4321")] {
            let mut again = Command::new(std::env::current_exe().unwrap());
            let name = "memory::tests::the_number_is_still_that_of_the_purge_delay";
            again.args(["--exact", name]).env(EXPECTED_MS, expected);
            again.env_remove(BY_NAME).env_remove("MIMALLOC_RESET_DELAY");
            again.envs(set.map(|value| (BY_NAME, value)));
            let output = again.output().unwrap();
            let said = String::from_utf8_lossy(&output.stdout);
            assert!(said.contains("1 passed"), "{BY_NAME} {set:?}: {said}");
        }
    }
}
