//! Names of changes, for undo: `Lighting Matt`.

use super::edited::{Edited, changed_fields};
use crate::scene::describe::{Described, Value, Values};

/// Names that a menu has room for.
const MAX_NAMED: usize = 2;

/// Name of the change from `before` to `after`.
pub(super) fn name_of(before: &Edited, after: &Edited) -> String {
    let fields = changed_fields(before, after);
    let settings = after.style.settings();
    let changed: Vec<&(&Described, Value)> = settings
        .iter()
        .filter(|(described, _)| fields.contains(&described.key))
        .collect();
    let parts = fields.iter().filter_map(|field| name_of_part(field, before, after));
    let mut names: Vec<String> = parts.collect();
    match changed[..] {
        [] => {}
        [&(described, value)] => names.push(name_of_setting(described, value)),
        _ => names.push(format!("{} settings", changed.len())),
    }
    if names.len() > MAX_NAMED {
        let more = names.len() - MAX_NAMED;
        names.truncate(MAX_NAMED);
        names.push(format!("{more} more"));
    }
    names.join(", ")
}

/// Name of a part that is no setting.
fn name_of_part(field: &str, before: &Edited, after: &Edited) -> Option<String> {
    let name = match field {
        "path" => "Camera path",
        "labels" if before.labels.len().abs_diff(after.labels.len()) > 1 => "Labels",
        "labels" => "Label",
        "markers" => "Markers",
        "range" => "In and out point",
        "notes" => "Notes",
        "clip" => "Clipping",
        _ => return None,
    };
    Some(name.to_owned())
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
        // Colours have no short words.
        _ => return title.to_owned(),
    };
    format!("{title} {value}")
}
