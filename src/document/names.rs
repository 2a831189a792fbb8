//! Names of changes, for undo: `Lighting Matt`.

use super::model::Document;
use super::parts::{PARTS, Part, SETTINGS};
use crate::scene::describe::{Described, Value, Values};

/// Max names in a menu entry.
const MAX_NAMED: usize = 2;

/// The parts that differ and undo takes back; of settings each that does, by its name in files.
pub(super) fn changed_fields(before: &Document, after: &Document) -> Vec<&'static str> {
    let parts = PARTS.iter().filter(|part| part.is_undone() && part.name != SETTINGS);
    let parts = parts.filter(|part| part.change(before, after).is_some());
    let settings = changed_settings(before, after).into_iter();
    parts
        .map(|part| part.name)
        .chain(settings.map(|(described, _)| described.key))
        .collect()
}

/// The settings that differ, with their new values.
fn changed_settings(before: &Document, after: &Document) -> Vec<(&'static Described, Value)> {
    if before.settings == after.settings {
        return Vec::new();
    }
    let settings = before.settings.settings().into_iter().zip(after.settings.settings());
    let changed = settings.filter(|((_, before), (_, after))| before != after);
    changed.map(|(_, after)| after).collect()
}

/// Name of the undoable change from `before` to `after`.
pub(super) fn name_of(before: &Document, after: &Document) -> String {
    named(before, after, Part::is_undone)
}

impl Document {
    /// Names of the changes from `before` to it: `Lighting Matt, Label`. Empty without any.
    pub fn changes_from(&self, before: &Self) -> String {
        named(before, self, |_| true)
    }
}

/// Names of the changes of the parts selected by `told`.
fn named(before: &Document, after: &Document, told: fn(&Part) -> bool) -> String {
    let others = PARTS.iter().filter(|part| part.name != SETTINGS && told(part));
    let changed = others.filter_map(|part| part.change(before, after));
    let mut names: Vec<String> = changed.map(str::to_owned).collect();
    match changed_settings(before, after)[..] {
        [] => {}
        [(described, value)] => names.push(name_of_setting(described, value)),
        ref changed => names.push(format!("{} settings", changed.len())),
    }
    if names.len() > MAX_NAMED {
        let more = names.len() - MAX_NAMED;
        names.truncate(MAX_NAMED);
        names.push(format!("{more} more"));
    }
    names.join(", ")
}

/// Title of a setting and its new value.
fn name_of_setting(described: &Described, value: Value) -> String {
    let title = if described.title.is_empty() {
        described.key
    } else {
        described.title
    };
    let value = match (&described.values, value) {
        (Values::Switch(word), Value::Switch(is_on)) => {
            let title = if word.is_empty() { title } else { word };
            return format!("{title} {}", if is_on { "on" } else { "off" });
        }
        (Values::Words(words), Value::Word(place)) => words.list[place].title.to_owned(),
        (Values::Number(numbers), Value::Number(number)) => numbers.told(number),
        (Values::Kinds(kinds), Value::Kind(place, number)) => match &kinds[place].number {
            Some(of_kind) => format!("{} {}", kinds[place].title, of_kind.numbers.told(number)),
            None => kinds[place].title.to_owned(),
        },
        (_, Value::Environment(environment)) => environment.to_string(),
        // Colours have no short names.
        _ => return title.to_owned(),
    };
    format!("{title} {value}")
}
