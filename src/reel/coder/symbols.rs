//! Static coding of symbols: tables of frequencies ahead, then as little work a symbol as there can be.
//!
//! How it works: asymmetric numeral systems (Duda 2013) with ranges: the state of the coder is a number; a symbol of
//! frequency f of 4096 makes it 4096 / f times as large, and what is beyond 32 bits is written, 16 bits at a time. One
//! look-up by the lowest 12 bits of the state tells the symbol and the state before. Several states take turns (Giesen
//! 2014), so that a processor works at several symbols at once: the caller says which, by numbers that the compiler
//! knows, so that they stay in registers.
//!
//! When it wins: a symbol takes one look-up where an adaptive coder has several for each bit of it. What it costs: the
//! tables, and that nothing is learnt on the way.
//!
//! The encoder writes down which symbols come in which context. Which contexts share a table is decided at the end
//! ([`clustered`]), and the symbols are coded from the last to the first.

use super::clusters::{MOST_TABLES, clustered};
use super::frequencies::{Counts, Frequencies, SCALE, SCALE_BITS, SYMBOLS, TableModels};
use super::range::{BitCoder, RangeDecoder, RangeEncoder};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};

/// Most states that take turns.
pub(in crate::reel) const LANES: usize = 4;

/// Most contexts.
const MOST_CONTEXTS: usize = 64;

/// States are at least this between symbols.
const LEAST: u32 = 1 << 16;

/// The symbol of larger numbers, which follow as three bytes.
const ESCAPE: u8 = 255;

/// Codes symbols in one direction or the other.
pub(in crate::reel) trait SymbolCoder: Default {
    /// Whether symbols are read: what is handed in then says nothing.
    const DECODES: bool;

    /// Codes a symbol by a state and the table of a context: the one given, or the one read.
    fn symbol(&mut self, lane: usize, context: usize, symbol: u8) -> u8;

    /// Codes a byte, all of them equally likely.
    fn even_byte(&mut self, lane: usize, byte: u8) -> u8;

    /// Codes a number of either sign and less than 23 bits: small ones are symbols.
    #[inline(always)]
    fn signed(&mut self, lane: usize, context: usize, value: i32) -> i32 {
        let folded = (value << 1 ^ value >> 31) as u32;
        let symbol = self.symbol(lane, context, folded.min(u32::from(ESCAPE)) as u8);
        let folded = if symbol == ESCAPE {
            let bytes = [0, 8, 16].map(|shift| u32::from(self.even_byte(lane, (folded >> shift) as u8)) << shift);
            bytes[0] | bytes[1] | bytes[2]
        } else {
            u32::from(symbol)
        };
        (folded >> 1) as i32 ^ -((folded & 1) as i32)
    }
}

/// Even bytes, in the place of a context.
const EVEN: u8 = u8::MAX;

/// Notes symbols.
#[derive(Debug, Default)]
pub(in crate::reel) struct SymbolEncoder {
    /// Lane, context and symbol.
    noted: Vec<(u8, u8, u8)>,
    lanes: usize,
    counts: Vec<Counts>,
}

impl SymbolEncoder {
    /// With so many states, for so many contexts.
    pub(in crate::reel) fn new(lanes: usize, contexts: usize) -> Self {
        debug_assert!(
            lanes <= LANES && contexts <= MOST_CONTEXTS,
            "more than there is room for"
        );
        Self {
            noted: Vec::new(),
            lanes,
            counts: vec![Counts::default(); contexts],
        }
    }

    /// All bytes; none without symbols.
    pub(in crate::reel) fn finish(self) -> Vec<u8> {
        if self.noted.is_empty() {
            return Vec::new();
        }
        let (mut map, counts) = clustered(&self.counts);
        let mut tables: Vec<Frequencies> = counts.iter().map(Frequencies::of).collect();
        let mut coder = RangeEncoder::default();
        // What was made here is no fault.
        let _ = code_tables(&mut coder, &mut map, &mut tables);
        let head = coder.finish();
        let (states, words) = coded(&self.noted, &map, &tables);
        let mut writer = ByteWriter::default();
        writer.number(head.len() as u64);
        writer.bytes.extend(head);
        for state in &states[..self.lanes] {
            writer.u32(*state);
        }
        writer
            .bytes
            .extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
        writer.bytes
    }
}

/// The states after all symbols, and the words written, the last first.
fn coded(noted: &[(u8, u8, u8)], map: &[u8], tables: &[Frequencies]) -> ([u32; LANES], Vec<u16>) {
    let starts: Vec<[u16; SYMBOLS]> = tables.iter().map(starts_of).collect();
    let mut states = [LEAST; LANES];
    let mut words = Vec::new();
    for &(lane, context, symbol) in noted.iter().rev() {
        let (frequency, start) = if context == EVEN {
            (SCALE / SYMBOLS as u32, u32::from(symbol) * (SCALE / SYMBOLS as u32))
        } else {
            let (table, symbol) = (usize::from(map[usize::from(context)]), usize::from(symbol));
            (u32::from(tables[table].0[symbol]), u32::from(starts[table][symbol]))
        };
        let state = &mut states[usize::from(lane) % LANES];
        if *state >= frequency << (32 - SCALE_BITS) {
            words.push(*state as u16);
            *state >>= 16;
        }
        *state = (*state / frequency) << SCALE_BITS | (*state % frequency + start);
    }
    (states, words)
}

fn starts_of(table: &Frequencies) -> [u16; SYMBOLS] {
    let mut next = 0;
    table.0.map(|frequency| {
        let start = next;
        next += frequency;
        start
    })
}

/// Codes the number of tables, which of them each context has, and the tables.
fn code_tables<C: BitCoder>(coder: &mut C, map: &mut [u8], tables: &mut Vec<Frequencies>) -> Result<(), Fault> {
    let count = coder.even_bits(5, tables.len() as u64) as usize;
    if !(1..=MOST_TABLES).contains(&count) {
        return Err(Fault::new(format!(
            "{count} tables of symbols: 1 to {MOST_TABLES} can be"
        )));
    }
    tables.resize(count, Frequencies([0; SYMBOLS]));
    let bits = (count - 1).checked_ilog2().map_or(0, |bits| bits + 1);
    for table in map {
        *table = coder.even_bits(bits, u64::from(*table)) as u8;
        if usize::from(*table) >= count {
            return Err(Fault::new(format!("a context has table {table} of {count}")));
        }
    }
    let mut models = TableModels::default();
    tables.iter_mut().try_for_each(|table| table.code(coder, &mut models))
}

impl SymbolCoder for SymbolEncoder {
    const DECODES: bool = false;

    #[inline(always)]
    fn symbol(&mut self, lane: usize, context: usize, symbol: u8) -> u8 {
        self.counts[context].see(symbol);
        self.noted.push((lane as u8, context as u8, symbol));
        symbol
    }

    fn even_byte(&mut self, lane: usize, byte: u8) -> u8 {
        self.noted.push((lane as u8, EVEN, byte));
        byte
    }
}

/// What is behind each value of the lowest bits of a state: symbol, frequency and how far the value is above the
/// start of the symbol, 8, 12 and 12 bits.
fn add_slots(table: &Frequencies, slots: &mut Vec<u32>) {
    for (symbol, &frequency) in (0u32..).zip(&table.0) {
        let of_symbol = symbol << (2 * SCALE_BITS) | u32::from(frequency) << SCALE_BITS;
        slots.extend((0..u32::from(frequency)).map(|above| of_symbol | above));
    }
}

/// Reads symbols.
#[derive(Debug)]
pub(in crate::reel) struct SymbolDecoder<'a> {
    /// Those of all tables.
    slots: Vec<u32>,
    /// Where the table of each context begins.
    tables: [u32; MOST_CONTEXTS],
    states: [u32; LANES],
    words: &'a [[u8; 2]],
    /// Which word is next.
    next: usize,
}

impl Default for SymbolDecoder<'_> {
    /// Of no symbols.
    fn default() -> Self {
        Self {
            slots: Vec::new(),
            tables: [0; MOST_CONTEXTS],
            states: [LEAST; LANES],
            words: &[],
            next: 0,
        }
    }
}

impl<'a> SymbolDecoder<'a> {
    /// Of bytes with so many states, for so many contexts. Without bytes there are no symbols to be read.
    pub(in crate::reel) fn new(bytes: &'a [u8], lanes: usize, contexts: usize) -> Result<Self, Fault> {
        let mut decoder = Self::default();
        if bytes.is_empty() {
            decoder.slots = vec![0; SCALE as usize];
            return Ok(decoder);
        }
        let mut reader = ByteReader::new(bytes);
        let length = reader.number()? as usize;
        let mut head = RangeDecoder::new(reader.take(length)?);
        let (mut map, mut tables) = (vec![0; contexts], Vec::new());
        code_tables(&mut head, &mut map, &mut tables)?;
        if head.has_overrun() {
            return Err(Fault::new("tables of symbols end too early"));
        }
        decoder.slots = Vec::with_capacity(tables.len() << SCALE_BITS);
        for table in &tables {
            add_slots(table, &mut decoder.slots);
        }
        for (start, table) in decoder.tables.iter_mut().zip(map) {
            *start = u32::from(table) << SCALE_BITS;
        }
        for state in decoder.states.iter_mut().take(lanes) {
            *state = reader.u32()?;
        }
        let (words, rest) = reader.take(reader.left())?.as_chunks();
        if !rest.is_empty() {
            return Err(Fault::new("a stream of symbols ends within a word"));
        }
        decoder.words = words;
        Ok(decoder)
    }

    /// Whether exactly the symbols were read that were written.
    pub(in crate::reel) fn is_at_end(&self) -> bool {
        self.next == self.words.len() && self.states.iter().all(|&state| state == LEAST)
    }

    #[inline(always)]
    fn go_on(&mut self, lane: usize, state: u32) {
        let word = self
            .words
            .get(self.next)
            .map_or(0, |&word| u32::from(u16::from_le_bytes(word)));
        // 1 below 2¹⁶, else 0. No branch: which symbols need a word nobody can guess.
        let refills = (state | 1).leading_zeros() / 16;
        self.states[lane] = state << (16 * refills) | (word & refills.wrapping_neg());
        self.next += refills as usize;
    }
}

impl SymbolCoder for SymbolDecoder<'_> {
    const DECODES: bool = true;

    #[inline(always)]
    fn symbol(&mut self, lane: usize, context: usize, _: u8) -> u8 {
        let state = self.states[lane];
        let slot = self.slots[(self.tables[context % MOST_CONTEXTS] + state % SCALE) as usize];
        let frequency = slot >> SCALE_BITS & (SCALE - 1);
        self.go_on(lane, frequency * (state >> SCALE_BITS) + (slot & (SCALE - 1)));
        (slot >> (2 * SCALE_BITS)) as u8
    }

    #[inline(always)]
    fn even_byte(&mut self, lane: usize, _: u8) -> u8 {
        let each = SCALE / SYMBOLS as u32;
        let state = self.states[lane];
        let low = state % SCALE;
        self.go_on(lane, each * (state >> SCALE_BITS) + low % each);
        (low / each) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CONTEXTS: usize = 30;

    /// What is coded: a symbol or a number, by a context.
    type Coded = (u8, usize, i32);

    fn code<C: SymbolCoder>(coder: &mut C, (kind, context, value): Coded) -> i32 {
        let lane = context % LANES;
        match kind {
            0 => i32::from(coder.symbol(lane, context, value as u8)),
            _ => coder.signed(lane, context, value),
        }
    }

    fn encoded(all: &[Coded]) -> Vec<u8> {
        let mut encoder = SymbolEncoder::new(LANES, CONTEXTS);
        for &coded in all {
            code(&mut encoder, coded);
        }
        encoder.finish()
    }

    fn coded() -> impl Strategy<Value = Coded> {
        prop_oneof![
            6 => (Just(0), 0..CONTEXTS, 0..256),
            6 => (Just(0), 0..3usize, 0..3),
            3 => (Just(1), 0..CONTEXTS, -300..300),
            1 => (Just(1), 0..CONTEXTS, -(1 << 22)..1 << 22),
        ]
    }

    proptest! {
        #[test]
        fn symbols_are_read_as_they_were_written(all in prop::collection::vec(coded(), 0..600), often in 1usize..20) {
            let all = all.repeat(often);
            let bytes = encoded(&all);
            let mut decoder = SymbolDecoder::new(&bytes, LANES, CONTEXTS).unwrap();
            for &(kind, context, value) in &all {
                prop_assert_eq!(code(&mut decoder, (kind, context, 0)), value);
            }
            prop_assert!(decoder.is_at_end());
            if let Some(&(kind, context, _)) = all.last() {
                code(&mut decoder, (kind, context, 0));
                prop_assert!(!decoder.is_at_end());
            }
        }

        #[test]
        fn other_bytes_are_no_panic(all in prop::collection::vec(coded(), 1..60),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
            end in any::<prop::sample::Index>()) {
            let mut bytes = encoded(&all);
            for (place, value) in changes {
                *place.get_mut(&mut bytes) = value;
            }
            bytes.truncate(end.index(bytes.len()) + 1);
            if let Ok(mut decoder) = SymbolDecoder::new(&bytes, LANES, CONTEXTS) {
                for &coded in &all {
                    code(&mut decoder, coded);
                }
            }
        }
    }

    /// Nothing is for nothing, and no more than it says.
    #[test]
    fn symbols_take_what_their_frequencies_say() {
        let count = 1 << 18;
        let alike = vec![(0, 0, 7); count];
        let bits = 8 * encoded(&alike).len();
        assert!(bits >= count / 360 && bits <= count / 300 + 300, "{bits}");
        // Three quarters of one, the others even: 0.811 + 0.25 log₂ 4 bits.
        let mixed: Vec<Coded> = (0..count)
            .map(|place| {
                let number = (place as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 60;
                (0, 0, if number < 12 { 9 } else { number as i32 })
            })
            .collect();
        let expected = 1.3113 * count as f64;
        let bits = 8.0 * encoded(&mixed).len() as f64;
        assert!((bits / expected - 1.0).abs() < 0.005, "{bits} beside {expected}");
    }

    /// Contexts that differ have tables of their own where there is enough of them, and one where there is not.
    #[test]
    fn contexts_share_tables_as_it_pays() {
        let of = |count: usize| -> Vec<Coded> { (0..count).map(|place| (0, place % 2, (place % 2) as i32)).collect() };
        let tables = |all: &[Coded]| {
            let bytes = encoded(all);
            SymbolDecoder::new(&bytes, LANES, CONTEXTS).unwrap().slots.len() >> SCALE_BITS
        };
        assert_eq!(tables(&of(1000)), 2);
        assert_eq!(tables(&of(8)), 1);
    }

    #[test]
    fn tables_that_cannot_be_are_refused() {
        let refused = |frequencies: [u16; SYMBOLS]| {
            let mut coder = RangeEncoder::default();
            let _ = code_tables(&mut coder, &mut [0; CONTEXTS], &mut vec![Frequencies(frequencies)]);
            let head = coder.finish();
            let mut bytes = vec![head.len() as u8];
            bytes.extend(head);
            bytes.extend([0, 0, 1, 0].repeat(LANES));
            SymbolDecoder::new(&bytes, LANES, CONTEXTS).map(|_| ())
        };
        let of = |pairs: &[(usize, u16)]| {
            let mut frequencies = [0; SYMBOLS];
            for &(symbol, frequency) in pairs {
                frequencies[symbol] = frequency;
            }
            frequencies
        };
        assert_eq!(refused(of(&[(3, 2048), (200, 2048)])), Ok(()));
        for wrong in [
            &[(3, 4000), (4, 95)][..],
            &[(3, 4000), (4, 97)],
            &[(3, 4095), (4, 1)],
            &[],
        ] {
            let problem = refused(of(wrong)).unwrap_err().0;
            assert!(problem.contains("add up to"), "{problem}");
        }
        assert!(SymbolDecoder::new(&[200, 1, 0], LANES, CONTEXTS).is_err());
        assert!(SymbolDecoder::new(&[0], LANES, CONTEXTS).is_err());
    }
}
