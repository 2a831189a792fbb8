//! Shared services of all features: the clock, tasks, dialogs, and window requests.

use super::dialogs::Dialogs;
use super::options::StateOptions;
use super::parts::{Counters, WindowRequest};
use crate::app::work::outcome::Outcome;
use crate::app::work::tasks::Tasks;
use crate::app::work::works::Works;
use std::sync::Arc;
use std::time::Duration;

/// State shared by all features.
#[derive(Debug)]
pub struct Shared {
    /// Long work with a bar, but for the benchmark.
    pub works: Works,
    /// Work done.
    pub counters: Counters,
    pub(in crate::app) tasks: Tasks<Outcome>,
    pub(in crate::app) dialogs: Dialogs,
    pub(in crate::app) options: StateOptions,
    pub(in crate::app) now: Duration,
    pub(in crate::app) requests: Vec<WindowRequest>,
}

impl Shared {
    pub(super) fn new(options: StateOptions) -> Self {
        Self {
            works: Works::default(),
            counters: Counters::default(),
            tasks: Tasks::new(Arc::clone(&options.wake)),
            dialogs: Dialogs::default(),
            options,
            now: Duration::ZERO,
            requests: Vec::new(),
        }
    }
}
