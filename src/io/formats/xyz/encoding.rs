//! Text as UTF-8 with line feeds, from any encoding.

use std::borrow::Cow;

/// `bytes` without the byte order mark of UTF-8, or converted from UTF-16 (either byte order, with or without mark).
/// Lines that end in carriage returns alone, as old Macs and some instruments write them, end in line feeds.
pub(in crate::io) fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let text = match bytes {
        [0xff, 0xfe, text @ ..] => Cow::Owned(of_utf16(text, u16::from_le_bytes)),
        [0xfe, 0xff, text @ ..] => Cow::Owned(of_utf16(text, u16::from_be_bytes)),
        [0xef, 0xbb, 0xbf, text @ ..] | text => match unmarked_utf16(text) {
            Some(unit) => Cow::Owned(of_utf16(text, unit)),
            None => Cow::Borrowed(text),
        },
    };
    with_line_feeds(text)
}

fn of_utf16(text: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let (units, _) = text.as_chunks::<2>();
    let decoded = char::decode_utf16(units.iter().map(|raw| unit(*raw)));
    let mut utf8 = String::with_capacity(units.len());
    utf8.extend(decoded.map(|sign| sign.unwrap_or(char::REPLACEMENT_CHARACTER)));
    utf8.into_bytes()
}

/// The byte order of UTF-16 without a mark: of numbers in it every second byte is zero.
fn unmarked_utf16(text: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    const LOOKED_AT_BYTES: usize = 512;
    const MIN_BYTES: usize = 8;
    let head = &text[..text.len().min(LOOKED_AT_BYTES)];
    let (pairs, _) = head.as_chunks::<2>();
    if head.len() < MIN_BYTES {
        return None;
    }
    let zeros = |place: usize| pairs.iter().filter(|pair| pair[place] == 0).count();
    let is_max = |count: usize| count * 10 >= pairs.len() * 9;
    match (zeros(0), zeros(1)) {
        (0, high) if is_max(high) => Some(u16::from_le_bytes),
        (high, 0) if is_max(high) => Some(u16::from_be_bytes),
        _ => None,
    }
}

fn with_line_feeds(text: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    const LOOKED_AT_BYTES: usize = 64 << 10;
    let head = &text[..text.len().min(LOOKED_AT_BYTES)];
    if head.contains(&b'\n') || !head.contains(&b'\r') {
        return text;
    }
    let mut text = text.into_owned();
    for byte in text.iter_mut().filter(|byte| **byte == b'\r') {
        *byte = b'\n';
    }
    Cow::Owned(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_encodings_give_the_same_text() {
        let text = "x;y;höhe\n1;2;3\n";
        let units: Vec<u16> = std::iter::once(0xfeff).chain(text.encode_utf16()).collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for bytes in [
            text.as_bytes(),
            &[b"\xef\xbb\xbf", text.as_bytes()].concat(),
            &little,
            &big,
            // Without the byte order mark.
            &little[2..],
            &big[2..],
        ] {
            assert_eq!(utf8(bytes), text.as_bytes());
        }
    }

    #[test]
    fn carriage_returns_alone_end_lines() {
        assert_eq!(utf8(b"1 2 3\r4 5 6\r"), b"1 2 3\n4 5 6\n".as_slice());
        let crlf = b"1 2 3\r\n4 5 6\r\n".as_slice();
        assert_eq!(utf8(crlf), crlf);
    }
}
