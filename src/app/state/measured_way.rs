//! Render mode that was chosen by its measured time and error, and the settings before it.

use crate::scene::Settings;
use crate::scene::describe::{Described, Value};

/// The settings before a measured mode was chosen, and with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) struct MeasuredWay {
    pub(in crate::app) before: Settings,
    pub(in crate::app) chosen: Settings,
}

impl MeasuredWay {
    /// `now` with the settings from before the mode was chosen, except for those that were changed by hand since.
    pub(in crate::app) fn undone(&self, mut now: Settings) -> Settings {
        let before = self.before.settings();
        let chosen = self.chosen.settings();
        now.edit(&mut |described, value| {
            let of = |settings: &[(&Described, Value)]| {
                let known = settings.iter().find(|(other, _)| other.key == described.key);
                known.map(|&(_, value)| value)
            };
            match (of(&before), of(&chosen)) {
                (Some(before), Some(chosen)) if chosen == value => before,
                _ => value,
            }
        });
        now
    }
}
