//! What is remembered of the connection of a live stream.

use crate::source::ConnectionWatch;

/// The connection of the open sequence, if that is a live stream.
#[derive(Debug, Default)]
pub(in crate::app) struct Connection {
    pub(in crate::app) watch: ConnectionWatch,
    /// What was said when it broke.
    pub(in crate::app) said: Option<String>,
}
