//! `--max-memory` under a limit that kills: every reader on a sparse file of gigabytes, on a file that just fits the
//! limit and unpacks to more, and on the bomb of its format.
//!
//! Each case is a row of one of the tables in `memory_limits/`. The peak of the process is watched while it runs
//! (`VmHWM`); a process beyond the limit and [`OF_PROGRAM_BYTES`] is killed and listed. `POINTREEL_SHOW_PEAKS=1`
//! prints the peak of each, `POINTREEL_ONLY_CASE=NAME` runs those with this in their name.

#![cfg(target_os = "linux")]

mod bombs;
mod full;
mod heads;
mod sparse;

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Memory of the program itself: code, threads, and memory retained by the allocator.
const OF_PROGRAM_BYTES: u64 = 150 << 20;

/// A hang takes longer, in a debug build with other tests in parallel.
const PATIENCE: Duration = Duration::from_mins(2);

const MIB: u64 = 1 << 20;

/// Bytes of a file that is sparse behind its head.
const SPARSE_BYTES: u64 = 3 << 30;

/// A file of a case.
struct TestFile {
    name: &'static str,
    bytes: Vec<u8>,
    /// It is extended by zeros to this length.
    length: Option<u64>,
}

/// An input and its memory limit.
struct Case {
    name: &'static str,
    /// The first is the input, unless that is a folder; the others lie next to it.
    files: Vec<TestFile>,
    folder: Option<&'static str>,
    limit_bytes: u64,
    /// Commands that reach the reader.
    commands: &'static [&'static str],
}

impl Case {
    /// A file of these bytes.
    fn whole(name: &'static str, file: &'static str, bytes: Vec<u8>) -> Self {
        Self {
            name,
            files: vec![TestFile {
                name: file,
                bytes,
                length: None,
            }],
            folder: None,
            limit_bytes: 512 * MIB,
            commands: &["info"],
        }
    }

    /// A file of [`SPARSE_BYTES`] that begins with `head`.
    fn sparse(name: &'static str, file: &'static str, head: Vec<u8>) -> Self {
        let mut case = Self::whole(name, file, head);
        case.files[0].length = Some(SPARSE_BYTES);
        case
    }

    fn with_length(mut self, length: u64) -> Self {
        self.files[0].length = Some(length);
        self
    }

    fn with_limit(mut self, limit_bytes: u64) -> Self {
        self.limit_bytes = limit_bytes;
        self
    }

    fn with_commands(mut self, commands: &'static [&'static str]) -> Self {
        self.commands = commands;
        self
    }

    /// Writes the files; the path of the input.
    fn write(&self, folder: &Path) -> PathBuf {
        for TestFile { name, bytes, length } in &self.files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            let mut file = File::create(&path).unwrap();
            file.write_all(bytes).unwrap();
            if let Some(length) = length {
                file.set_len(*length).unwrap();
            }
        }
        folder.join(self.folder.unwrap_or(self.files[0].name))
    }

    /// Runs the program on the input by each command: the failures, a line each.
    fn failures(&self) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let input = self.write(folder.path());
        let outcome = |command: &&str| {
            let output = folder.path().join("output");
            let outcome = run(command, &input, &output, self.limit_bytes);
            if std::env::var_os("POINTREEL_SHOW_PEAKS").is_some() {
                let _ = writeln!(std::io::stderr(), "{}, {command}: {outcome:?}", self.name);
            }
            let problem = outcome.problem(self.limit_bytes)?;
            Some(format!("{}, {command}: {problem}", self.name))
        };
        self.commands.iter().filter_map(outcome).collect()
    }
}

/// Outcome of a run of the program.
#[derive(Debug)]
struct Outcome {
    /// None where a signal has ended it.
    code: Option<i32>,
    peak_bytes: u64,
    elapsed: Duration,
    said: String,
}

impl Outcome {
    /// Its fault.
    fn problem(&self, limit_bytes: u64) -> Option<String> {
        let peak = self.peak_bytes / MIB;
        if self.peak_bytes > limit_bytes + OF_PROGRAM_BYTES {
            return Some(format!("took {peak} MiB where {} MiB were allowed", limit_bytes / MIB));
        }
        if self.elapsed > PATIENCE {
            return Some(format!("has not ended after {PATIENCE:?}"));
        }
        let ends_well = matches!(self.code, Some(0..=3)) && !self.said.contains("panicked");
        let is_sentence = self.code == Some(0) || self.said.contains(' ');
        (!ends_well || !is_sentence).then(|| format!("ended with {:?}: {}", self.code, self.said))
    }
}

fn run(command: &str, input: &Path, output: &Path, limit_bytes: u64) -> Outcome {
    let mut program = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    program.arg(command).arg(input);
    match command {
        "convert" => program.arg(output.with_extension("ply")),
        "render" => program
            .arg("-o")
            .arg(output.with_extension("png"))
            .args(["--size", "64x48", "--renderer", "cpu"]),
        _ => &mut program,
    };
    let errors = output.with_extension("stderr");
    program
        .arg("--max-memory")
        .arg(limit_bytes.to_string())
        .stdout(Stdio::null())
        .stderr(File::create(&errors).unwrap());
    watched(program.spawn().unwrap(), &errors, limit_bytes + OF_PROGRAM_BYTES)
}

/// Waits for `child`, and kills it where it takes too much memory or time.
fn watched(mut child: Child, errors: &Path, max_bytes: u64) -> Outcome {
    const BETWEEN_LOOKS: Duration = Duration::from_millis(3);
    let start = Instant::now();
    let mut peak_bytes = 0;
    let code = loop {
        peak_bytes = peak_bytes.max(peak_of(child.id()).unwrap_or(0));
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if peak_bytes > max_bytes || start.elapsed() > PATIENCE {
            child.kill().unwrap();
            break child.wait().unwrap().code();
        }
        std::thread::sleep(BETWEEN_LOOKS);
    };
    Outcome {
        code,
        peak_bytes,
        elapsed: start.elapsed(),
        said: String::from_utf8_lossy(&std::fs::read(errors).unwrap()).into_owned(),
    }
}

/// The largest resident size of a process so far.
fn peak_of(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

fn check(cases: Vec<Case>) {
    let only = std::env::var("POINTREEL_ONLY_CASE").unwrap_or_default();
    let chosen = cases.into_iter().filter(|case| case.name.contains(&only));
    let failures: Vec<String> = chosen.flat_map(|case| case.failures()).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn sparse_files_of_gigabytes_are_rejected_by_size() {
    check(sparse::cases());
}

#[test]
fn files_that_just_fit_take_no_more_than_the_limit() {
    check(full::cases());
}

#[test]
fn bombs_take_no_more_than_the_limit() {
    check(bombs::cases());
}
