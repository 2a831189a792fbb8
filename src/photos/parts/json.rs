//! Numbers of JSON as programs write them: some as numbers, some as text.

use crate::photos::error::{PhotosError, read_file};
use serde_json::Value;
use std::path::Path;

/// The value in the file `path`.
pub(in crate::photos) fn read(path: &Path) -> Result<Value, PhotosError> {
    let file = read_file(path)?;
    // The byte order mark that some editors write.
    let text = file.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&file);
    let read = serde_json::from_slice(text).or_else(|error| match without_non_numbers(text) {
        Some(text) => serde_json::from_slice(&text),
        None => Err(error),
    });
    read.map_err(|source| PhotosError::Json {
        path: path.into(),
        source,
    })
}

/// The text with `null` for Python's non-finite numbers (`NaN`, `-Infinity`), which JSON does not have; `None` if it
/// contains none of these.
fn without_non_numbers(text: &[u8]) -> Option<Vec<u8>> {
    /// Longer ones first.
    const NON_NUMBERS: [&[u8]; 4] = [b"-Infinity", b"Infinity", b"-NaN", b"NaN"];
    let mut replaced = Vec::with_capacity(text.len());
    let (mut at, mut is_text, mut count) = (0, false, 0);
    while let Some(&byte) = text.get(at) {
        let found = NON_NUMBERS.iter().find(|word| !is_text && text[at..].starts_with(word));
        if let Some(word) = found {
            replaced.extend(b"null");
            at += word.len();
            count += 1;
            continue;
        }
        // A character after a backslash does not end the string.
        if is_text && byte == b'\\' {
            replaced.push(byte);
            at += 1;
            replaced.extend(text.get(at));
            at += 1;
            continue;
        }
        is_text ^= byte == b'"';
        replaced.push(byte);
        at += 1;
    }
    (count > 0).then_some(replaced)
}

/// A finite number, be it text.
pub(in crate::photos) fn number(value: &Value) -> Option<f64> {
    let number = match value {
        Value::Number(number) => number.as_f64()?,
        Value::String(text) => text.trim().parse().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

/// The number `key` of an object.
pub(in crate::photos) fn number_at(object: &Value, key: &str) -> Option<f64> {
    number(object.get(key)?)
}

/// `N` numbers of an array.
pub(in crate::photos) fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let array = value.as_array()?;
    let numbers: Vec<f64> = array.iter().map_while(number).collect();
    (array.len() == N).then_some(numbers)?.try_into().ok()
}

/// The `N` numbers `key` of an object.
pub(in crate::photos) fn numbers_at<const N: usize>(object: &Value, key: &str) -> Option<[f64; N]> {
    numbers(object.get(key)?)
}

/// A whole number of pixels above 0.
pub(in crate::photos) fn side(number: f64) -> Option<u32> {
    (number >= 1.0 && number <= f64::from(u32::MAX)).then_some(number as u32)
}

/// Returns the value of `key` of an object in the form in which it is compared: numbers and texts of the same digits
/// are equal.
pub(in crate::photos) fn key_at(object: &Value, key: &str) -> Option<String> {
    match object.get(key)? {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

/// The elements of the array `key`; none without such an array.
pub(in crate::photos) fn array_at<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nan_and_infinity_written_by_python_become_null() {
        let text = br#"{"a": [NaN, -Infinity, Infinity, 1e3], "b": "NaN \" NaN", "c": -NaN}"#;
        let replaced = without_non_numbers(text).unwrap();
        let value: Value = serde_json::from_slice(&replaced).unwrap();
        assert_eq!(
            value,
            json!({"a": [null, null, null, 1e3], "b": "NaN \" NaN", "c": null})
        );
        assert_eq!(without_non_numbers(br#"{"a": "NaN"}"#), None);
    }

    #[test]
    fn numbers_may_be_strings() {
        let object =
            json!({"a": "1.5", "b": 1.5, "c": [1, "2"], "d": "x", "e": "nan", "f": null, "id": 7, "name": "7"});
        assert_eq!(
            (number_at(&object, "a"), number_at(&object, "b")),
            (Some(1.5), Some(1.5))
        );
        assert_eq!(numbers_at(&object, "c"), Some([1.0, 2.0]));
        assert_eq!(numbers_at::<3>(&object, "c"), None);
        for none in ["d", "e", "f", "g"] {
            assert_eq!(number_at(&object, none), None, "{none}");
        }
        assert_eq!(key_at(&object, "id"), key_at(&object, "name"));
        assert_eq!(
            (side(640.0), side(0.0), side(-1.0), side(1e30)),
            (Some(640), None, None, None)
        );
    }
}
