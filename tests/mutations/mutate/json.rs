//! Changes of the values of JSON, so that the result is still JSON.

use super::text;
use crate::random::Random;
use serde_json::{Value, json};

/// Changes `bytes` once: a value somewhere in it.
pub(super) fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    let Ok(mut value) = serde_json::from_slice::<Value>(bytes) else {
        return text::mutate(bytes, &[], random);
    };
    let count = count(&value);
    let mut place = random.below(count);
    change(&mut value, &mut place, random);
    if let Ok(written) = serde_json::to_vec_pretty(&value) {
        *bytes = written;
    }
}

/// Values in `value`, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(list) => list.iter().map(count).sum(),
        Value::Object(fields) => fields.values().map(count).sum(),
        _ => 0,
    }
}

/// Changes the value after `place` others. Returns true if it was found.
fn change(value: &mut Value, place: &mut usize, random: &mut Random) -> bool {
    if *place == 0 {
        change_here(value, random);
        return true;
    }
    *place -= 1;
    match value {
        Value::Array(list) => list.iter_mut().any(|value| change(value, place, random)),
        Value::Object(fields) => fields.values_mut().any(|value| change(value, place, random)),
        _ => false,
    }
}

fn change_here(value: &mut Value, random: &mut Random) {
    match value {
        Value::Array(list) if !list.is_empty() && !random.one_in(4) => {
            let place = random.below(list.len());
            match random.below(4) {
                0 => drop(list.remove(place)),
                1 => {
                    let other = random.below(list.len());
                    list.swap(place, other);
                }
                _ => {
                    let repeated = list[place].clone();
                    let times = [1, 2, 30, 2000][random.below(4)];
                    list.extend(std::iter::repeat_n(repeated, times));
                }
            }
        }
        Value::Object(fields) if !fields.is_empty() && !random.one_in(4) => {
            let names: Vec<String> = fields.keys().cloned().collect();
            let name = random.pick(&names).clone();
            match random.below(3) {
                0 => drop(fields.remove(&name)),
                1 => {
                    let other = random.pick(&names).clone();
                    let copied = fields[&other].clone();
                    fields.insert(name, copied);
                }
                _ => drop(fields.insert(format!("{name}_"), json!([1, "x", null]))),
            }
        }
        Value::Number(number) if random.one_in(2) => {
            let number = number.as_f64().unwrap_or(0.0);
            let factor = *random.pick(&[-1.0, 0.0, 0.5, 2.0, 1e3, 1e9, 1e-9, 1e20, 1e300]);
            *value = json!(number * factor);
        }
        Value::String(text) if random.one_in(2) => {
            let numbers_apart = text.split_inclusive(|letter: char| !letter.is_alphanumeric());
            let mut parts: Vec<String> = numbers_apart.map(str::to_owned).collect();
            if parts.is_empty() {
                return;
            }
            let place = random.below(parts.len());
            let part = *random.pick(&["", "nan", "1e999", "-1", "..", "/", "\u{1b}[31m", "é", "0"]);
            part.clone_into(&mut parts[place]);
            *text = parts.concat();
        }
        _ => *value = other(random),
    }
}

fn other(random: &mut Random) -> Value {
    match random.below(14) {
        0 => Value::Null,
        1 => json!(true),
        2 => json!(0),
        3 => json!(-1),
        4 => json!(u64::MAX),
        5 => json!(i64::MIN),
        6 => json!(1e308),
        7 => json!(-1e-308),
        8 => json!(1u64 << 32),
        9 => json!(""),
        10 => json!("x".repeat(1 << random.below(12))),
        11 => json!([]),
        12 => json!({}),
        _ => {
            let mut deep = json!(1);
            for _ in 0..random.below(200) {
                deep = json!([deep]);
            }
            deep
        }
    }
}
