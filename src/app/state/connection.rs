//! Connection state of a live stream.

use crate::source::ConnectionWatch;

/// The connection of the open sequence, if that is a live stream.
#[derive(Debug, Default)]
pub(in crate::app) struct Connection {
    pub(in crate::app) watch: ConnectionWatch,
    /// Message reported when the connection broke.
    pub(in crate::app) said: Option<String>,
}
