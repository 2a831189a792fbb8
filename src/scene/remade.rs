//! Content that is made from other content, and remade when that or a setting changes.

use super::Content;

/// The last content made with a setting.
#[derive(Debug)]
pub(in crate::scene) struct Remade<K> {
    last: Option<Last<K>>,
}

#[derive(Debug)]
struct Last<K> {
    key: K,
    from: Content,
    made: Content,
}

impl<K> Default for Remade<K> {
    fn default() -> Self {
        Self { last: None }
    }
}

impl<K: PartialEq> Remade<K> {
    /// Returns what `make` makes of `from` with the setting `key`: the same allocations as long as both stay the same,
    /// so that records are not uploaded again.
    pub(in crate::scene) fn get(
        &mut self,
        key: K,
        from: Content,
        make: impl FnOnce(&K, &Content) -> Content,
    ) -> Content {
        let known = self.last.take().filter(|last| last.key == key && last.from == from);
        let last = known.unwrap_or_else(|| Last {
            made: make(&key, &from),
            key,
            from,
        });
        let made = last.made.clone();
        self.last = Some(last);
        made
    }
}
