//! Resources used by a process, where the system reports them (Linux).

use std::time::Duration;

/// Ticks of the times in `/proc/…/stat` per second, on every Linux that Rust supports.
const TICKS_PER_S: u64 = 100;

/// Time that a process has computed: unlike wall time, it does not count other programs.
pub(crate) fn computed(pid: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name of the program, in parentheses, may contain spaces.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: u64 = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(Duration::from_millis(1000 / TICKS_PER_S * ticks))
}

fn status_bytes(pid: &str, name: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with(name))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib << 10)
}

/// Memory that a process has now.
pub(crate) fn resident_bytes(pid: u32) -> Option<u64> {
    status_bytes(&pid.to_string(), "VmRSS:")
}

/// The most memory that this process has had since [`forget_peak`].
pub(crate) fn peak_bytes() -> Option<u64> {
    status_bytes("self", "VmHWM:")
}

/// Resets [`peak_bytes`].
pub(crate) fn forget_peak() {
    // Without it the peak includes all previous cases: a finding is still reported with the case that caused it.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}
