//! How the open sequence came to be open, and what is known of it.

use super::connection::Connection;
use super::failed_opening::{FailedOpening, Unproven};
use super::keeper::Keeper;
use super::measured_way::MeasuredWay;
use super::opened::{Opened, SessionQuestion};
use crate::app::first_look::SequenceLook;

/// How the open sequence was opened, what was made of it, and what could not be opened.
#[derive(Debug, Default)]
pub struct OpeningFacts {
    /// What was to be opened last, and cannot be shown.
    pub failed: Option<FailedOpening>,
    /// The session that is not opened before somebody allows what it opens.
    pub session_question: Option<SessionQuestion>,
    /// What is made of the open sequence.
    pub(in crate::app) looked: SequenceLook,
    /// How the open sequence was opened.
    pub(in crate::app) opened: Opened,
    /// How its document is kept.
    pub(super) keeper: Keeper,
    /// See [`super::State::prove`].
    pub(in crate::app) unproven: Unproven,
    /// The way to draw that was measured and is used for the open sequence.
    pub(in crate::app) measured_way: Option<MeasuredWay>,
    /// That of the open sequence, of live streams.
    pub(in crate::app) connection: Connection,
}
