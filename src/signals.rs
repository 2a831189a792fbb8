//! Signals that ask the program to end: Ctrl+C (SIGINT), SIGTERM and SIGHUP.
//!
//! **How it works.** They are blocked in every thread but one, which waits for them; so no code runs inside a signal
//! handler, and removing files is an ordinary function call. At the first signal a command that can end cleanly is
//! asked to ([`on_first`]): it finishes the current step. Any other command, and any command at the second signal, ends
//! at once: temporary files are removed ([`temporary::remove_all`]) and the process dies by that signal, as shells and
//! service managers expect. A signal that was ignored when the program began (`nohup`, jobs in the background of
//! scripts) stays ignored.

use crate::temporary;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Why the program is to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Signal {
    Interrupt,
    #[cfg(unix)]
    Terminate,
    #[cfg(unix)]
    Hangup,
}

impl Signal {
    /// The exit code that a shell reports for a process ended by this signal.
    fn exit_code(self) -> i32 {
        match self {
            Self::Interrupt => 130,
            #[cfg(unix)]
            Self::Terminate => 143,
            #[cfg(unix)]
            Self::Hangup => 129,
        }
    }
}

type Stop = Arc<dyn Fn() + Send + Sync>;

struct State {
    /// The first one that came.
    received: Option<Signal>,
    /// Stop callback of the running command, and the time limit it has for ending.
    stop: Option<(Stop, Option<Duration>)>,
}

static STATE: Mutex<State> = Mutex::new(State {
    received: None,
    stop: None,
});

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Waits for signals from now on. To be called before there is another thread.
pub(crate) fn watch() {
    if let Err(reason) = system::watch() {
        log::warn!("a signal will leave hidden files ({reason})");
    }
}

/// Guard for graceful shutdown: while it exists, the first signal asks the command to end instead of terminating it.
#[derive(Debug)]
pub(crate) struct EndsWell(());

impl Drop for EndsWell {
    fn drop(&mut self) {
        state().stop = None;
    }
}

/// Has the first signal call `stop`, after which the command is to end by itself, within `patience` if given.
pub(crate) fn on_first(stop: impl Fn() + Send + Sync + 'static, patience: Option<Duration>) -> EndsWell {
    state().stop = Some((Arc::new(stop), patience));
    EndsWell(())
}

/// Ends the process by the received signal; returns if there was none. Temporary files are removed.
pub(crate) fn end_if_received() {
    let received = state().received;
    if let Some(signal) = received {
        die(signal);
    }
}

/// Handles `signal`.
fn receive(signal: Signal) {
    let mut state = state();
    let is_first = state.received.is_none();
    state.received.get_or_insert(signal);
    let stop = state.stop.clone().filter(|_| is_first);
    drop(state);
    let Some((stop, patience)) = stop else {
        die(signal);
    };
    stop();
    if let Some(patience) = patience {
        let waits = move || {
            thread::sleep(patience);
            die(signal);
        };
        // If no thread can be started, a second signal still ends it.
        let _ = thread::Builder::new().name("end of patience".to_owned()).spawn(waits);
    }
}

fn die(signal: Signal) -> ! {
    temporary::remove_all();
    system::raise(signal);
    std::process::exit(signal.exit_code())
}

#[cfg(unix)]
mod system {
    use super::{Signal, receive};
    use nix::sys::signal::{SigSet, Signal as Raw, raise as raise_raw};
    use std::io;
    use std::thread;

    const ALL: [(Signal, Raw); 3] = [
        (Signal::Interrupt, Raw::SIGINT),
        (Signal::Terminate, Raw::SIGTERM),
        (Signal::Hangup, Raw::SIGHUP),
    ];

    pub(super) fn watch() -> io::Result<()> {
        let ignored = std::fs::read_to_string("/proc/self/status").map_or(0, |status| ignored(&status));
        let mut watched = SigSet::empty();
        let is_ignored = |signal: Raw| ignored >> (signal as u32 - 1) & 1 == 1;
        let raw = ALL.iter().map(|(_, raw)| *raw);
        watched.extend(raw.filter(|&signal| !is_ignored(signal)));
        // Blocked before other threads start, which inherit the mask: no code ever runs inside a signal handler.
        watched.thread_block()?;
        let waits = move || {
            // A waiting thread (`sigwait`) learns which signal arrived.
            while let Ok(raw) = watched.wait() {
                if let Some((signal, _)) = ALL.iter().find(|(_, known)| *known == raw) {
                    receive(*signal);
                }
            }
        };
        let spawned = thread::Builder::new().name("signals".to_owned()).spawn(waits);
        if spawned.is_err() {
            watched.thread_unblock()?;
        }
        spawned.map(|_| ())
    }

    /// A bit for each signal that the process ignores, of the text of `/proc/self/status`.
    pub(super) fn ignored(status: &str) -> u64 {
        let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
            .unwrap_or(0)
    }

    /// Ends the process unless the system refuses.
    pub(super) fn raise(signal: Signal) {
        if let Some((_, raw)) = ALL.iter().find(|(known, _)| *known == signal) {
            let _ = SigSet::from(*raw).thread_unblock();
            let _ = raise_raw(*raw);
        }
    }
}

#[cfg(not(unix))]
mod system {
    use super::{Signal, receive};
    use std::io;

    pub(super) fn watch() -> io::Result<()> {
        ctrlc::set_handler(|| receive(Signal::Interrupt)).map_err(io::Error::other)
    }

    /// There are no signals on this system.
    pub(super) fn raise(_: Signal) {}
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn ignored_signals_are_read() {
        let status = "Name:\tpointreel\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\nSigCgt:\t0\n";
        // SIGHUP and SIGPIPE.
        assert_eq!(system::ignored(status), 0x1001);
        assert_eq!(system::ignored("Name:\tpointreel\n"), 0);
    }

    #[test]
    fn exit_codes_are_those_of_shells() {
        let signals = [Signal::Hangup, Signal::Interrupt, Signal::Terminate];
        assert_eq!(signals.map(Signal::exit_code), [128 + 1, 128 + 2, 128 + 15]);
    }
}
