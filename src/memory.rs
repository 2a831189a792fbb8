//! The allocator of the program and of its benchmarks.
//!
//! Frames are tens of megabytes that come and go many times a second. The system's allocator gives such pieces back at once
//! and pays for every page again; this one keeps them for the next frame.

pub use mimalloc::MiMalloc;

use std::ffi::c_long;

/// How long freed memory is kept, in milliseconds, before the allocator gives it back to the system, which it does when it
/// next has something to do. One second, the default, gives back what the next frames need.
const KEPT_MS: c_long = 10_000;

/// `mi_option_purge_delay` of `mimalloc.h`, which the crate does not name.
const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;

/// Sets for how long freed memory is kept. To be called once, when the program starts.
pub fn keep_freed_pages() {
    #[allow(
        unsafe_code,
        reason = "the allocator has options in its environment or in C alone"
    )]
    // SAFETY: the function stores a number in an array of options that is as long as the library that comes with the crate
    // says, and may be called at any time.
    unsafe {
        libmimalloc_sys::mi_option_set(PURGE_DELAY, KEPT_MS);
    }
}
