//! The program's CPU time, by the purpose of its threads.

use std::collections::HashMap;
use std::time::Duration;
use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

/// Beginnings of the names of threads that prepare frames (`sequence/loader`).
const PREPARE: [&str; 2] = ["frame loader", "frame stages"];

/// Beginnings of the names of threads of a driver: llvmpipe's, Mesa's window systems and queues, NVIDIA's.
const DRIVER: [&str; 5] = ["llvmpipe", "WSI", "vk", "[vk", "lavapipe"];

/// Role of a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ThreadRole {
    /// Preparing frames.
    Prepare,
    /// A driver's.
    Driver,
    /// Helping the window's thread to draw, and everything else.
    Helper,
}

impl ThreadRole {
    fn of(name: &str) -> Self {
        let begins_with = |prefixes: &[&str]| prefixes.iter().any(|prefix| name.starts_with(prefix));
        if begins_with(&PREPARE) {
            Self::Prepare
        } else if begins_with(&DRIVER) {
            Self::Driver
        } else {
            Self::Helper
        }
    }
}

/// CPU time of the program and of its threads, since each began.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::app) struct Processor {
    all_ms: f64,
    /// CPU times of all threads except the first, which runs the window. Empty where the system does not report them.
    threads: HashMap<Pid, (ThreadRole, f64)>,
}

/// CPU time of an interval, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "names carry their unit")]
pub(super) struct Used {
    /// CPU time of all threads.
    pub(super) all_ms: f64,
    /// CPU time of the threads that prepare frames.
    pub(super) prepare_ms: f64,
    /// CPU time of a driver's threads.
    pub(super) driver_ms: f64,
    /// CPU time of the threads that help the window's thread to draw, and of everything else.
    pub(super) helpers_ms: f64,
}

impl Processor {
    /// Returns the CPU time used so far.
    pub(super) fn now() -> Self {
        let Ok(own) = sysinfo::get_current_pid() else {
            return Self::default();
        };
        let mut system = System::new();
        let times = ProcessRefreshKind::nothing().with_cpu().with_tasks();
        // Individual threads are listed only when all processes are.
        system.refresh_processes_specifics(ProcessesToUpdate::All, false, times);
        let Some(process) = system.process(own) else {
            return Self::default();
        };
        let threads = process.tasks().into_iter().flatten();
        let threads = threads.filter_map(|&thread| system.process(thread));
        Self {
            all_ms: process.accumulated_cpu_time() as f64,
            threads: threads
                .filter(|thread| thread.pid() != own)
                .map(|thread| {
                    let kind = ThreadRole::of(&thread.name().to_string_lossy());
                    (thread.pid(), (kind, thread.accumulated_cpu_time() as f64))
                })
                .collect(),
        }
    }

    /// Returns the CPU time used since `before`; `None` where the system does not report it. Threads that have ended in
    /// the meantime count only towards the total.
    pub(super) fn since(&self, before: &Self) -> Option<Used> {
        if self.threads.is_empty() {
            return None;
        }
        let mut used = Used {
            all_ms: self.all_ms - before.all_ms,
            ..Used::default()
        };
        for (thread, (kind, ms)) in &self.threads {
            let ms_before = before.threads.get(thread).map_or(0.0, |(_, ms)| *ms);
            let sum = match kind {
                ThreadRole::Prepare => &mut used.prepare_ms,
                ThreadRole::Driver => &mut used.driver_ms,
                ThreadRole::Helper => &mut used.helpers_ms,
            };
            // The system may reuse the id of a thread that has ended.
            *sum += (ms - ms_before).max(0.0);
        }
        Some(used)
    }

    /// Time since the program was started, to a hundredth of a second; `None` where the system does not report it.
    pub(in crate::app) fn since_start() -> Option<Duration> {
        /// Clock ticks per second in which Linux reports process times, on all of its machines.
        const TICKS_PER_SECOND: f64 = 100.0;
        let uptime = std::fs::read_to_string("/proc/uptime").ok()?;
        let up_s: f64 = uptime.split_whitespace().next()?.parse().ok()?;
        let line = std::fs::read_to_string("/proc/self/stat").ok()?;
        // Field 22 of the line, 20 after the name in brackets.
        let (_, after_name) = line.rsplit_once(')')?;
        let started: f64 = after_name.split_whitespace().nth(19)?.parse().ok()?;
        Duration::try_from_secs_f64(up_s - started / TICKS_PER_SECOND).ok()
    }

    /// Resets the memory peak, where the system can do so, so that it is counted from now on.
    pub(super) fn forget_peak() {
        if let Err(reason) = std::fs::write("/proc/self/clear_refs", "5") {
            log::debug!("the peak of the memory stays that since the start: {reason}");
        }
    }

    /// The most memory of the program that was in the machine's at once; `None` where the system does not report it.
    pub(super) fn peak_resident_bytes() -> Option<u64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
        Some(kibibytes << 10)
    }

    /// Memory of the program that is in the machine's.
    pub(super) fn resident_bytes() -> u64 {
        let Ok(own) = sysinfo::get_current_pid() else {
            return 0;
        };
        let mut system = System::new();
        let memory = ProcessRefreshKind::nothing().with_memory();
        system.refresh_processes_specifics(ProcessesToUpdate::Some(&[own]), false, memory);
        system.process(own).map_or(0, sysinfo::Process::memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_distinguished_by_name() {
        assert_eq!(ThreadRole::of("frame loader 3"), ThreadRole::Prepare);
        assert_eq!(ThreadRole::of("frame stages 0"), ThreadRole::Prepare);
        assert_eq!(ThreadRole::of("llvmpipe-1"), ThreadRole::Driver);
        assert_eq!(ThreadRole::of("pointreel"), ThreadRole::Helper);
    }

    #[test]
    fn cpu_time_of_an_interval_is_the_difference_per_thread() {
        let at = |all_ms, threads: &[(u32, ThreadRole, f64)]| Processor {
            all_ms,
            threads: threads
                .iter()
                .map(|&(id, kind, ms)| (Pid::from_u32(id), (kind, ms)))
                .collect(),
        };
        let before = at(100.0, &[(2, ThreadRole::Prepare, 40.0), (3, ThreadRole::Helper, 30.0)]);
        // The third has ended, the fourth and the fifth are new.
        let now = at(
            190.0,
            &[
                (2, ThreadRole::Prepare, 60.0),
                (4, ThreadRole::Driver, 7.0),
                (5, ThreadRole::Prepare, 5.0),
            ],
        );
        let expected = Used {
            all_ms: 90.0,
            prepare_ms: 25.0,
            driver_ms: 7.0,
            helpers_ms: 0.0,
        };
        assert_eq!(now.since(&before), Some(expected));
        assert_eq!(Processor::default().since(&before), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_reports_start_time_and_peak_memory() {
        let before = Processor::since_start().unwrap();
        std::thread::sleep(Duration::from_millis(120));
        let after = Processor::since_start().unwrap();
        assert!((0.1..20.0).contains(&after.saturating_sub(before).as_secs_f64()));
        Processor::forget_peak();
        let page = vec![1_u8; 100 << 20];
        let with_page = Processor::peak_resident_bytes().unwrap();
        drop(page);
        assert!(with_page >= 100 << 20, "{with_page}");
        // The kernel counts pages per CPU, and only adds them up from time to time.
        let after = Processor::peak_resident_bytes().unwrap();
        assert!(after + (16 << 20) >= with_page, "{after} of {with_page}");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_reports_single_threads() {
        let begin = std::time::Instant::now();
        let busy = std::thread::Builder::new().name("frame loader 9".to_owned());
        let seen = busy.spawn(move || {
            while begin.elapsed() < std::time::Duration::from_millis(300) {
                std::hint::spin_loop();
            }
            Processor::now()
        });
        let seen = seen.unwrap().join().unwrap();
        let is_loader = |(kind, ms): &&(ThreadRole, f64)| *kind == ThreadRole::Prepare && *ms >= 50.0;
        assert!(seen.threads.values().any(|thread| is_loader(&thread)), "{seen:?}");
        assert!(seen.all_ms >= 50.0);
    }
}
