//! Errors of frame sources.

use std::path::PathBuf;

/// One of several sequences that an input may mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpeningChoice {
    /// For people, such as `body_* (24 files)`.
    pub label: String,
    /// The option of the command line that chooses it, if one does; else its path is the input.
    pub option: Option<String>,
    /// The folder or pattern that names it.
    pub input: PathBuf,
}

/// Choices that a message names, one per line.
/// Whether a choice is one file, and no pattern of several.
fn is_one_file(choice: &OpeningChoice) -> bool {
    choice.option.is_some() && !choice.label.ends_with(" files)")
}

fn listed(choices: &[OpeningChoice]) -> String {
    const NAMED_CHOICES: usize = 12;
    let line = |choice: &OpeningChoice| match &choice.option {
        Some(option) => format!("\n  {}: {option}", choice.label),
        None => format!("\n  {}", choice.label),
    };
    let mut lines: String = choices.iter().take(NAMED_CHOICES).map(line).collect();
    if choices.len() > NAMED_CHOICES {
        lines.push_str("\n  …");
    }
    lines
}

/// Reasons why a sequence cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SequenceError {
    /// No input was named.
    #[error("no input was given: name a folder of frames, a file, or a pattern such as 'scan_*.ply'")]
    NoInput,
    /// A path that is not there.
    #[error("{} does not exist: expected a folder of frames, a file or a pattern such as 'scan_*.ply'", path.display())]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// A folder in which no file is a point cloud by its extension.
    #[error("no point cloud is in the folder {} (looked for {extensions}): {hint}", path.display())]
    EmptyFolder {
        /// The folder as given.
        path: PathBuf,
        /// Filename patterns that were searched for, such as `*.ply, *.pcd`.
        extensions: String,
        /// Suggested remedy.
        hint: String,
    },
    /// A folder with several sequences.
    #[error(
        "{} holds {} {}, which are not played one after the other: choose one of{}",
        path.display(),
        choices.len(),
        if choices.iter().all(is_one_file) { "clouds of different things" } else { "sequences" },
        listed(choices)
    )]
    Several {
        /// The folder as given.
        path: PathBuf,
        /// The sequences.
        choices: Vec<OpeningChoice>,
    },
    /// A file of `--poses` that does not fit.
    #[error("{}: {reason}", path.display())]
    Poses {
        /// The file.
        path: PathBuf,
        /// Reason for the error.
        reason: String,
    },
    /// A pattern of `--only` that no file has.
    #[error("no file name matches --only '{pattern}': there are {found}")]
    NothingOnly {
        /// The pattern as given.
        pattern: String,
        /// Names of some files.
        found: String,
    },
    /// A folder whose files are known, and not read.
    #[error("the folder {} holds no point cloud that is read: {found}", path.display())]
    ForeignFolder {
        /// The folder as given.
        path: PathBuf,
        /// Its kinds of files, with the way to readable files.
        found: String,
    },
    /// A pattern without a match.
    #[error("no file matches {pattern}: check the pattern, or name the folder instead")]
    NoMatch {
        /// The pattern as given.
        pattern: String,
    },
    /// A pattern that is not one.
    #[error("{pattern} is not a valid pattern ({reason}): put [ and ] around the characters * ? [ to mean themselves")]
    BadPattern {
        /// The pattern as given.
        pattern: String,
        /// Reason for the error.
        reason: String,
    },
    /// A topic that no recording among the inputs has.
    #[error("no point clouds on topic {topic}: {hint}")]
    NoTopic {
        /// The topic as given.
        topic: String,
        /// Hint listing the available choices.
        hint: String,
    },
    /// Frames are to be generated, but their kind is unknown.
    #[error("{input} is nothing that can be made: name {known}")]
    NotGenerated {
        /// The input as given.
        input: String,
        /// All that can be made.
        known: String,
    },
    /// A sequence file that cannot be opened.
    #[error(transparent)]
    Reel(Box<crate::reel::ReelError>),
    /// LiDAR sensor that cannot be listened to.
    #[error("{input}: {problem}")]
    Scanner {
        /// The input as given.
        input: String,
        /// Description of the problem and the remedy.
        problem: String,
    },
    /// A live stream, a recording of one, or standard input, that cannot be opened.
    #[error("{input}: {problem}")]
    Stream {
        /// The input as given.
        input: String,
        /// Description of the problem and the remedy.
        problem: String,
    },
    /// A recording of depth images that cannot be opened.
    #[error(transparent)]
    Rgbd(Box<super::rgbd::RgbdError>),
    /// Images that cannot be opened.
    #[error(transparent)]
    Photos(Box<crate::photos::PhotosError>),
    /// A sequence file among other inputs.
    #[error(
        "{} holds a whole sequence: open it alone, or join it with others by pointreel convert --join",
        path.display()
    )]
    NotAlone {
        /// The sequence file.
        path: PathBuf,
    },
    /// A folder or path that the system does not let us look into.
    #[error("{} cannot be listed ({reason}): check its permissions", path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// Somebody cancelled it.
    #[error("opening was cancelled")]
    Cancelled,
    /// The system gives no thread to load frames on.
    #[error("no thread could be started to load frames ({reason}): close other programs or raise the process limit")]
    NoThread {
        /// The system's reason.
        reason: std::io::Error,
    },
}
