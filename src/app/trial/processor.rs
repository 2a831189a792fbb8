//! The program's processor time, by what its threads are for.

use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

/// Beginnings of the names of threads that prepare frames (`sequence/loader`).
const PREPARE: [&str; 2] = ["frame loader", "frame stages"];

/// Beginnings of the names of threads of a driver: llvmpipe's, Mesa's window systems and queues, NVIDIA's.
const DRIVER: [&str; 5] = ["llvmpipe", "WSI", "vk", "[vk", "lavapipe"];

/// Processor time since the program began, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Processor {
    /// Of all threads.
    pub(super) all_ms: f64,
    /// Of those that prepare frames.
    pub(super) prepare_ms: f64,
    /// Of those of a driver.
    pub(super) driver_ms: f64,
    /// Of those that help the window's thread to draw, and of everything else.
    pub(super) helpers_ms: f64,
    /// Whether the system tells it of single threads.
    is_known: bool,
}

impl Processor {
    /// What was used until now.
    pub(super) fn now() -> Self {
        let Ok(own) = sysinfo::get_current_pid() else {
            return Self::default();
        };
        let mut system = System::new();
        let times = ProcessRefreshKind::nothing().with_cpu().with_tasks();
        // Single threads are listed only where all processes are.
        system.refresh_processes_specifics(ProcessesToUpdate::All, false, times);
        let Some(process) = system.process(own) else {
            return Self::default();
        };
        let mut used = Self {
            all_ms: process.accumulated_cpu_time() as f64,
            ..Self::default()
        };
        let tasks: Vec<Pid> = process.tasks().into_iter().flatten().copied().collect();
        for task in tasks.iter().filter_map(|&task| system.process(task)) {
            let name = task.name().to_string_lossy();
            let ms = task.accumulated_cpu_time() as f64;
            used.is_known = true;
            if task.pid() == own {
                continue;
            }
            if PREPARE.iter().any(|prefix| name.starts_with(prefix)) {
                used.prepare_ms += ms;
            } else if DRIVER.iter().any(|prefix| name.starts_with(prefix)) {
                used.driver_ms += ms;
            } else {
                used.helpers_ms += ms;
            }
        }
        used
    }

    /// What was used since `before`; `None` where the system does not tell.
    pub(super) fn since(&self, before: &Self) -> Option<Self> {
        (self.is_known && before.is_known).then_some(Self {
            all_ms: self.all_ms - before.all_ms,
            prepare_ms: self.prepare_ms - before.prepare_ms,
            driver_ms: self.driver_ms - before.driver_ms,
            helpers_ms: self.helpers_ms - before.helpers_ms,
            is_known: true,
        })
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn the_time_of_a_loader_is_told_from_that_of_helpers() {
        let before = Processor::now();
        let busy = |name: &str| {
            let thread = std::thread::Builder::new().name(name.to_owned());
            thread.spawn(|| {
                let begin = Instant::now();
                while begin.elapsed() < Duration::from_millis(300) {
                    std::hint::spin_loop();
                }
                // Looked at before it ends: its time is that of the program alone afterwards.
                Processor::now()
            })
        };
        let loading = busy("frame loader 0").unwrap().join().unwrap();
        let used = loading.since(&before).unwrap();
        assert!(used.prepare_ms >= 50.0, "{used:?}");
        assert!(used.all_ms >= used.prepare_ms, "{used:?}");
        let helping = busy("painter").unwrap().join().unwrap();
        let used = helping.since(&before).unwrap();
        assert!(used.helpers_ms >= 50.0, "{used:?}");
    }
}
