//! A word now and then about a walk over a file that takes long: recordings may have terabytes, and nothing is to be
//! seen of them before their last record was met.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time before the first word, and between two.
const BETWEEN_WORDS: Duration = Duration::from_secs(5);

/// Steps between two checks of the clock.
const STEPS_PER_LOOK: u32 = 256;

/// A walk from the beginning of a file to its end.
#[derive(Debug)]
pub(crate) struct LongWalk {
    path: PathBuf,
    file_bytes: u64,
    steps: u32,
    last_word: Instant,
}

impl LongWalk {
    /// At the beginning of the file at `path`.
    pub(crate) fn new(path: &Path, file_bytes: u64) -> Self {
        Self {
            path: path.to_owned(),
            file_bytes,
            steps: 0,
            last_word: Instant::now(),
        }
    }

    /// A step that has led to `position`.
    pub(crate) fn step(&mut self, position: u64) {
        self.steps = self.steps.wrapping_add(1);
        if !self.steps.is_multiple_of(STEPS_PER_LOOK) || self.last_word.elapsed() < BETWEEN_WORDS {
            return;
        }
        self.last_word = Instant::now();
        log::warn!("{}", self.word(position));
    }

    fn word(&self, position: u64) -> String {
        let percent = 100.0 * position as f64 / self.file_bytes.max(1) as f64;
        format!(
            "{}: looking for its frames, {percent:.0} % of {:.1} GB so far",
            self.path.display(),
            self.file_bytes as f64 * 1e-9
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_status_line_names_the_file_and_progress() {
        let walk = LongWalk::new(Path::new("a.mcap"), 2_000_000_000);
        assert_eq!(
            walk.word(500_000_000),
            "a.mcap: looking for its frames, 25 % of 2.0 GB so far"
        );
        assert!(LongWalk::new(Path::new("a"), 0).word(0).contains("0 %"));
    }
}
