//! Long work: tasks on threads of their own, files that they write, and the bars that say how far they are.

pub(super) mod files;
pub(super) mod outcome;
pub(super) mod panel;
pub(super) mod pool;
pub(super) mod tasks;
pub(super) mod works;
