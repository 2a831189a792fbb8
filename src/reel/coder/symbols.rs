//! Static coding of symbols: frequency tables up front, then as little work per symbol as possible.
//!
//! How it works: asymmetric numeral systems (ANS) (Duda 2013) with ranges: the state of the coder is a number; a symbol
//! of frequency f of 4096 makes it 4096 / f times as large, and bits beyond 32 are written, 16 at a time. One look-up
//! by the lowest 12 bits of the state yields the symbol and the previous state. Several states take turns (Giesen
//! 2014), so that a CPU works on several symbols at once: the caller selects the state by numbers that are known at
//! compile time, so that they stay in registers.
//!
//! When it wins: a symbol takes one look-up where an adaptive coder has several for each bit of it. What it costs: the
//! tables, and no adaptation along the stream.
//!
//! The encoder records which symbols come in which context. Which contexts share a table is decided at the end
//! ([`clustered`]), and the symbols are coded from the last to the first. Bits of uniform probability are stored raw
//! alongside them ([`super::raw_bits`]).

use super::clusters::{MAX_TABLES, clustered};
use super::frequencies::{Counts, Frequencies, SCALE, SCALE_BITS, SYMBOLS, TableModels};
use super::range::{BitCoder, RangeDecoder, RangeEncoder};
use super::raw_bits::{RawReader, RawWriter};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};

/// Maximum number of states that take turns.
// Interleaved states only help because contexts are derived from the level above, hardly ever from the previous symbol.
pub(in crate::reel) const LANES: usize = 4;

/// Maximum number of contexts.
const MAX_CONTEXTS: usize = 64;

/// States are at least this between symbols.
const MIN: u32 = 1 << 16;

/// Codes symbols in one direction or the other.
pub(in crate::reel) trait SymbolCoder: Default {
    /// True for a decoder: symbols are read, and the symbols passed in have no meaning.
    const DECODES: bool;

    /// Codes a symbol by a state and the table of a context: the one given, or the one read.
    fn symbol(&mut self, lane: usize, context: usize, symbol: u8) -> u8;

    /// Codes symbols whose contexts are all known, the states in turns.
    fn symbols(&mut self, contexts: &[u8], symbols: &mut [u8]);

    /// Codes symbols of the first context, the states in turns.
    fn plain(&mut self, symbols: &mut [u8]);

    /// Codes the lowest bits of a number, at most 32, as they are.
    fn raw(&mut self, bits: u32, value: u32) -> u32;
}

/// Notes symbols.
#[derive(Debug, Default)]
pub(in crate::reel) struct SymbolEncoder {
    /// Lane, context and symbol.
    noted: Vec<(u8, u8, u8)>,
    counts: Vec<Counts>,
    raw: RawWriter,
}

impl SymbolEncoder {
    /// For this number of contexts.
    pub(in crate::reel) fn new(contexts: usize) -> Self {
        debug_assert!(contexts <= MAX_CONTEXTS, "more than there is room for");
        Self {
            noted: Vec::new(),
            counts: vec![Counts::default(); contexts],
            raw: RawWriter::default(),
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
        // Encoding cannot fail.
        let _ = code_tables(&mut coder, &mut map, &mut tables);
        let head = coder.finish();
        let raw = self.raw.finish();
        let (states, words) = coded(&self.noted, &map, &tables);
        let mut writer = ByteWriter::default();
        writer.number(head.len() as u64);
        writer.bytes.extend(head);
        writer.number(raw.len() as u64);
        writer.bytes.extend(raw);
        for state in states {
            writer.u32(state);
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
    let mut states = [MIN; LANES];
    let mut words = Vec::new();
    for &(lane, context, symbol) in noted.iter().rev() {
        let (table, symbol) = (usize::from(map[usize::from(context)]), usize::from(symbol));
        let (frequency, start) = (u32::from(tables[table].0[symbol]), u32::from(starts[table][symbol]));
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
    if !(1..=MAX_TABLES).contains(&count) {
        return Err(Fault::new(format!(
            "{count} tables of symbols: 1 to {MAX_TABLES} can be"
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

    fn symbols(&mut self, contexts: &[u8], symbols: &mut [u8]) {
        for (place, (&context, &mut symbol)) in contexts.iter().zip(symbols).enumerate() {
            self.symbol(place % LANES, usize::from(context), symbol);
        }
    }

    fn plain(&mut self, symbols: &mut [u8]) {
        for (place, &mut symbol) in symbols.iter_mut().enumerate() {
            self.symbol(place % LANES, 0, symbol);
        }
    }

    fn raw(&mut self, bits: u32, value: u32) -> u32 {
        self.raw.write(bits, value);
        value
    }
}

/// Adds the decoding slots for each value of the lowest bits of a state: symbol, frequency and how far the value is
/// above the start of the symbol, 8, 12 and 12 bits.
fn add_slots(table: &Frequencies, slots: &mut Vec<u32>) {
    for (symbol, &frequency) in (0u32..).zip(&table.0) {
        let of_symbol = symbol << (2 * SCALE_BITS) | u32::from(frequency) << SCALE_BITS;
        slots.extend((0..u32::from(frequency)).map(|above| of_symbol | above));
    }
}

/// Reads symbols.
#[derive(Debug)]
pub(in crate::reel) struct SymbolDecoder<'a> {
    /// Decoding slots of all tables.
    slots: Vec<u32>,
    /// Start of the table of each context.
    tables: [u32; MAX_CONTEXTS],
    states: [u32; LANES],
    words: &'a [[u8; 2]],
    /// Index of the next word.
    next: usize,
    raw: RawReader<'a>,
}

impl Default for SymbolDecoder<'_> {
    /// Creates a decoder of no symbols.
    fn default() -> Self {
        Self {
            slots: Vec::new(),
            tables: [0; MAX_CONTEXTS],
            states: [MIN; LANES],
            words: &[],
            next: 0,
            raw: RawReader::default(),
        }
    }
}

impl<'a> SymbolDecoder<'a> {
    /// Creates a decoder of bytes with symbols of the given number of contexts. Without bytes there are none to be
    /// read.
    pub(in crate::reel) fn new(bytes: &'a [u8], contexts: usize) -> Result<Self, Fault> {
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
        let length = reader.number()? as usize;
        decoder.raw = RawReader::new(reader.take(length)?);
        for state in &mut decoder.states {
            *state = reader.u32()?;
        }
        let (words, rest) = reader.take(reader.left())?.as_chunks();
        if !rest.is_empty() {
            return Err(Fault::new("a stream of symbols ends within a word"));
        }
        decoder.words = words;
        Ok(decoder)
    }

    /// Returns true if exactly the symbols were read that were written.
    pub(in crate::reel) fn is_at_end(&self) -> bool {
        self.next == self.words.len() && self.states.iter().all(|&state| state == MIN) && self.raw.is_at_end()
    }
}

/// A symbol of the table that begins at a slot, by a state: with the state behind it, and how many words were read.
#[inline(always)]
fn step(slots: &[u32], table: u32, state: u32, word: Option<&[u8; 2]>) -> (u8, u32, usize) {
    let slot = slots[(table + state % SCALE) as usize];
    let frequency = slot >> SCALE_BITS & (SCALE - 1);
    let state = frequency * (state >> SCALE_BITS) + (slot & (SCALE - 1));
    let word = word.map_or(0, |&word| u32::from(u16::from_le_bytes(word)));
    // 1 below 2¹⁶, else 0. No branch: which symbols need a word is unpredictable.
    let refills = (state | 1).leading_zeros() / 16;
    let state = state << (16 * refills) | (word & refills.wrapping_neg());
    ((slot >> (2 * SCALE_BITS)) as u8, state, refills as usize)
}

impl SymbolCoder for SymbolDecoder<'_> {
    const DECODES: bool = true;

    #[inline(always)]
    fn symbol(&mut self, lane: usize, context: usize, _: u8) -> u8 {
        let table = self.tables[context % MAX_CONTEXTS];
        let (symbol, state, words) = step(&self.slots, table, self.states[lane], self.words.get(self.next));
        self.states[lane] = state;
        self.next += words;
        symbol
    }

    #[inline(always)]
    fn symbols(&mut self, contexts: &[u8], symbols: &mut [u8]) {
        let [mut a, mut b, mut c, mut d] = self.states;
        let mut next = self.next;
        let (slots, all) = (self.slots.as_slice(), self.words);
        let mut one = |state: &mut u32, context: u8, symbol: &mut u8| {
            let (table, words) = (self.tables[usize::from(context) % MAX_CONTEXTS], all.get(next));
            let count;
            (*symbol, *state, count) = step(slots, table, *state, words);
            next += count;
        };
        let (contexts, last_contexts) = contexts.as_chunks::<LANES>();
        let (symbols, last_symbols) = symbols.as_chunks_mut::<LANES>();
        for (contexts, symbols) in contexts.iter().zip(symbols) {
            one(&mut a, contexts[0], &mut symbols[0]);
            one(&mut b, contexts[1], &mut symbols[1]);
            one(&mut c, contexts[2], &mut symbols[2]);
            one(&mut d, contexts[3], &mut symbols[3]);
        }
        for ((state, &context), symbol) in [&mut a, &mut b, &mut c]
            .into_iter()
            .zip(last_contexts)
            .zip(last_symbols)
        {
            one(state, context, symbol);
        }
        self.states = [a, b, c, d];
        self.next = next;
    }

    #[inline(always)]
    fn plain(&mut self, symbols: &mut [u8]) {
        let start = self.tables[0] as usize;
        let Some(Ok(slots)) = self.slots.get(start..start + SCALE as usize).map(TryInto::try_into) else {
            return;
        };
        let slots: &[u32; SCALE as usize] = slots;
        let [mut a, mut b, mut c, mut d] = self.states;
        let (mut next, words) = (self.next, self.words);
        let mut one = |state: &mut u32, symbol: &mut u8| {
            let count;
            (*symbol, *state, count) = step(slots, 0, *state, words.get(next));
            next += count;
        };
        let (symbols, last_symbols) = symbols.as_chunks_mut::<LANES>();
        for symbols in symbols {
            one(&mut a, &mut symbols[0]);
            one(&mut b, &mut symbols[1]);
            one(&mut c, &mut symbols[2]);
            one(&mut d, &mut symbols[3]);
        }
        for (state, symbol) in [&mut a, &mut b, &mut c].into_iter().zip(last_symbols) {
            one(state, symbol);
        }
        self.states = [a, b, c, d];
        self.next = next;
    }

    #[inline(always)]
    fn raw(&mut self, bits: u32, _: u32) -> u32 {
        self.raw.read(bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CONTEXTS: usize = 30;

    /// The coded item: a symbol by a context; several, of this context and those after it; several of the first one; or
    /// a number of bits.
    type Coded = (u8, usize, u32);

    /// The value that a decoder has to find.
    fn code<C: SymbolCoder>(coder: &mut C, (kind, context, value): Coded) -> Vec<u32> {
        match kind {
            0 => vec![u32::from(coder.symbol(context % LANES, context, value as u8))],
            1 => {
                let contexts: Vec<u8> = (0..value as usize % 11)
                    .map(|place| ((context + place) % CONTEXTS) as u8)
                    .collect();
                let mut symbols: Vec<u8> = contexts.iter().map(|&of| of.wrapping_mul(value as u8)).collect();
                if C::DECODES {
                    symbols.fill(0);
                }
                coder.symbols(&contexts, &mut symbols);
                symbols.into_iter().map(u32::from).collect()
            }
            3 => {
                let mut symbols: Vec<u8> = (0..context as u8)
                    .map(|place| place.wrapping_mul(value as u8))
                    .collect();
                if C::DECODES {
                    symbols.fill(0);
                }
                coder.plain(&mut symbols);
                symbols.into_iter().map(u32::from).collect()
            }
            _ => vec![coder.raw(context as u32, value & ((1 << context) - 1))],
        }
    }

    fn encoded(all: &[Coded]) -> (Vec<u8>, Vec<Vec<u32>>) {
        let mut encoder = SymbolEncoder::new(CONTEXTS);
        let given = all.iter().map(|&coded| code(&mut encoder, coded)).collect();
        (encoder.finish(), given)
    }

    fn coded() -> impl Strategy<Value = Coded> {
        prop_oneof![
            6 => (Just(0), 0..CONTEXTS, 0..256u32),
            6 => (Just(0), 0..3usize, 0..3u32),
            3 => (Just(1), 0..CONTEXTS, 0..256u32),
            3 => (Just(2), 0..CONTEXTS, any::<u32>()),
            3 => (Just(3), 0..CONTEXTS, 0..256u32),
        ]
    }

    proptest! {
        #[test]
        fn symbols_round_trip(all in prop::collection::vec(coded(), 0..600), often in 1usize..20) {
            // Raw bits accompany symbols, they never occur alone.
            let all = [vec![(0, 0, 1)], all.repeat(often)].concat();
            let (bytes, given) = encoded(&all);
            let mut decoder = SymbolDecoder::new(&bytes, CONTEXTS).unwrap();
            for (&coded, given) in all.iter().zip(given) {
                prop_assert_eq!(code(&mut decoder, coded), given);
            }
            prop_assert!(decoder.is_at_end());
            let mut more = SymbolDecoder::new(&bytes, CONTEXTS).unwrap();
            for &coded in all.iter().chain([&(0, 0, 0)]) {
                code(&mut more, coded);
            }
            prop_assert!(!more.is_at_end());
            decoder.raw(8, 0);
            prop_assert!(!decoder.is_at_end());
        }

        #[test]
        fn arbitrary_bytes_never_panic(all in prop::collection::vec(coded(), 1..60),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
            end in any::<prop::sample::Index>()) {
            let (mut bytes, _) = encoded(&[vec![(0, 0, 1)], all.clone()].concat());
            for (place, value) in changes {
                *place.get_mut(&mut bytes) = value;
            }
            bytes.truncate(end.index(bytes.len()) + 1);
            if let Ok(mut decoder) = SymbolDecoder::new(&bytes, CONTEXTS) {
                for &coded in &all {
                    code(&mut decoder, coded);
                }
            }
        }
    }

    /// Nothing is for nothing, and no more than it says.
    #[test]
    fn symbols_take_the_bits_of_their_frequencies() {
        let count = 1 << 18;
        let alike = vec![(0, 0, 7); count];
        let bits = 8 * encoded(&alike).0.len();
        assert!(bits >= count / 360 && bits <= count / 300 + 300, "{bits}");
        // Three quarters of one symbol, the others evenly: 0.811 + 0.25 log₂ 4 bits.
        let mixed: Vec<Coded> = (0..count)
            .map(|place| {
                let number = (place as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 60;
                (0, 0, if number < 12 { 9 } else { number as u32 })
            })
            .collect();
        let expected = 1.3113 * count as f64;
        let bits = 8.0 * encoded(&mixed).0.len() as f64;
        assert!((bits / expected - 1.0).abs() < 0.005, "{bits} beside {expected}");
    }

    /// Contexts that differ have tables of their own where there is enough of them, and one where there is not.
    #[test]
    fn contexts_share_tables_where_it_saves_space() {
        let of = |count: usize| -> Vec<Coded> { (0..count).map(|place| (0, place % 2, (place % 2) as u32)).collect() };
        let tables = |all: &[Coded]| {
            let (bytes, _) = encoded(all);
            SymbolDecoder::new(&bytes, CONTEXTS).unwrap().slots.len() >> SCALE_BITS
        };
        assert_eq!(tables(&of(1000)), 2);
        assert_eq!(tables(&of(8)), 1);
    }

    #[test]
    fn invalid_tables_are_rejected() {
        let refused = |frequencies: [u16; SYMBOLS]| {
            let mut coder = RangeEncoder::default();
            let _ = code_tables(&mut coder, &mut [0; CONTEXTS], &mut vec![Frequencies(frequencies)]);
            let head = coder.finish();
            let mut bytes = vec![head.len() as u8];
            bytes.extend(head);
            bytes.push(0);
            bytes.extend([0, 0, 1, 0].repeat(LANES));
            SymbolDecoder::new(&bytes, CONTEXTS).map(|_| ())
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
        assert!(SymbolDecoder::new(&[200, 1, 0], CONTEXTS).is_err());
        assert!(SymbolDecoder::new(&[0], CONTEXTS).is_err());
    }
}
