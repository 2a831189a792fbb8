//! State that persists between runs of the program.

use crate::app::presets::Presets;
use crate::app::reading_choices::ReadingChoices;
use crate::app::recent::Recent;

/// Lists that persist between runs of the program, apart from the settings.
#[derive(Debug, Clone)]
pub struct Stored {
    /// Recently opened inputs.
    pub recent: Recent,
    /// Options of reading that were chosen for inputs.
    pub reading_choices: ReadingChoices,
    /// Settings under names.
    pub presets: Presets,
    /// The name of the preset that is being saved.
    pub(in crate::app) preset_name: Option<String>,
}
