//! Opening facts: how the open sequence was opened, and its known properties.

use super::connection::Connection;
use super::failed_opening::{FailedOpening, Unproven};
use super::keeper::Keeper;
use super::measured_way::MeasuredWay;
use super::opened::{Opened, SessionQuestion};
use crate::app::first_look::SequenceLook;

/// Facts about how the open sequence was opened, derived properties, and failures to open.
#[derive(Debug, Default)]
pub struct OpeningFacts {
    /// Input that was last to be opened and cannot be shown.
    pub failed: Option<FailedOpening>,
    /// The session that is not opened before the user allows its inputs.
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
    /// The connection of the open sequence, of live streams.
    pub(in crate::app) connection: Connection,
}
