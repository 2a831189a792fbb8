//! Changes of files by their contents: numbers in bytes, words in text, values in JSON.

mod binary;
mod json;
mod text;

use crate::random::Random;

/// Contents of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Binary,
    Text,
    Json,
    /// A head of text, and bytes behind it.
    TextHead,
}

/// No mutation makes a file larger than this.
const MAX_BYTES: usize = 1 << 20;

/// Changes `bytes`; `other` is a file of the same kind, parts of it may be inserted into this one.
pub(crate) fn mutate(shape: Shape, bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let changes = [1, 1, 1, 2, 3, 6][random.below(6)];
    for _ in 0..changes {
        match shape {
            Shape::Text => text::mutate(bytes, other, random),
            Shape::TextHead if random.one_in(2) => text::mutate_head(bytes, random),
            Shape::TextHead | Shape::Binary => binary::mutate(bytes, other, random),
            Shape::Json if random.one_in(5) => text::mutate(bytes, other, random),
            Shape::Json => json::mutate(bytes, random),
        }
        bytes.truncate(MAX_BYTES);
    }
}
