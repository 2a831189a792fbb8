//! Text from files, for display: control characters that a terminal would obey are shown as escapes.
//!
//! **How it works.** Control characters (C0 but line breaks and tabulators, DEL, C1) move the cursor, colour and clear
//! terminals, and set their titles; marks of direction (Unicode, UAX 9) make a name read backwards, `gpj.exe` as
//! `exe.jpg`. Each becomes its escape as in JSON, `\u001b`, so that text which is JSON stays that. Names are cleaned
//! when read from a file ([`name`]), and all output of the command line again ([`text`]).

use std::borrow::Cow;
use std::fmt::Write as _;

/// Returns true for a control character that a terminal may act on, or that may reorder the surrounding text.
fn is_acting(c: char) -> bool {
    let is_direction = matches!(
        c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    // Other line breaks.
    let is_break = matches!(c, '\u{2028}' | '\u{2029}');
    c.is_control() || is_direction || is_break
}

fn escaped(text: &str, stays: impl Fn(char) -> bool) -> Option<String> {
    let acts = |c: char| is_acting(c) && !stays(c);
    if !text.contains(acts) {
        return None;
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if acts(c) {
            // Writing to a String cannot fail.
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Some(shown)
}

/// Text of several lines, with nothing in it that a terminal obeys.
pub(crate) fn text(text: &str) -> Cow<'_, str> {
    match escaped(text, |c| matches!(c, '\n' | '\t')) {
        Some(shown) => Cow::Owned(shown),
        None => Cow::Borrowed(text),
    }
}

/// Sanitises the single-line name of something in a file, such as a frame or field.
pub(crate) fn name(name: String) -> String {
    escaped(&name, |_| false).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        for (given, shown) in [
            ("scan_01.ply", "scan_01.ply"),
            ("größe ΔΩ 点群 🚗", "größe ΔΩ 点群 🚗"),
            ("\u{1b}[2J\u{1b}]0;root\u{7}x", "\\u001b[2J\\u001b]0;root\\u0007x"),
            ("a\rb\u{7f}\u{9b}31m", "a\\u000db\\u007f\\u009b31m"),
            ("\u{202e}ylp.x\u{2066}\u{200f}", "\\u202eylp.x\\u2066\\u200f"),
            ("one\n\ttwo", "one\n\ttwo"),
        ] {
            assert_eq!(text(given), shown);
        }
        assert_eq!(name("f\nerror: \u{1b}c".to_owned()), "f\\u000aerror: \\u001bc");
        assert_eq!(name("intensity".to_owned()), "intensity");
    }

    #[test]
    fn escaped_json_stays_valid() {
        let value = serde_json::json!({ "name": "\u{1b}[31m\u{9b}\u{202e}\n\u{7f}" });
        let shown = text(&value.to_string()).into_owned();
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }
}
