//! A bar on a terminal's stderr with the time left; nothing where no person looks.

use indicatif::{ProgressBar, ProgressStyle};

/// Progress bar of a subcommand over its frames.
pub(in crate::cli) struct Bar(ProgressBar);

impl Bar {
    /// A bar of `total` frames.
    pub(in crate::cli) fn new(total: usize) -> Self {
        let bar = ProgressBar::new(total as u64);
        let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left");
        Self(match style {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        })
    }

    /// `done` frames are done.
    pub(in crate::cli) fn set(&self, done: usize) {
        self.0.set_position(done as u64);
    }

    /// Takes the bar away.
    pub(in crate::cli) fn clear(&self) {
        self.0.finish_and_clear();
    }
}
