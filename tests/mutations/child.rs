//! The process that tries cases, and may die of one. It reports each step as a line of a file, which its parent reads
//! (`runner.rs`).

use crate::cases::{Case, fresh, retained_in};
use crate::drive::Way;
use crate::machine;
use std::backtrace::Backtrace;
use std::fs::File;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The job of a child, in its environment: an [`Order`] as JSON.
pub(crate) const ORDER: &str = "POINTREEL_MUTATIONS_ORDER";

/// The stack of a main thread, on which verbs run.
const STACK_BYTES: usize = 8 << 20;

/// Crates whose panics the readers catch.
const CAUGHT: [&str; 2] = ["laz::", "draco_core::"];

/// Maximum number of reported frames of a backtrace.
const MAX_FRAMES: usize = 4;

/// The order for a child.
#[derive(Debug, Clone)]
pub(crate) struct Order {
    /// Seeds, or a corpus that is tried as it is.
    pub(crate) folder: PathBuf,
    /// Sets that take turns; none of a corpus.
    pub(crate) sets: Vec<String>,
    /// Seed of all random choices.
    pub(crate) run: u64,
    /// The first case, and the one behind the last.
    pub(crate) numbers: std::ops::Range<u64>,
    /// A folder for its files.
    pub(crate) scratch: PathBuf,
}

impl Order {
    pub(crate) fn to_json(&self) -> String {
        let Self {
            folder,
            sets,
            run,
            numbers,
            scratch,
        } = self;
        serde_json::json!([folder, sets, run, [numbers.start, numbers.end], scratch]).to_string()
    }

    pub(crate) fn of_json(text: &str) -> Self {
        let (folder, sets, run, [start, end], scratch) = serde_json::from_str(text).unwrap();
        Self {
            folder,
            sets,
            run,
            numbers: start..end,
            scratch,
        }
    }

    /// The report file of a child.
    pub(crate) fn report(&self) -> PathBuf {
        self.scratch.join("report")
    }

    /// Case `number`, if there is one: of a corpus, or fresh from `retained` seeds. With it the seed of a fresh one.
    pub(crate) fn case(&self, retained: &[Case], number: u64) -> Option<(Option<Case>, Case)> {
        if self.sets.is_empty() {
            return Some((None, retained.get(number as usize)?.clone()));
        }
        let set = &self.sets[(number % self.sets.len() as u64) as usize];
        let (seed, case) = fresh(retained, set, self.run, number)?;
        Some((Some(seed), case))
    }
}

/// Lines go out one by one, so that the last one is there when the process dies.
#[derive(Debug, Clone)]
struct Report(Arc<Mutex<File>>);

impl Report {
    fn say(&self, line: &str) {
        let line = line.replace('\n', " | ");
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        writeln!(file, "{line}").unwrap();
    }

    /// Reports a panic, unless a reader catches it: the crates of these formats panic at damage.
    fn panicked(&self, panic: &PanicHookInfo<'_>) {
        let backtrace = Backtrace::force_capture().to_string();
        let frames = backtrace
            .lines()
            .filter_map(|line| line.split_once(": ").map(|(_, name)| name.trim()));
        let told: Vec<&str> = frames
            .filter(|name| name.contains("pointreel::") || CAUGHT.iter().any(|caught| name.contains(caught)))
            .take(MAX_FRAMES)
            .collect();
        let is_of_reader = told
            .first()
            .is_some_and(|name| CAUGHT.iter().any(|caught| name.contains(caught)));
        if !is_of_reader {
            self.say(&format!("panic {panic} in {}", told.join(" < ")));
        }
    }
}

/// Carries out the order in the environment.
pub(crate) fn work(order: Order) {
    let report = File::options().create(true).append(true).open(order.report()).unwrap();
    let report = Report(Arc::new(Mutex::new(report)));
    let of_hook = report.clone();
    std::panic::set_hook(Box::new(move |panic| of_hook.panicked(panic)));
    let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(move || {
        let retained = retained_in(&order.folder);
        for number in order.numbers.clone() {
            if let Some((_, case)) = order.case(&retained, number) {
                try_case(&case, number, &order.scratch, &report);
            }
        }
        report.say("end");
    });
    worker.unwrap().join().unwrap();
}

fn try_case(case: &Case, number: u64, scratch: &Path, report: &Report) {
    let outputs = scratch.join("outputs");
    for way in Way::of_set(&case.set) {
        let _ = std::fs::remove_dir_all(&outputs);
        std::fs::create_dir_all(&outputs).unwrap();
        // Commands may leave something next to their input.
        let input = case.write(&scratch.join("case"));
        machine::forget_peak();
        let before = machine::computed(std::process::id());
        report.say(&format!("start {number} {} {}", way.name(), case.set));
        // The panic hook has reported it.
        let _ = catch_unwind(AssertUnwindSafe(|| way.go(&input, &outputs, number)));
        let after = machine::computed(std::process::id());
        let took_ms = after
            .zip(before)
            .map_or(0, |(after, before)| after.saturating_sub(before).as_millis());
        report.say(&format!("done {took_ms} {}", machine::peak_bytes().unwrap_or(0)));
    }
}
