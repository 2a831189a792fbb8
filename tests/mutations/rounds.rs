//! Long runs, in rounds over all sets: findings are minimised and saved, and a table lists the work done.
//!
//! Configured by the environment, as `scripts/fuzz.sh` does: `MUTATIONS_SECONDS`, `MUTATIONS_SETS` (names with commas
//! between; default: all), `MUTATIONS_SEEDS` (folders, separated as in `PATH`), `MUTATIONS_RUN` (a seed for other
//! cases; default: the time), `MUTATIONS_FOUND` (the folder for findings; default: `fuzz/found`).

use crate::cases::{Case, retained_in};
use crate::child::Order;
use crate::kinds;
use crate::runner::{Finding, Outcome, carry_out};
use crate::seeds::{gather, gather_corpus, keep};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Cases of one process: its start takes as long as a few of them.
const CASES: u64 = 200;

/// Tries at making a finding smaller.
const MAX_TRIES: usize = 40;

/// Files in memory, where there is such: a disk would be written over and over.
fn scratch() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() {
        memory.to_owned()
    } else {
        std::env::temp_dir()
    };
    tempfile::Builder::new()
        .prefix("pointreel-mutations-")
        .tempdir_in(folder)
        .unwrap()
}

fn told(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

/// Totals of all rounds, by set.
#[derive(Debug, Default)]
struct Sum {
    cases: u64,
    executions: u64,
    max_ms: u64,
    max_bytes: u64,
    findings: u64,
    new_findings: u64,
}

/// Runs rounds until the time is over.
pub(crate) fn run() {
    let Some(seconds) = told("MUTATIONS_SECONDS") else {
        return;
    };
    let until = Instant::now() + Duration::from_secs(seconds.parse().unwrap());
    let sets = match told("MUTATIONS_SETS") {
        Some(names) => names.split(',').map(str::to_owned).collect(),
        None => kinds::sets().into_iter().map(str::to_owned).collect(),
    };
    let unix_time = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    let run = told("MUTATIONS_RUN").map_or(unix_time.as_secs(), |run| run.parse().unwrap());
    let named = told("MUTATIONS_SEEDS").unwrap_or_default();
    let named: Vec<PathBuf> = std::env::split_paths(&named).filter(|path| path.is_dir()).collect();
    let found = told("MUTATIONS_FOUND").map_or(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/found"), PathBuf::from);
    let scratch = scratch();
    let seeds = scratch.path().join("seeds");
    gather(&seeds, &named);
    gather_corpus(&seeds);
    let mut rounds = Rounds {
        order: Order {
            folder: seeds.clone(),
            sets,
            run,
            numbers: 0..CASES,
            scratch: scratch.path().to_owned(),
        },
        retained: retained_in(&seeds),
        known: BTreeSet::new(),
        found,
        sums: BTreeMap::new(),
    };
    let begin = Instant::now();
    while Instant::now() < until {
        let outcome = carry_out(&rounds.order);
        rounds.add(&outcome);
        let next = rounds.order.numbers.end;
        rounds.order.numbers = next..next + CASES;
        rounds.tell(begin.elapsed());
    }
}

struct Rounds {
    order: Order,
    retained: Vec<Case>,
    /// Keys of saved findings.
    known: BTreeSet<String>,
    found: PathBuf,
    sums: BTreeMap<String, Sum>,
}

impl Rounds {
    fn add(&mut self, outcome: &Outcome) {
        let sets = &self.order.sets;
        for number in self.order.numbers.clone() {
            let set = &sets[(number % sets.len() as u64) as usize];
            self.sums.entry(set.clone()).or_default().cases += 1;
        }
        for (set, &count) in &outcome.executions {
            self.sums.entry(set.clone()).or_default().executions += count;
        }
        for (set, &(ms, bytes)) in &outcome.max {
            let sum = self.sums.entry(set.clone()).or_default();
            sum.max_ms = sum.max_ms.max(ms);
            sum.max_bytes = sum.max_bytes.max(bytes);
        }
        for finding in &outcome.findings {
            let is_new = self.known.insert(finding.key());
            let sum = self.sums.entry(finding.set.clone()).or_default();
            sum.findings += 1;
            if is_new {
                sum.new_findings += 1;
                self.keep(finding);
            }
        }
    }

    /// Minimises a finding, and writes it and its description.
    fn keep(&self, finding: &Finding) {
        let Some((Some(seed), case)) = self.order.case(&self.retained, finding.number) else {
            return;
        };
        let small = self.smaller(&seed, case, finding);
        let place = keep(&small, &self.found);
        let told = format!("{}\t{}\t{}\n", place.display(), finding.way, finding.reason);
        let list = self.found.join("findings.tsv");
        let before = fs::read_to_string(&list).unwrap_or_default();
        fs::write(list, before + &told).unwrap();
        say(&format!("found: {told}"));
    }

    /// The case with the fewest changes that give the same finding.
    fn smaller(&self, seed: &Case, case: Case, finding: &Finding) -> Case {
        let mut small = case;
        // Each attempt with these takes ten seconds.
        if finding.reason.starts_with("slow") || finding.reason.starts_with("hangs") {
            return small;
        }
        let mut tries = 0;
        for place in 0..small.files.len() {
            let whole = seed.files[place].1.clone();
            for change in differences(&whole, &small.files[place].1) {
                if tries == MAX_TRIES {
                    return small;
                }
                tries += 1;
                let mut candidate = small.clone();
                candidate.files[place].1[change.clone()].copy_from_slice(&whole[change]);
                let kind = kinds::kind_of(&small.set, &small.files[place].0);
                crate::repair::repair_all(kind.repair, &mut candidate.files[place].1);
                if candidate != small && self.comes_to(&candidate, finding) {
                    small = candidate;
                }
            }
        }
        small
    }

    fn comes_to(&self, case: &Case, finding: &Finding) -> bool {
        let folder = self.order.scratch.join("candidate");
        let _ = fs::remove_dir_all(&folder);
        keep(case, &folder);
        let order = Order {
            folder,
            sets: Vec::new(),
            numbers: 0..1,
            ..self.order.clone()
        };
        let outcome = carry_out(&order);
        outcome.findings.iter().any(|found| found.key() == finding.key())
    }

    fn tell(&self, elapsed: Duration) {
        let seconds = elapsed.as_secs_f64();
        let mut table = format!(
            "\nafter {seconds:.0} s (run {}, {} cases)\n{:<12}{:>9}{:>12}{:>9}{:>12}{:>9}{:>10}{:>6}\n",
            self.order.run,
            self.order.numbers.start,
            "set",
            "cases",
            "executions",
            "per s",
            "longest ms",
            "most MB",
            "findings",
            "kinds"
        );
        for (set, sum) in &self.sums {
            // Writing to a String cannot fail.
            let _ = writeln!(
                table,
                "{set:<12}{:>9}{:>12}{:>9.1}{:>12}{:>9}{:>10}{:>6}",
                sum.cases,
                sum.executions,
                sum.executions as f64 / seconds,
                sum.max_ms,
                sum.max_bytes >> 20,
                sum.findings,
                sum.new_findings
            );
        }
        say(&table);
        let place = self.found.join("table.txt");
        fs::create_dir_all(&self.found).unwrap();
        fs::write(place, table).unwrap();
    }
}

/// Runs in which files of one length differ; none for others.
fn differences(before: &[u8], after: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    if before.len() != after.len() {
        return runs;
    }
    for place in (0..before.len()).filter(|&place| before[place] != after[place]) {
        match runs.last_mut() {
            // Fields change as a whole.
            Some(run) if place < run.end + 4 => run.end = place + 1,
            _ => runs.push(place..place + 1),
        }
    }
    runs
}

/// A line for the person who waits, past the harness.
fn say(text: &str) {
    use std::io::Write as _;
    // If stderr is closed, the run continues.
    let _ = writeln!(std::io::stderr(), "{text}");
}
