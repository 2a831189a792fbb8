//! Runs commands with faults, and checks the files that each has left.

use super::commands::{CASES, make_files};
use super::shim::{FAULT, FOLDER, How, Kind, REPORT};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output, Stdio};
use std::time::{Duration, SystemTime};

/// Number of calls of one kind tried per command where not all are.
const SOME: u64 = 12;

/// Since 1970, of all files.
const AGE: Duration = Duration::from_hours(24 * 365 * 50);

/// Files of a folder and all below it, by their names in it.
type Files = BTreeMap<PathBuf, Vec<u8>>;

fn files_of(folder: &Path) -> Files {
    let mut files = Files::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                files.insert(name, fs::read(path).unwrap());
            }
        }
    }
    files
}

/// Writes them as of one time: conversions note how old their inputs are.
fn write_files(folder: &Path, files: &Files) {
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        let file = fs::File::options().write(true).open(path).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH + AGE).unwrap();
    }
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command.env("RUST_BACKTRACE", "0");
    command
}

/// Runs the real program, which must succeed.
pub(crate) fn succeed(folder: &Path, arguments: &[&str]) {
    let output = command(folder, arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}

/// A run of a command with a fault, in a folder of its own.
struct Run {
    output: Output,
    files: Files,
    /// Calls of each kind, where the program has ended by itself.
    counts: Vec<u64>,
    has_met_its_fault: bool,
}

/// Runs it in the folder `files` of `scratch`, whose path is the same for every run: the output of a command contains
/// it.
fn run(case: &str, scratch: &Path, before: &Files, fault: &str) -> Run {
    let folder = scratch.join("files");
    let report = scratch.join("report");
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    if report.exists() {
        fs::remove_file(&report).unwrap();
    }
    write_files(&folder, before);
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(case.split(' ')).current_dir(&folder).stdin(Stdio::null());
    command.envs([("RUST_BACKTRACE", "0"), ("RAYON_NUM_THREADS", "1"), (FAULT, fault)]);
    command.env(FOLDER, &folder).env(REPORT, &report);
    command.env("XDG_CONFIG_HOME", scratch).env("XDG_CACHE_HOME", scratch);
    let output = command.output().unwrap();
    let counts = fs::read_to_string(&report);
    Run {
        output,
        files: files_of(&folder),
        has_met_its_fault: counts.is_ok(),
        counts: counts.map_or_else(
            |_| Vec::new(),
            |counts| counts.split(' ').flat_map(str::parse).collect(),
        ),
    }
}

impl Run {
    fn said(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }

    /// Returns true if it is a sequence file that lacks frames, as reported, or a file that the next run resumes from.
    fn is_to_go_on(&self, name: &Path, said: &str) -> bool {
        let text = name.to_string_lossy();
        let ledger = PathBuf::from(format!("{}.json", text.trim_end_matches(".json")));
        let is_unfinished = text.contains(".unfinished") && self.files.contains_key(&ledger);
        let is_ledger = text.contains(".pointreel-convert.");
        let is_there = self.files.contains_key(name);
        let lacks_frames = text.ends_with(".reel") && said.contains("warning: frame ") && is_there;
        self.output.status.code() == Some(1) && (is_unfinished || is_ledger || lacks_frames)
    }

    /// All errors in it, compared with the run without a fault.
    fn faults(&self, before: &Files, sound: &Self) -> Vec<String> {
        let said = self.said();
        let mut faults = Vec::new();
        let code = self.output.status.code();
        if let Some(signal) = self.output.status.signal() {
            faults.push(format!("ended by signal {signal}"));
        }
        if said.contains("panicked") || code == Some(101) {
            faults.push("panicked".to_owned());
        }
        let is_as_sound = self.files == sound.files && self.output.stdout == sound.output.stdout;
        if code == sound.output.status.code() && !is_as_sound && said == sound.said() {
            faults.push(format!("exit code {code:?}, another result, and no word"));
        }
        if code != sound.output.status.code() && said.trim().is_empty() {
            faults.push(format!("exit code {code:?} without a word"));
        }
        let names: BTreeSet<_> = before
            .keys()
            .chain(sound.files.keys())
            .chain(self.files.keys())
            .collect();
        for name in names {
            let [now, then, done] = [&self.files, before, &sound.files].map(|files| files.get(name));
            if now != then && now != done && !self.is_to_go_on(name, &said) {
                let what = if now.is_none() {
                    "is gone"
                } else {
                    "is left, or half written"
                };
                faults.push(format!("{} {what}", name.display()));
            }
        }
        faults
    }
}

/// Indices among `count`: all, or some from the first to the last.
fn places(count: u64) -> Vec<u64> {
    let all = std::env::var("POINTREEL_FAULTS").is_ok_and(|faults| faults == "all");
    if all || count <= SOME {
        return (0..count).collect();
    }
    (0..SOME).map(|step| step * (count - 1) / (SOME - 1)).collect()
}

/// Faults of one command: the number tried, and the errors found.
fn try_case(case: &str, scratch: &Path, before: &Files) -> (usize, Vec<String>) {
    let sound = run(case, scratch, before, "none");
    let mut wrong = Vec::new();
    if !sound.output.status.success() || sound.counts.len() != Kind::ALL.len() {
        return (0, vec![format!("{case} without a fault: {}", sound.said())]);
    }
    let piecemeal = format!("::{}", How::Piecemeal.name());
    let mut tried = 0;
    let mut one = |fault: &str, must_be_met: bool| {
        tried += 1;
        let run = run(case, scratch, before, fault);
        let mut faults = run.faults(before, &sound);
        if must_be_met && !run.has_met_its_fault {
            faults.push("has not come to the fault".to_owned());
        }
        if fault == piecemeal && (run.output.stdout != sound.output.stdout || run.files != sound.files) {
            faults.push("has another result".to_owned());
        }
        if !faults.is_empty() {
            let mut line = format!("{case} with {fault}: {}", faults.join("; "));
            let _ = write!(line, "\n    said: {}", run.said().trim());
            wrong.push(line);
        }
    };
    for (kind, &count) in Kind::ALL.iter().zip(&sound.counts) {
        for place in places(count) {
            for how in [How::Once, How::FromThere] {
                // The first refused allocation ends the program.
                if *kind != Kind::Allocation || how == How::Once {
                    // The number of allocations varies slightly from run to run.
                    let last = count.saturating_sub(if *kind == Kind::Allocation { count / 20 } else { 0 });
                    one(&format!("{}:{place}:{}", kind.name(), how.name()), place < last);
                }
            }
        }
    }
    one(&piecemeal, false);
    let counts = sound.counts;
    println!("{case} {counts:?}: {tried} faults, {} wrong", wrong.len());
    (tried, wrong)
}

/// Tries every command whose line contains the program's argument, if there is one.
pub(crate) fn all() -> ExitCode {
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let chosen = |case: &&&str| filter.as_ref().is_none_or(|filter| case.contains(filter.as_str()));
    let scratch = tempfile::tempdir().unwrap();
    let made = tempfile::tempdir().unwrap();
    make_files(made.path());
    let before = files_of(made.path());
    let mut tried = 0;
    let mut wrong = Vec::new();
    for case in CASES.iter().filter(chosen) {
        let (faults, found) = try_case(case, scratch.path(), &before);
        tried += faults;
        wrong.extend(found);
    }
    println!("{tried} faults, {} wrong", wrong.len());
    for line in &wrong {
        println!("- {line}");
    }
    if wrong.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
