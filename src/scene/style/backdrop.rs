//! What is shown beside the cloud.

use super::background::Background;

/// What is shown beside the cloud.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Backdrop {
    /// What is behind it.
    pub background: Background,
    /// Whether lines show the ground.
    pub grid: bool,
}
