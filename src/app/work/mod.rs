//! Long-running work: tasks on their own threads, files that they write, and their progress bars.

pub(super) mod files;
pub(super) mod outcome;
pub(super) mod panel;
pub(super) mod pool;
pub(super) mod tasks;
pub(super) mod works;
