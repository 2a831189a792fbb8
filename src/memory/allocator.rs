//! The allocator that ends the program with a sentence where memory is refused.
//!
//! **How it works.** A refused allocation is met by two kinds of callers. One requested a size that a file claims, and
//! turns the refusal into an error of that file ([`try_reserve`]). All others cannot continue: Rust's own ending is a
//! signal, which a shell reports as a crash, so the program ends here, with the exit code of any other failure.

use mimalloc::MiMalloc;
use std::alloc::{GlobalAlloc, Layout};
use std::cell::Cell;
use std::collections::TryReserveError;
use std::io::Write as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

// Constants without a destructor: they allocate nothing themselves.
thread_local! {
    /// True if the caller asks for the allocation failure to be returned.
    static REFUSAL_IS_ASKED_FOR: Cell<bool> = const { Cell::new(false) };
    /// True if this thread ends the program, and has been refused memory once more.
    static IS_CLEANING_UP: Cell<bool> = const { Cell::new(false) };
}

/// For how long a thread waits for another one that ends the program.
const PATIENCE: Duration = Duration::from_secs(2);

/// Called before a refusal ends the program.
static BEFORE_THE_END: OnceLock<fn()> = OnceLock::new();

/// Has a refusal that ends the program call `clean_up` first, which must not wait for other threads.
pub(crate) fn before_the_end(clean_up: fn()) {
    // Only the first call counts, and there is only one.
    let _ = BEFORE_THE_END.set(clean_up);
}

/// Capacity for `count` more elements, or the error that there is no memory for them.
///
/// Everywhere else memory that is refused ends the program.
pub(crate) fn try_reserve<T>(vector: &mut Vec<T>, count: usize) -> Result<(), TryReserveError> {
    let before = REFUSAL_IS_ASKED_FOR.replace(true);
    #[allow(clippy::disallowed_methods, reason = "the allocator was informed above")]
    let result = vector.try_reserve_exact(count);
    REFUSAL_IS_ASKED_FOR.set(before);
    result
}

/// An allocator whose refusals end the program with a sentence; the program's own unless another is given.
#[derive(Debug, Clone, Copy, Default)]
pub struct Allocator<A = MiMalloc>(pub A);

impl Allocator {
    /// The program's allocator.
    pub const fn new() -> Self {
        Self(MiMalloc)
    }
}

#[allow(unsafe_code, reason = "an allocator cannot be written otherwise; it forwards")]
// SAFETY: every call is forwarded unchanged, and its result is either returned unchanged or not at all.
unsafe impl<A: GlobalAlloc> GlobalAlloc for Allocator<A> {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller upholds the contract of `alloc`.
        given(unsafe { self.0.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller upholds the contract of `alloc_zeroed`.
        given(unsafe { self.0.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        // SAFETY: the caller upholds the contract of `realloc`.
        given(unsafe { self.0.realloc(pointer, layout, bytes) }, bytes)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller upholds the contract of `dealloc`.
        unsafe { self.0.dealloc(pointer, layout) }
    }
}

#[inline]
fn given(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() && !REFUSAL_IS_ASKED_FOR.get() {
        end(bytes);
    }
    pointer
}

/// Ends the program. Nothing here allocates, and nothing that other threads or libraries hold is waited for.
#[cold]
fn end(bytes: usize) -> ! {
    static IS_ENDING: AtomicBool = AtomicBool::new(false);
    if IS_ENDING.swap(true, Relaxed) {
        if !IS_CLEANING_UP.get() {
            // Another thread is already doing it.
            std::thread::sleep(PATIENCE);
        }
    } else {
        IS_CLEANING_UP.set(true);
        say(bytes);
        if let Some(clean_up) = BEFORE_THE_END.get() {
            clean_up();
        }
    }
    #[allow(unsafe_code, reason = "ending without the destructors of libraries is a call of C")]
    // SAFETY: the function takes a number, never returns, and may be called at any time.
    unsafe {
        libc::_exit(1)
    }
}

fn say(bytes: usize) {
    const LONGEST: usize = 256;
    let mut sentence = [0; LONGEST];
    let mut rest = &mut sentence[..];
    let _ = writeln!(
        rest,
        "error: out of memory: the system refused {bytes} more bytes; unfinished outputs are given up and earlier \
         ones stay (give pointreel more memory, or less to keep: --max-memory)"
    );
    let length = LONGEST - rest.len();
    let _ = std::io::stderr().write_all(&sentence[..length]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_try_reserve_is_an_error() {
        let mut bytes = Vec::<u8>::new();
        assert!(try_reserve(&mut bytes, isize::MAX as usize).is_err());
        assert!(!REFUSAL_IS_ASKED_FOR.get());
        assert!(try_reserve(&mut bytes, 10).is_ok());
        assert!(bytes.capacity() >= 10);
    }
}
