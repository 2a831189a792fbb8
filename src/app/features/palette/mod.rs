//! Commands by their names.

pub(in crate::app) mod panel;

use crate::app::command::{BINDINGS, Command};
use crate::app::open_panels::PanelId;
use egui::ThemePreference;

/// Commands that have no key.
const WITHOUT_KEYS: &[(&str, Command)] = &[
    ("Open a folder", Command::OpenFolder),
    ("Open the demo", Command::OpenDemo),
    ("Compare with a folder", Command::CompareFolder),
    ("Close comparison", Command::CloseComparison),
    ("Show or hide thumbnails over the timeline", Command::ToggleThumbnails),
    ("Make thumbnails anew", Command::RedoThumbnails),
    ("Show or hide the legend", Command::TogglePanel(PanelId::LEGEND)),
    ("Show or hide the scale bar", Command::ToggleScaleBar),
    ("Theme of the system", Command::Theme(ThemePreference::System)),
    ("Light theme", Command::Theme(ThemePreference::Light)),
    ("Dark theme", Command::Theme(ThemePreference::Dark)),
    ("Save a picture as a file of a name", Command::SaveScreenshotAs),
    ("Export the camera path", Command::ExportPath),
    ("New camera path", Command::NewPath),
    ("Open a camera path", Command::OpenPath),
    ("Save the camera path", Command::SavePath),
    ("Save the camera path as a file of a name", Command::SavePathAs),
];

/// What the palette offers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) struct CommandEntry {
    pub(in crate::app) text: &'static str,
    /// As a person reads them; empty without any.
    pub(in crate::app) keys: &'static str,
    pub(in crate::app) command: Command,
}

/// An open palette.
#[derive(Debug, Clone, Default)]
pub struct Palette {
    pub(in crate::app) query: String,
    /// Place of the chosen one among those found.
    pub(in crate::app) chosen: usize,
}

/// The commands that `query` finds, `more` among them: each of its words is there in the command's text, letter after
/// letter. Those that have the words as they are come first.
pub(in crate::app) fn find(query: &str, more: &[CommandEntry]) -> Vec<CommandEntry> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let with_keys = BINDINGS.iter().map(|binding| CommandEntry {
        text: binding.text,
        keys: binding.keys,
        command: binding.command,
    });
    let without = WITHOUT_KEYS.iter().map(|&(text, command)| CommandEntry {
        text,
        keys: "",
        command,
    });
    let mut found: Vec<(usize, CommandEntry)> = with_keys
        .chain(without)
        .chain(more.iter().copied())
        .filter(|entry| entry.command != Command::TogglePalette)
        .filter_map(|entry| {
            let text = entry.text.to_lowercase();
            let is_there = words.iter().all(|word| is_subsequence(word, &text));
            let scattered = words.iter().filter(|&word| !text.contains(word)).count();
            is_there.then_some((scattered, entry))
        })
        .collect();
    found.sort_by_key(|&(scattered, _)| scattered);
    found.into_iter().map(|(_, entry)| entry).collect()
}

/// Whether the letters of `word` are in `text` in their order.
fn is_subsequence(word: &str, text: &str) -> bool {
    let mut letters = text.chars();
    word.chars().all(|wanted| letters.any(|letter| letter == wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_by_their_letters() {
        assert!(is_subsequence("orth", "orthographic, perspective"));
        assert!(is_subsequence("ogc", "orthographic"));
        assert!(!is_subsequence("gog", "orthographic"));
        assert!(is_subsequence("", ""));
        let texts = |query: &str| -> Vec<&str> { find(query, &[]).into_iter().map(|entry| entry.text).collect() };
        assert_eq!(texts("next mark"), ["Next marker"]);
        assert_eq!(texts("MARK next"), ["Next marker"]);
        assert_eq!(texts("frme nxt"), ["Next frame"]);
        assert_eq!(texts("no such thing at all"), [""; 0]);
        // As they are before letters scattered over the text.
        assert_eq!(texts("left")[0], "Left");
        assert_eq!(texts("").len(), BINDINGS.len() - 1 + WITHOUT_KEYS.len());
    }
}
