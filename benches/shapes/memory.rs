//! The allocator of the program, counting its allocations.

use pointreel::memory::Allocator;
use std::alloc::{GlobalAlloc, Layout};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

#[global_allocator]
static ALLOCATOR: Counted = Counted;

struct Counted;

static HELD_BYTES: AtomicUsize = AtomicUsize::new(0);
static PEAK_BYTES: AtomicUsize = AtomicUsize::new(0);

fn took(bytes: usize) {
    let held = HELD_BYTES.fetch_add(bytes, Relaxed) + bytes;
    // Read first: a new peak is rare, and writing to one location from two threads is slow.
    if held > PEAK_BYTES.load(Relaxed) {
        PEAK_BYTES.fetch_max(held, Relaxed);
    }
}

#[allow(
    unsafe_code,
    reason = "an allocator cannot be written otherwise; it only counts and forwards"
)]
// SAFETY: every call is forwarded unchanged to the program's allocator.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        took(layout.size());
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { Allocator::new().alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        took(layout.size());
        // SAFETY: the caller upholds the contract of `alloc_zeroed`.
        unsafe { Allocator::new().alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD_BYTES.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller upholds the contract of `dealloc`.
        unsafe { Allocator::new().dealloc(pointer, layout) }
    }
}

/// Bytes held now, from which the peak is counted.
#[allow(dead_code, reason = "not every bench counts memory")]
pub(crate) fn peak_from_here() -> usize {
    let held = HELD_BYTES.load(Relaxed);
    PEAK_BYTES.store(held, Relaxed);
    held
}

/// Maximum number of bytes held since then.
#[allow(dead_code, reason = "not every bench counts memory")]
pub(crate) fn peak() -> usize {
    PEAK_BYTES.load(Relaxed)
}
