//! Names made different from each other.

use std::collections::{HashMap, HashSet};

/// Names that are taken. Finding a free one takes no longer where thousands are the same.
#[derive(Debug, Default)]
pub(in crate::io) struct UniqueNames {
    taken: HashSet<String>,
    /// The next number to try behind a name.
    next: HashMap<String, usize>,
}

impl UniqueNames {
    /// Names that are known to be needed: no other one is made equal to them.
    pub(in crate::io) fn reserving(names: impl Iterator<Item = String>) -> Self {
        Self {
            taken: names.collect(),
            ..Self::default()
        }
    }

    /// `name`, or `name_2` and so on where one with the same `key` is taken; takes it.
    pub(in crate::io) fn take(&mut self, name: &str, key: impl Fn(&str) -> String) -> String {
        if self.taken.insert(key(name)) {
            return name.to_owned();
        }
        self.numbered(name, key)
    }

    /// `name_2` or the first one behind it that is free; takes it.
    pub(in crate::io) fn numbered(&mut self, name: &str, key: impl Fn(&str) -> String) -> String {
        let next = self.next.entry(key(name)).or_insert(2);
        loop {
            let numbered = format!("{name}_{next}");
            *next += 1;
            if self.taken.insert(key(&numbered)) {
                return numbered;
            }
        }
    }
}

/// Returns the warning about properties or fields of the same name: the position of each, its name, and its new name.
pub(in crate::io) fn duplicate_warning(owner: &str, duplicates: &[(usize, String, String)]) -> Option<String> {
    /// Max number of names in the message.
    const MAX_NAMED: usize = 8;
    let (line, _, _) = duplicates.first()?;
    let named = duplicates.iter().take(MAX_NAMED);
    let named: Vec<String> = named.map(|(_, name, new)| format!("`{name}` (now `{new}`)")).collect();
    let more = duplicates.len() - named.len();
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    Some(format!(
        "line {line}: {owner} more than once: {}{more}; the first of a name is taken for it",
        named.join(", ")
    ))
}
