//! The memory of reading a file, checked against the limit before it is allocated.
//!
//! [`ReadOptions::max_memory_bytes`] is the limit of the peak, not of the file. Readers declare memory already in use
//! ([`ReadOptions::holding`]: the file, its unpacked bytes, parsed columns) and ask before every further allocation
//! ([`ReadOptions::claim`], [`ReadOptions::reserve`]): a claim that does not fit is refused with a message.

use crate::io::error::Fault;
use crate::io::options::ReadOptions;

impl ReadOptions {
    /// Returns the options with a memory budget reduced by `bytes` that stay in memory until the reading ends.
    pub(in crate::io) fn holding(self, bytes: usize) -> Self {
        Self {
            held_bytes: self.held_bytes.saturating_add(bytes as u64),
            ..self
        }
    }

    /// Bytes that may still be taken.
    pub(in crate::io) fn left_bytes(&self) -> u64 {
        self.max_memory_bytes.saturating_sub(self.held_bytes)
    }

    /// Fails if `bytes` more, for `what`, exceed the limit.
    pub(in crate::io) fn claim(&self, what: &str, bytes: u64) -> Result<(), Fault> {
        if bytes > self.left_bytes() {
            return Err(Fault::too_large(what, bytes, self));
        }
        Ok(())
    }

    /// [`Self::claim`] for `count` entries of `entry_bytes` each.
    pub(in crate::io) fn claim_entries(&self, what: &str, count: usize, entry_bytes: usize) -> Result<(), Fault> {
        self.claim(what, (count as u64).saturating_mul(entry_bytes as u64))
    }

    /// Reserves space for `more` entries in a list of unknown final length: it doubles, as far as memory allows. The
    /// previous list, which is copied, and memory retained by the allocator count as well.
    pub(in crate::io) fn reserve<T>(&self, list: &mut Vec<T>, more: usize, what: &str) -> Result<(), Fault> {
        if list.capacity() - list.len() >= more {
            return Ok(());
        }
        let grown = (2 * list.capacity()).max(list.len().saturating_add(more));
        self.claim_entries(what, grown, 2 * size_of::<T>())?;
        list.reserve_exact(grown - list.len());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn held_memory_counts_against_every_claim() {
        let options = ReadOptions::default().with_max_memory(1000).holding(600);
        assert!(options.claim("the points", 400).is_ok());
        let refused = options.claim("the points", 401).unwrap_err().problem;
        assert!(refused.contains("the points would take"), "{refused}");
        assert!(options.claim_entries("the points", usize::MAX, 12).is_err());
        assert!(options.holding(usize::MAX).claim("the points", 1).is_err());
    }

    #[test]
    fn lists_grow_up_to_the_memory_limit() {
        let options = ReadOptions::default().with_max_memory(1024);
        let mut list: Vec<u64> = Vec::new();
        let refused = loop {
            if let Err(fault) = options.reserve(&mut list, 1, "the faces") {
                break fault;
            }
            list.push(0);
        };
        assert!(refused.problem.contains("the faces"), "{}", refused.problem);
        assert_eq!(list.len(), 64);
    }
}
