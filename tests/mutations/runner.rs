//! Runs children and watches them: their faults are findings.

use crate::child::{ORDER, Order};
use crate::drive::MAX_MEMORY_BYTES;
use crate::machine;
use std::collections::BTreeMap;
use std::fs::File;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// CPU time limit of a path.
const MAX_COMPUTED: Duration = Duration::from_secs(10);

/// Time limit of a path that computes nothing, on a busy machine.
const MAX_WAITED: Duration = Duration::from_mins(3);

/// Memory limit of a process above `--max-memory`.
const MEMORY_ABOVE_BYTES: u64 = 200 << 20;

const MAX_RESIDENT_BYTES: u64 = MAX_MEMORY_BYTES + MEMORY_ABOVE_BYTES;

/// A fault of a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Finding {
    pub(crate) number: u64,
    pub(crate) set: String,
    pub(crate) way: String,
    pub(crate) reason: String,
}

impl Finding {
    /// A key that is equal for two findings of the same fault.
    pub(crate) fn key(&self) -> String {
        let way = if self.reason.starts_with("panic") {
            ""
        } else {
            &self.way
        };
        let letters = self.reason.chars().filter(|letter| !letter.is_ascii_digit());
        format!("{} {way} {}", self.set, letters.collect::<String>())
    }
}

/// Outcome of an order.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    /// Paths that were run, by set.
    pub(crate) executions: BTreeMap<String, u64>,
    pub(crate) findings: Vec<Finding>,
    /// Maximum CPU time of a path, ms, and maximum memory.
    pub(crate) max: BTreeMap<String, (u64, u64)>,
}

/// A child that is at work.
struct Watched {
    child: Child,
    /// Bytes of the report that were read.
    read: usize,
    /// The path that it runs: case, name, set.
    way: Option<(u64, String, String)>,
    since: Instant,
    computed_before: Duration,
    has_ended: bool,
}

/// Has an order carried out, by as many processes as needed.
pub(crate) fn carry_out(order: &Order) -> Outcome {
    let mut outcome = Outcome::default();
    let mut order = order.clone();
    while !order.numbers.is_empty() {
        // There is none before the first case of a run.
        let _ = std::fs::remove_file(order.report());
        let mut watched = Watched::start(&order);
        watched.watch(&order, &mut outcome);
        if watched.has_ended {
            break;
        }
        // The case that killed it is not tried again.
        let number = watched.way.map_or(order.numbers.start, |(number, ..)| number);
        order.numbers.start = number + 1;
    }
    outcome
}

impl Watched {
    fn start(order: &Order) -> Self {
        let said = File::create(order.scratch.join("stderr")).unwrap();
        let child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child", "--ignored", "--nocapture", "--test-threads=1"])
            .env(ORDER, order.to_json())
            // As for a user without a display and without settings.
            .env("HOME", &order.scratch)
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_CACHE_HOME")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(said)
            .spawn()
            .unwrap();
        Self {
            child,
            read: 0,
            way: None,
            since: Instant::now(),
            computed_before: Duration::ZERO,
            has_ended: false,
        }
    }

    fn watch(&mut self, order: &Order, outcome: &mut Outcome) {
        loop {
            let status = self.child.try_wait().unwrap();
            self.read_report(order, outcome);
            if let Some(status) = status {
                if !self.has_ended {
                    let said = std::fs::read_to_string(order.scratch.join("stderr")).unwrap_or_default();
                    let last = said
                        .lines()
                        .rev()
                        .find(|line| !line.trim().is_empty())
                        .unwrap_or_default();
                    self.found(format!("died: {status}: {last}"), outcome);
                }
                return;
            }
            if let Some(reason) = self.excess() {
                self.child.kill().unwrap();
                self.child.wait().unwrap();
                self.found(reason, outcome);
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The resource that it exceeds.
    fn excess(&self) -> Option<String> {
        let pid = self.child.id();
        let computed = machine::computed(pid)
            .unwrap_or_default()
            .saturating_sub(self.computed_before);
        if computed > MAX_COMPUTED {
            return Some(format!("slow: more than {} s", MAX_COMPUTED.as_secs()));
        }
        if self.since.elapsed() > MAX_WAITED {
            return Some(format!("hangs: more than {} s", MAX_WAITED.as_secs()));
        }
        let resident = machine::resident_bytes(pid).unwrap_or(0);
        (resident > MAX_RESIDENT_BYTES).then(|| memory(resident))
    }

    fn found(&self, reason: String, outcome: &mut Outcome) {
        let (number, way, set) = self.way.clone().unwrap_or_default();
        outcome.findings.push(Finding {
            number,
            set,
            way,
            reason,
        });
    }

    fn read_report(&mut self, order: &Order, outcome: &mut Outcome) {
        let report = std::fs::read(order.report()).unwrap_or_default();
        let new = &report[self.read.min(report.len())..];
        let whole = new.iter().rposition(|&byte| byte == b'\n').map_or(0, |place| place + 1);
        let lines = String::from_utf8_lossy(&new[..whole]).into_owned();
        self.read += whole;
        for line in lines.lines() {
            self.take(line, outcome);
        }
    }

    fn take(&mut self, line: &str, outcome: &mut Outcome) {
        let words: Vec<&str> = line.split(' ').collect();
        match words.as_slice() {
            ["end"] => self.has_ended = true,
            ["start", number, way, set] => {
                self.way = Some((number.parse().unwrap(), (*way).to_owned(), (*set).to_owned()));
                self.since = Instant::now();
                self.computed_before = machine::computed(self.child.id()).unwrap_or_default();
                *outcome.executions.entry((*set).to_owned()).or_default() += 1;
            }
            ["done", took_ms, peak_bytes] => {
                let (took_ms, peak_bytes): (u64, u64) = (took_ms.parse().unwrap(), peak_bytes.parse().unwrap());
                let set = self.way.as_ref().map(|(_, _, set)| set.clone()).unwrap_or_default();
                let max = outcome.max.entry(set).or_default();
                *max = (max.0.max(took_ms), max.1.max(peak_bytes));
                if u128::from(took_ms) > MAX_COMPUTED.as_millis() {
                    self.found(format!("slow: {took_ms} ms"), outcome);
                }
                if peak_bytes > MAX_RESIDENT_BYTES {
                    self.found(memory(peak_bytes), outcome);
                }
            }
            ["panic", ..] => self.found(line.to_owned(), outcome),
            _ => panic!("a child says {line}"),
        }
    }
}

fn memory(bytes: u64) -> String {
    format!("memory: {} MB", bytes >> 20)
}
