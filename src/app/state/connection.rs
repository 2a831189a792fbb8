//! What is remembered of the connection of a live stream.

use crate::source::ConnectionWatch;

/// The connection of the open sequence, if that is a live stream.
#[derive(Debug, Default)]
pub(super) struct Connection {
    pub(super) watch: ConnectionWatch,
    /// What was said when it broke.
    pub(super) said: Option<String>,
}
