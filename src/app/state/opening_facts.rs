//! Opening facts: how the open sequence came to be open, and what is known of it.

use super::connection::Connection;
use super::failed_opening::{FailedOpening, Unproven};
use super::keeper::Keeper;
use super::measured_way::MeasuredWay;
use super::opened::{Opened, SessionQuestion};
use crate::app::first_look::SequenceLook;

/// Facts about how the open sequence was opened, what was derived from it, and what could not be opened.
#[derive(Debug, Default)]
pub struct OpeningFacts {
    /// Input that was last to be opened and cannot be shown.
    pub failed: Option<FailedOpening>,
    /// The session that is not opened before somebody allows what it opens.
    pub session_question: Option<SessionQuestion>,
    /// Look derived for the open sequence.
    pub(in crate::app) looked: SequenceLook,
    /// Opening details of the open sequence.
    pub(in crate::app) opened: Opened,
    /// Save state of its document.
    pub(super) keeper: Keeper,
    /// See [`super::State::prove`].
    pub(in crate::app) unproven: Unproven,
    /// Measured render mode that is used for the open sequence.
    pub(in crate::app) measured_way: Option<MeasuredWay>,
    /// That of the open sequence, of live streams.
    pub(in crate::app) connection: Connection,
}
