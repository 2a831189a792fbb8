//! Text as UTF-8, whatever it is stored as.

use std::borrow::Cow;

/// `bytes` without the mark of UTF-8, or those of UTF-16 (either byte order) as UTF-8.
pub(in crate::io) fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes {
        [0xff, 0xfe, text @ ..] => Cow::Owned(of_utf16(text, u16::from_le_bytes)),
        [0xfe, 0xff, text @ ..] => Cow::Owned(of_utf16(text, u16::from_be_bytes)),
        [0xef, 0xbb, 0xbf, text @ ..] | text => Cow::Borrowed(text),
    }
}

fn of_utf16(text: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let (units, _) = text.as_chunks::<2>();
    let decoded = char::decode_utf16(units.iter().map(|raw| unit(*raw)));
    let mut utf8 = String::with_capacity(units.len());
    utf8.extend(decoded.map(|sign| sign.unwrap_or(char::REPLACEMENT_CHARACTER)));
    utf8.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_all_encodings_is_the_same() {
        let text = "x;y;höhe\n1;2;3\n";
        let units: Vec<u16> = std::iter::once(0xfeff).chain(text.encode_utf16()).collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for bytes in [
            text.as_bytes(),
            &[b"\xef\xbb\xbf", text.as_bytes()].concat(),
            &little,
            &big,
        ] {
            assert_eq!(utf8(bytes), text.as_bytes());
        }
    }
}
