//! Calls of the system and of the allocator that fail on request.
//!
//! **How it works.** The functions of C that reading and writing end in are defined here, so that the linker takes them
//! instead of the library's: the whole program and its libraries go through them, and the shipped program contains none
//! of it. Only files in one folder count, so that drivers and settings of the machine are left alone.

use mimalloc::MiMalloc;
use pointreel::memory::Allocator;
use std::alloc::{GlobalAlloc, Layout};
use std::ffi::CString;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering::Relaxed};

/// `KIND:PLACE:HOW` of the call that fails.
pub(crate) const FAULT: &str = "POINTREEL_FAULT";
/// The folder whose files count; the current one.
pub(crate) const FOLDER: &str = "POINTREEL_FAULT_FOLDER";
/// A file that is there once the fault has happened, with the numbers of calls if the program has ended by itself.
pub(crate) const REPORT: &str = "POINTREEL_FAULT_REPORT";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Allocation,
    Open,
    Read,
    Write,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Allocation, Self::Open, Self::Read, Self::Write];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Allocation => "allocation",
            Self::Open => "open",
            Self::Read => "read",
            Self::Write => "write",
        }
    }
}

/// One call fails, that one and all later ones, or every call does less than requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum How {
    Once,
    FromThere,
    /// One byte per call.
    Piecemeal,
}

impl How {
    pub(crate) const ALL: [Self; 3] = [Self::Once, Self::FromThere, Self::Piecemeal];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Once => "once",
            Self::FromThere => "from there",
            Self::Piecemeal => "piecemeal",
        }
    }
}

#[global_allocator]
static ALLOCATOR: Allocator<Failing> = Allocator(Failing);

static IS_ARMED: AtomicBool = AtomicBool::new(false);
static COUNTS: [AtomicU64; 4] = [const { AtomicU64::new(0) }; 4];
static KIND: AtomicU8 = AtomicU8::new(u8::MAX);
static PLACE: AtomicU64 = AtomicU64::new(u64::MAX);
static HOW: AtomicU8 = AtomicU8::new(0);
static PATHS: OnceLock<[CString; 2]> = OnceLock::new();
/// A flag per descriptor: its file counts.
static COUNTED: [AtomicBool; 4096] = [const { AtomicBool::new(false) }; 4096];

/// Reads the requested fault from the environment; returns false if there is none.
pub(crate) fn arm() -> bool {
    let Ok(fault) = std::env::var(FAULT) else {
        return false;
    };
    let path = |name| CString::new(std::env::var(name).unwrap()).unwrap();
    PATHS.set([path(FOLDER), path(REPORT)]).unwrap();
    let mut parts = fault.split(':');
    let mut part = || parts.next().unwrap_or_default();
    let (kind, place, how) = (part(), part(), part());
    if let Some(kind) = Kind::ALL.iter().position(|known| known.name() == kind) {
        KIND.store(kind as u8, Relaxed);
        PLACE.store(place.parse().unwrap(), Relaxed);
    }
    let how = How::ALL.iter().position(|known| known.name() == how);
    HOW.store(how.unwrap_or(0) as u8, Relaxed);
    IS_ARMED.store(true, Relaxed);
    true
}

/// Writes the number of calls of each kind.
pub(crate) fn report() {
    IS_ARMED.store(false, Relaxed);
    let counts = COUNTS.each_ref().map(|count| count.load(Relaxed).to_string());
    std::fs::write(std::env::var(REPORT).unwrap(), counts.join(" ")).unwrap();
}

fn how() -> How {
    How::ALL[usize::from(HOW.load(Relaxed))]
}

/// Counts a call, and returns whether it is to fail.
fn fails(kind: Kind) -> bool {
    if !IS_ARMED.load(Relaxed) {
        return false;
    }
    let place = COUNTS[kind as usize].fetch_add(1, Relaxed);
    let first = PLACE.load(Relaxed);
    let is_here = match how() {
        How::Once => place == first,
        How::FromThere => place >= first,
        How::Piecemeal => false,
    };
    let fails = is_here && KIND.load(Relaxed) == kind as u8;
    if fails && place == first {
        tell();
    }
    fails
}

struct Failing;

#[allow(unsafe_code, reason = "an allocator cannot be written otherwise")]
// SAFETY: every call is forwarded unchanged to the program's allocator, or refused, which callers must expect.
unsafe impl GlobalAlloc for Failing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if fails(Kind::Allocation) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { MiMalloc.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller upholds the contract of `dealloc`.
        unsafe { MiMalloc.dealloc(pointer, layout) }
    }
}

#[allow(
    unsafe_code,
    reason = "functions of C can be replaced by functions of C only; they forward to the system"
)]
mod calls {
    use super::{COUNTED, How, IS_ARMED, Kind, PATHS, fails, how};
    use libc::{c_char, c_int, c_void, mode_t, off64_t, size_t, ssize_t};
    use std::ffi::CStr;
    use std::sync::atomic::Ordering::Relaxed;

    /// Leaves the report's file, by calls that do not count.
    pub(super) fn tell() {
        let Some([_, report]) = PATHS.get() else { return };
        let flags = libc::O_CREAT | libc::O_WRONLY | libc::O_CLOEXEC;
        // SAFETY: the path is a C string, and the descriptor is closed at once.
        unsafe {
            let file = libc::syscall(libc::SYS_openat, libc::AT_FDCWD, report.as_ptr(), flags, 0o600);
            libc::syscall(libc::SYS_close, file);
        }
    }

    fn refuse(error: c_int) -> c_int {
        // SAFETY: the location of the thread's error number is always valid.
        unsafe { *libc::__errno_location() = error };
        -1
    }

    fn is_counted(file: c_int) -> bool {
        usize::try_from(file).is_ok_and(|file| COUNTED.get(file).is_some_and(|counted| counted.load(Relaxed)))
    }

    fn count(file: c_int, is_counted: bool) {
        if let Some(counted) = usize::try_from(file).ok().and_then(|file| COUNTED.get(file)) {
            counted.store(is_counted, Relaxed);
        }
    }

    /// # Safety
    /// `path` is a string of C.
    unsafe fn is_inside(path: *const c_char) -> bool {
        let Some([folder, _]) = PATHS.get() else { return false };
        // SAFETY: guaranteed by the caller.
        let path = unsafe { CStr::from_ptr(path) }.to_bytes();
        IS_ARMED.load(Relaxed) && (!path.starts_with(b"/") || path.starts_with(folder.to_bytes()))
    }

    /// Bytes that a call may move, or the error that it ends with.
    fn allowed(file: c_int, kind: Kind, bytes: size_t) -> Result<size_t, c_int> {
        if !is_counted(file) {
            return Ok(bytes);
        }
        if fails(kind) {
            return Err(if kind == Kind::Read { libc::EIO } else { libc::ENOSPC });
        }
        if how() != How::Piecemeal {
            return Ok(bytes);
        }
        Ok(bytes.min(1))
    }

    macro_rules! forward {
        ($call:ident, $($argument:expr),*) => {
            // SAFETY: the arguments come from the caller, who upholds the contract of the system call.
            unsafe { libc::syscall(libc::$call, $($argument),*) }
        };
    }

    /// # Safety
    /// As the function of C; the mode of a created file is always passed.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn open64(path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
        // SAFETY: guaranteed by the caller.
        let is_inside = unsafe { is_inside(path) };
        if is_inside && fails(Kind::Open) {
            return refuse(if flags & libc::O_CREAT == 0 {
                libc::EIO
            } else {
                libc::ENOSPC
            });
        }
        let file = forward!(SYS_openat, libc::AT_FDCWD, path, flags, mode) as c_int;
        count(file, is_inside && flags & libc::O_DIRECTORY == 0);
        file
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn close(file: c_int) -> c_int {
        count(file, false);
        forward!(SYS_close, file) as c_int
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn read(file: c_int, buffer: *mut c_void, bytes: size_t) -> ssize_t {
        match allowed(file, Kind::Read, bytes) {
            Ok(bytes) => forward!(SYS_read, file, buffer, bytes) as ssize_t,
            Err(error) => refuse(error) as ssize_t,
        }
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn pread64(
        file: c_int,
        buffer: *mut c_void,
        bytes: size_t,
        place: off64_t,
    ) -> ssize_t {
        match allowed(file, Kind::Read, bytes) {
            Ok(bytes) => forward!(SYS_pread64, file, buffer, bytes, place) as ssize_t,
            Err(error) => refuse(error) as ssize_t,
        }
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn write(file: c_int, buffer: *const c_void, bytes: size_t) -> ssize_t {
        match allowed(file, Kind::Write, bytes) {
            Ok(bytes) => forward!(SYS_write, file, buffer, bytes) as ssize_t,
            Err(error) => refuse(error) as ssize_t,
        }
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn pwrite64(
        file: c_int,
        buffer: *const c_void,
        bytes: size_t,
        place: off64_t,
    ) -> ssize_t {
        match allowed(file, Kind::Write, bytes) {
            Ok(bytes) => forward!(SYS_pwrite64, file, buffer, bytes, place) as ssize_t,
            Err(error) => refuse(error) as ssize_t,
        }
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn fsync(file: c_int) -> c_int {
        if is_counted(file) && fails(Kind::Write) {
            return refuse(libc::EIO);
        }
        forward!(SYS_fsync, file) as c_int
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn ftruncate64(file: c_int, bytes: off64_t) -> c_int {
        if is_counted(file) && fails(Kind::Write) {
            return refuse(libc::ENOSPC);
        }
        forward!(SYS_ftruncate, file, bytes) as c_int
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn rename(from: *const c_char, to: *const c_char) -> c_int {
        // SAFETY: guaranteed by the caller.
        if unsafe { is_inside(to) } && fails(Kind::Write) {
            return refuse(libc::ENOSPC);
        }
        forward!(SYS_renameat2, libc::AT_FDCWD, from, libc::AT_FDCWD, to, 0) as c_int
    }

    /// # Safety
    /// As the function of C.
    #[unsafe(no_mangle)]
    pub(super) unsafe extern "C" fn mkdir(path: *const c_char, mode: mode_t) -> c_int {
        // SAFETY: guaranteed by the caller.
        if unsafe { is_inside(path) } && fails(Kind::Write) {
            return refuse(libc::ENOSPC);
        }
        forward!(SYS_mkdirat, libc::AT_FDCWD, path, mode) as c_int
    }
}

use calls::tell;
