//! Bzip2 unpacked, for the chunks of old ROS bags.
//!
//! Ours, as the crates for it bring the C library or a translation of it, under a licence of its own that this project does not
//! take in. Every stage is bounded by the block size that the format allows: 900,000 bytes before runs are unfolded, at most
//! 52 times that behind it. Blocks made by versions before 0.9.5 (randomised) are refused.

use std::io::{self, BufReader, Read};

/// The levels of the format count blocks in this size.
const LEVEL_BYTES: usize = 100_000;
const BLOCK_MAGIC: u64 = 0x3141_5926_5359;
const END_MAGIC: u64 = 0x1772_4538_5090;
/// Symbols that one selector is for.
const GROUP_SYMBOLS: usize = 50;
const MAX_CODE_BITS: usize = 20;
/// Symbols of runs in place of the two least of the alphabet.
const RUN_B: u16 = 1;

/// Unpacks what it reads.
pub(super) struct Decoder<R> {
    bits: Bits<R>,
    /// Most bytes of a block before runs are unfolded; `None` between streams.
    block_bytes: Option<usize>,
    is_first: bool,
    unpacked: Vec<u8>,
    taken: usize,
}

impl<R: Read> Decoder<R> {
    pub(super) fn new(packed: R) -> Self {
        Self {
            bits: Bits {
                bytes: BufReader::new(packed),
                held: 0,
                count: 0,
            },
            block_bytes: None,
            is_first: true,
            unpacked: Vec::new(),
            taken: 0,
        }
    }

    /// Unpacks the next block; false behind the last one.
    fn next_block(&mut self) -> io::Result<bool> {
        loop {
            let Some(block_bytes) = self.block_bytes else {
                if !self.start_stream()? {
                    return Ok(false);
                }
                continue;
            };
            match self.bits.take(48)? {
                BLOCK_MAGIC => {
                    let crc = self.bits.take(32)? as u32;
                    self.unpacked = block(&mut self.bits, block_bytes)?;
                    self.taken = 0;
                    if checksum(&self.unpacked) != crc {
                        return Err(damaged("a block's checksum is wrong"));
                    }
                    return Ok(true);
                }
                END_MAGIC => {
                    // The checksum of all blocks says nothing that theirs do not.
                    self.bits.take(32)?;
                    self.bits.align();
                    self.block_bytes = None;
                }
                _ => return Err(damaged("neither a block nor the end of the stream")),
            }
        }
    }

    fn start_stream(&mut self) -> io::Result<bool> {
        let mut magic = [0u8; 4];
        for (index, byte) in magic.iter_mut().enumerate() {
            match self.bits.take(8) {
                Ok(value) => *byte = value as u8,
                Err(_) if index == 0 && !self.is_first => return Ok(false),
                Err(error) => return Err(error),
            }
        }
        self.is_first = false;
        match magic {
            [b'B', b'Z', b'h', level @ b'1'..=b'9'] => {
                self.block_bytes = Some(usize::from(level - b'0') * LEVEL_BYTES);
                Ok(true)
            }
            _ => Err(damaged("it does not begin with BZh")),
        }
    }
}

impl<R: Read> Read for Decoder<R> {
    fn read(&mut self, target: &mut [u8]) -> io::Result<usize> {
        while self.taken == self.unpacked.len() {
            if target.is_empty() || !self.next_block()? {
                return Ok(0);
            }
        }
        let rest = &self.unpacked[self.taken..];
        let count = rest.len().min(target.len());
        target[..count].copy_from_slice(&rest[..count]);
        self.taken += count;
        Ok(count)
    }
}

fn damaged(problem: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("bzip2: {problem}"))
}

/// Bits from the highest of each byte on.
struct Bits<R> {
    bytes: BufReader<R>,
    held: u64,
    count: u32,
}

impl<R: Read> Bits<R> {
    /// Precondition: `count` is at most 48.
    fn take(&mut self, count: u32) -> io::Result<u64> {
        while self.count < count {
            let mut byte = [0];
            self.bytes.read_exact(&mut byte)?;
            self.held = (self.held << 8) | u64::from(byte[0]);
            self.count += 8;
        }
        self.count -= count;
        Ok((self.held >> self.count) & ((1 << count) - 1))
    }

    fn bit(&mut self) -> io::Result<bool> {
        Ok(self.take(1)? == 1)
    }

    fn align(&mut self) {
        self.count -= self.count % 8;
    }
}

fn block<R: Read>(bits: &mut Bits<R>, block_bytes: usize) -> io::Result<Vec<u8>> {
    if bits.bit()? {
        return Err(damaged("a randomised block, which is not read"));
    }
    let origin = bits.take(24)? as usize;
    let groups = bits.take(16)?;
    let mut used: Vec<u8> = Vec::with_capacity(256);
    for group in 0..16u8 {
        if groups >> (15 - group) & 1 == 1 {
            let members = bits.take(16)?;
            used.extend(
                (0..16u8)
                    .filter(|bit| members >> (15 - bit) & 1 == 1)
                    .map(|bit| group * 16 + bit),
            );
        }
    }
    if used.is_empty() {
        return Err(damaged("a block without symbols"));
    }
    let code_count = bits.take(3)? as usize;
    let selector_count = bits.take(15)? as usize;
    if !(2..=6).contains(&code_count) || selector_count == 0 {
        return Err(damaged("a wrong number of codes"));
    }
    let mut recent: Vec<u8> = (0..code_count as u8).collect();
    let mut selectors = Vec::new();
    for _ in 0..selector_count {
        let mut place = 0;
        while bits.bit()? {
            place += 1;
            if place >= code_count {
                return Err(damaged("a selector of no code"));
            }
        }
        let code = recent.remove(place);
        recent.insert(0, code);
        selectors.push(usize::from(code));
    }
    let symbol_count = used.len() + 2;
    let codes = (0..code_count)
        .map(|_| Code::read(bits, symbol_count))
        .collect::<io::Result<Vec<_>>>()?;
    let last = symbols(bits, &codes, &selectors, used, block_bytes)?;
    unfold(&sorted_back(&last, origin)?)
}

/// The last column of the sorted rotations: codes, recency ranks and runs undone.
fn symbols<R: Read>(
    bits: &mut Bits<R>,
    codes: &[Code],
    selectors: &[usize],
    mut recent: Vec<u8>,
    block_bytes: usize,
) -> io::Result<Vec<u8>> {
    let end = recent.len() as u16 + 1;
    let mut last: Vec<u8> = Vec::new();
    let (mut run, mut weight) = (0usize, 1usize);
    for &selector in selectors {
        for _ in 0..GROUP_SYMBOLS {
            let symbol = codes[selector].next(bits)?;
            if symbol <= RUN_B {
                run += weight << symbol;
                weight <<= 1;
                if run > block_bytes {
                    return Err(damaged("a run longer than a block"));
                }
                continue;
            }
            last.extend(std::iter::repeat_n(recent[0], run));
            (run, weight) = (0, 1);
            if symbol == end {
                return Ok(last);
            }
            let byte = recent.remove(usize::from(symbol) - 1);
            recent.insert(0, byte);
            last.push(byte);
            if last.len() > block_bytes {
                return Err(damaged("more bytes than a block has"));
            }
        }
    }
    Err(damaged("a block without end"))
}

/// Undoes the Burrows–Wheeler transform: row `origin` of the sorted rotations is the text.
fn sorted_back(last: &[u8], origin: usize) -> io::Result<Vec<u8>> {
    if origin >= last.len() {
        return Err(damaged("a block that begins nowhere"));
    }
    let mut starts = [0usize; 256];
    for &byte in last {
        starts[usize::from(byte)] += 1;
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += std::mem::replace(start, sum);
    }
    let mut next = vec![0u32; last.len()];
    for (index, &byte) in last.iter().enumerate() {
        next[starts[usize::from(byte)]] = index as u32;
        starts[usize::from(byte)] += 1;
    }
    let mut row = next[origin] as usize;
    Ok((0..last.len())
        .map(|_| {
            let byte = last[row];
            row = next[row] as usize;
            byte
        })
        .collect())
}

/// Four equal bytes are followed by the number of further ones.
fn unfold(folded: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(folded.len());
    let mut equal = 0;
    let mut folded = folded.iter();
    while let Some(&byte) = folded.next() {
        equal = if bytes.last() == Some(&byte) {
            equal + 1
        } else {
            1
        };
        bytes.push(byte);
        if equal == 4 {
            let more = folded
                .next()
                .ok_or_else(|| damaged("a run without length"))?;
            bytes.extend(std::iter::repeat_n(byte, usize::from(*more)));
            // What follows a run begins anew, whatever it is.
            equal = 0;
        }
    }
    Ok(bytes)
}

/// A canonical Huffman code.
struct Code {
    /// Of each length, the first code and the place of its symbol.
    firsts: [(u32, usize); MAX_CODE_BITS + 2],
    counts: [u32; MAX_CODE_BITS + 2],
    symbols: Vec<u16>,
}

impl Code {
    fn read<R: Read>(bits: &mut Bits<R>, symbol_count: usize) -> io::Result<Self> {
        let mut lengths = Vec::with_capacity(symbol_count);
        let mut length = bits.take(5)? as usize;
        for _ in 0..symbol_count {
            loop {
                if !(1..=MAX_CODE_BITS).contains(&length) {
                    return Err(damaged("a code of wrong length"));
                }
                if !bits.bit()? {
                    break;
                }
                if bits.bit()? {
                    length -= 1;
                } else {
                    length += 1;
                }
            }
            lengths.push(length);
        }
        let mut code = Self {
            firsts: [(0, 0); MAX_CODE_BITS + 2],
            counts: [0; MAX_CODE_BITS + 2],
            symbols: Vec::with_capacity(symbol_count),
        };
        let mut first = 0u32;
        for length in 1..=MAX_CODE_BITS {
            first <<= 1;
            code.firsts[length] = (first, code.symbols.len());
            code.symbols.extend(
                (0..symbol_count)
                    .filter(|&symbol| lengths[symbol] == length)
                    .map(|symbol| symbol as u16),
            );
            code.counts[length] = (code.symbols.len() - code.firsts[length].1) as u32;
            first += code.counts[length];
        }
        Ok(code)
    }

    fn next<R: Read>(&self, bits: &mut Bits<R>) -> io::Result<u16> {
        let mut value = 0u32;
        for length in 1..=MAX_CODE_BITS {
            value = (value << 1) | u32::from(bits.bit()?);
            let (first, place) = self.firsts[length];
            if value >= first && value - first < self.counts[length] {
                return Ok(self.symbols[place + (value - first) as usize]);
            }
        }
        Err(damaged("a code of no symbol"))
    }
}

/// CRC-32 with the highest bit first, unlike that of ZIP.
fn checksum(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x04c1_1db7;
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut index = 0;
        while index < 256 {
            let mut value = (index as u32) << 24;
            let mut bit = 0;
            while bit < 8 {
                value = (value << 1) ^ if value >> 31 == 1 { POLYNOMIAL } else { 0 };
                bit += 1;
            }
            table[index] = value;
            index += 1;
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (crc << 8) ^ TABLE[((crc >> 24) as u8 ^ byte) as usize]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // Packed by libbz2, through Python's module `bz2`.
    const HELLO: &[u8] = &[
        0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0x19, 0x31, 0x65, 0x3d, 0x00,
        0x00, 0x00, 0x81, 0x00, 0x02, 0x44, 0xa0, 0x00, 0x21, 0x9a, 0x68, 0x33, 0x4d, 0x07, 0x33,
        0x8b, 0xb9, 0x22, 0x9c, 0x28, 0x48, 0x0c, 0x98, 0xb2, 0x9e, 0x80,
    ];
    const RUN: &[u8] = &[
        0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0xca, 0x62, 0xb6, 0x4c, 0x00,
        0x00, 0x11, 0x83, 0x00, 0x80, 0x08, 0x20, 0x00, 0x00, 0x08, 0x20, 0x00, 0x30, 0xcc, 0x09,
        0xaa, 0x69, 0xd5, 0x83, 0x6a, 0x0f, 0x17, 0x72, 0x45, 0x38, 0x50, 0x90, 0xca, 0x62, 0xb6,
        0x4c,
    ];
    const WORDS: &[u8] = &[
        0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0xe5, 0xe5, 0x4c, 0xf1, 0x00,
        0x00, 0x2a, 0x58, 0x00, 0x00, 0x10, 0x40, 0x00, 0x7f, 0xe0, 0x30, 0x00, 0xa6, 0xb1, 0x14,
        0xf1, 0x84, 0x24, 0x20, 0x32, 0x00, 0x25, 0x3d, 0x54, 0xde, 0x89, 0x34, 0x6f, 0x5e, 0xd3,
        0x86, 0x30, 0x44, 0xf7, 0x47, 0x5a, 0xac, 0x87, 0x40, 0xaf, 0x7c, 0xea, 0xa5, 0x68, 0x93,
        0x98, 0x64, 0x63, 0x70, 0x25, 0x94, 0x85, 0xbb, 0x57, 0x47, 0x1e, 0xed, 0x9d, 0x18, 0xa7,
        0x7e, 0xa9, 0xb2, 0x3d, 0x2b, 0xbd, 0xda, 0x91, 0x4a, 0xb3, 0x4f, 0x38, 0x53, 0x28, 0x2d,
        0x66, 0xef, 0x5c, 0xbd, 0xcb, 0xba, 0x88, 0xaa, 0x2d, 0x6b, 0x24, 0xf3, 0x9f, 0x61, 0x11,
        0x45, 0x50, 0xc4, 0xa4, 0x1e, 0x78, 0x22, 0x16, 0x66, 0x34, 0x6d, 0x7d, 0x4a, 0xd2, 0xe7,
        0x69, 0xfd, 0x14, 0xd8, 0xda, 0x31, 0x36, 0x48, 0x73, 0x10, 0x01, 0x20, 0xcb, 0xa2, 0x78,
        0xbb, 0x92, 0x29, 0xc2, 0x84, 0x87, 0x2f, 0x2a, 0x67, 0x88,
    ];

    fn words() -> Vec<u8> {
        let lines: Vec<String> = (0..40).map(|i| format!("{} {i}\n", i * i % 97)).collect();
        lines.concat().into_bytes()
    }

    fn unpacked(packed: &[u8]) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        Decoder::new(packed).read_to_end(&mut bytes).map(|_| bytes)
    }

    #[test]
    fn what_libbz2_packs_is_unpacked() {
        assert_eq!(unpacked(HELLO).unwrap(), b"hello");
        assert_eq!(unpacked(RUN).unwrap(), vec![b'a'; 8000]);
        assert_eq!(unpacked(WORDS).unwrap(), words());
        let twice = [HELLO, HELLO].concat();
        assert_eq!(unpacked(&twice).unwrap(), b"hellohello");
    }

    #[test]
    fn damage_is_answered_everywhere() {
        for packed in [HELLO, RUN, WORDS] {
            for length in 0..packed.len() {
                assert!(unpacked(&packed[..length]).is_err(), "{length}");
            }
            for at in 0..packed.len() {
                let mut packed = packed.to_vec();
                packed[at] ^= 0x55;
                let _ = unpacked(&packed);
            }
        }
    }
}
