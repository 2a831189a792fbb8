//! JSON formatting for people who read and edit it: one line per field of the session, per setting and per label.

use serde_json::Value;
use std::fmt::Write as _;

/// An object of these fields, in this order, whose values are on one line each where they hold no objects.
pub(super) fn of_fields<'a>(fields: impl IntoIterator<Item = (&'a str, &'a Value)>) -> String {
    let mut text = String::new();
    write_object(&mut text, &mut fields.into_iter(), 0);
    text.push('\n');
    text
}

fn write_object<'a>(text: &mut String, fields: &mut dyn Iterator<Item = (&'a str, &'a Value)>, depth: usize) {
    // JSON, like settings, presets and paths: TOML would be friendlier to write, but a second format for the same
    // values. One entry per line, so that versions can be diffed.
    text.push('{');
    let mut is_first = true;
    for (name, value) in fields {
        next(text, &mut is_first, depth + 1);
        write_name(text, name);
        match value {
            // A list of objects: one per line.
            Value::Array(list) if list.iter().any(Value::is_object) => {
                text.push('[');
                let mut is_first = true;
                for entry in list {
                    next(text, &mut is_first, depth + 2);
                    write_in_line(text, entry);
                }
                end(text, depth + 1);
                text.push(']');
            }
            Value::Object(object) if depth == 0 && !object.is_empty() => {
                let mut fields = object.iter().map(|(name, value)| (name.as_str(), value));
                write_object(text, &mut fields, depth + 1);
            }
            value => write_in_line(text, value),
        }
    }
    if !is_first {
        end(text, depth);
    }
    text.push('}');
}

fn next(text: &mut String, is_first: &mut bool, depth: usize) {
    if !std::mem::take(is_first) {
        text.push(',');
    }
    end(text, depth);
}

fn end(text: &mut String, depth: usize) {
    text.push('\n');
    text.push_str(&"  ".repeat(depth));
}

fn write_name(text: &mut String, name: &str) {
    // Writing to a String cannot fail; a Value quotes itself.
    let _ = write!(text, "{}: ", Value::from(name));
}

fn write_in_line(text: &mut String, value: &Value) {
    match value {
        Value::Array(list) => {
            text.push('[');
            for (index, entry) in list.iter().enumerate() {
                text.push_str(if index == 0 { "" } else { ", " });
                write_in_line(text, entry);
            }
            text.push(']');
        }
        Value::Object(object) => {
            text.push('{');
            for (index, (name, value)) in object.iter().enumerate() {
                text.push_str(if index == 0 { "" } else { ", " });
                write_name(text, name);
                write_in_line(text, value);
            }
            text.push('}');
        }
        value => _ = write!(text, "{value}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    #[test]
    fn lists_of_objects_and_top_level_objects_have_one_line_per_entry() {
        let [a, b, c] = [
            json!([{"x": 1, "y": [1, 2.5]}, {"x": "q\"\n"}]),
            json!({"n": {"deep": [true, null]}, "m": []}),
            json!([]),
        ];
        let text = of_fields([("a", &a), ("b", &b), ("c", &c)]);
        let expected = r#"{
  "a": [
    {"x": 1, "y": [1, 2.5]},
    {"x": "q\"\n"}
  ],
  "b": {
    "m": [],
    "n": {"deep": [true, null]}
  },
  "c": []
}
"#;
        assert_eq!(text, expected);
        assert_eq!(of_fields([]), "{}\n");
    }

    fn value() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            (-1e12f64..1e12).prop_map(Value::from),
            ".*".prop_map(Value::from),
        ];
        leaf.prop_recursive(4, 40, 6, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
                prop::collection::btree_map(".{0,5}", inner, 0..6)
                    .prop_map(|fields| Value::Object(fields.into_iter().collect())),
            ]
        })
    }

    proptest! {
        /// Round trip through the parser: any formatted text is the same JSON.
        #[test]
        fn formatting_preserves_the_values(fields in prop::collection::btree_map(".{0,8}", value(), 0..6)) {
            let text = of_fields(fields.iter().map(|(name, value)| (name.as_str(), value)));
            let read: std::collections::BTreeMap<String, Value> = serde_json::from_str(&text).unwrap();
            prop_assert_eq!(read, fields);
        }
    }
}
