//! Element numbering: references of statements to elements defined before them.

/// The index that `word` names among `count`, if it exists. Numbers count from 1, negative ones backwards from the
/// last.
pub(super) fn resolve(word: &[u8], count: usize) -> Option<usize> {
    let number: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    let index = if number < 0 {
        (count as i64).checked_add(number)?
    } else {
        number - 1
    };
    usize::try_from(index)
        .ok()
        .filter(|&index| index < count && u32::try_from(index).is_ok())
}
