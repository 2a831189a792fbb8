//! RVL (Wilson 2017): runs of holes and runs of depths by turns, and differences of depths, in groups of three bits.
//!
//! A number is nibbles, its lowest three bits first; the highest bit of a nibble says that one more follows. Nibbles
//! fill words of 32 bits from the top, which are written little endian. Differences have their sign in the lowest bit,
//! and go on over holes. Width and height stand before the words.

use super::pixels::{DEPTH_PIXEL_BYTES, MAX_EDGE_PX, Raster, Samples};

/// Nibbles that hold 16 bits, a sign, or the pixels of the largest image.
const MAX_NIBBLES: u32 = 11;

/// The image in `bytes`, which takes no more than `max_bytes`; the error is the end of a sentence.
pub(crate) fn decode(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    let (&[width, height], words) = bytes
        .as_chunks()
        .0
        .split_first_chunk()
        .ok_or("it is shorter than its width and height")?;
    let [width, height] = [width, height].map(u32::from_le_bytes);
    let edges = 1..=MAX_EDGE_PX;
    let pixels = u64::from(width) * u64::from(height);
    if !edges.contains(&width) || !edges.contains(&height) || DEPTH_PIXEL_BYTES * pixels > max_bytes {
        return Err(format!(
            "it claims {width} × {height} pixels: 1 to {MAX_EDGE_PX} along an edge are read, of {DEPTH_PIXEL_BYTES} \
             bytes each until they are points, and {max_bytes} bytes of memory are allowed: raise --max-memory if the \
             machine has it"
        ));
    }
    let mut nibbles = Nibbles {
        words,
        word: 0,
        left: 0,
    };
    let samples = nibbles
        .depths(pixels as usize)
        .ok_or("it ends early, or holds more pixels than it claims")?;
    Ok(Raster {
        size_px: [width, height],
        samples: Samples::Gray16(samples),
    })
}

struct Nibbles<'a> {
    /// Words not yet begun.
    words: &'a [[u8; 4]],
    word: u32,
    /// Nibbles of it that were not read.
    left: u32,
}

impl Nibbles<'_> {
    fn number(&mut self) -> Option<u32> {
        let mut number = 0;
        for place in 0..MAX_NIBBLES {
            if self.left == 0 {
                let (&word, words) = self.words.split_first()?;
                (self.word, self.words) = (u32::from_le_bytes(word), words);
                self.left = 8;
            }
            let nibble = self.word >> 28;
            self.word <<= 4;
            self.left -= 1;
            number |= (nibble & 7).checked_shl(3 * place)?;
            if nibble & 8 == 0 {
                return Some(number);
            }
        }
        None
    }

    /// The given number of depths. Memory grows with the data that is there: a run of holes of the whole image is a few
    /// bytes, but the size of the image was checked.
    fn depths(&mut self, count: usize) -> Option<Vec<u16>> {
        let mut depths = Vec::with_capacity(count);
        let mut last = 0u16;
        while depths.len() < count {
            let holes = self.number()? as usize;
            let left = count - depths.len();
            if holes > left {
                return None;
            }
            depths.resize(depths.len() + holes, 0);
            let measured = self.number()? as usize;
            if measured > left - holes || holes + measured == 0 {
                return None;
            }
            for _ in 0..measured {
                let code = self.number()?;
                let difference = (code >> 1) as i32 ^ -((code & 1) as i32);
                last = last.wrapping_add(difference as u16);
                depths.push(last);
            }
        }
        Some(depths)
    }
}

/// The bytes of an image of `depths`. Precondition: one depth per pixel.
pub(crate) fn encode(size_px: [u32; 2], depths: &[u16]) -> Vec<u8> {
    let mut written = WrittenNibbles {
        // Neighbours are usually similar: one or two nibbles each.
        bytes: Vec::with_capacity(depths.len() + 16),
        word: 0,
        count: 0,
    };
    written.bytes.extend(size_px.into_iter().flat_map(u32::to_le_bytes));
    let (mut rest, mut last) = (depths, 0i32);
    while !rest.is_empty() {
        let holes = rest.iter().take_while(|&&depth| depth == 0).count();
        rest = &rest[holes..];
        let measured = rest.iter().take_while(|&&depth| depth != 0).count();
        written.number(holes as u32);
        written.number(measured as u32);
        for &depth in &rest[..measured] {
            let difference = i32::from(depth) - last;
            written.number(((difference << 1) ^ (difference >> 31)) as u32);
            last = i32::from(depth);
        }
        rest = &rest[measured..];
    }
    written.end()
}

struct WrittenNibbles {
    bytes: Vec<u8>,
    word: u32,
    /// Nibbles in it.
    count: u32,
}

impl WrittenNibbles {
    fn number(&mut self, mut number: u32) {
        loop {
            let more = u32::from(number > 7) << 3;
            self.word = (self.word << 4) | (number & 7) | more;
            self.count += 1;
            if self.count == 8 {
                self.bytes.extend(self.word.to_le_bytes());
                (self.word, self.count) = (0, 0);
            }
            number >>= 3;
            if more == 0 {
                return;
            }
        }
    }

    fn end(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.word <<= 4 * (8 - self.count);
            self.bytes.extend(self.word.to_le_bytes());
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn images_round_trip(
            depths in prop::collection::vec(prop_oneof![Just(0u16), 900u16..1100, any::<u16>()], 1..400),
        ) {
            let size = [depths.len() as u32, 1];
            let raster = decode(&encode(size, &depths), 1 << 20).unwrap();
            prop_assert_eq!(raster.size_px, size);
            prop_assert_eq!(raster.samples, Samples::Gray16(depths));
        }

        #[test]
        fn damage_is_an_error_and_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = decode(&bytes, 1 << 16);
        }
    }

    /// Worked out by hand: two holes, three depths 5, 4 and 12.
    #[test]
    fn a_hand_written_line_is_decoded() {
        // Runs 2 and 3; differences +5, -1, +8 become 10, 1, 16: nibbles 2, 3, a 1, 1, 8 2.
        let bytes = [5u32, 1, 0x23a1_1820].map(u32::to_le_bytes).concat();
        let raster = decode(&bytes, 1 << 16).unwrap();
        assert_eq!(raster.samples, Samples::Gray16(vec![0, 0, 5, 4, 12]));
        assert_eq!(encode([5, 1], &[0, 0, 5, 4, 12]), bytes);
        assert!(decode(&bytes[..8], 1 << 16).is_err());
        assert!(decode(&bytes, 9).unwrap_err().contains("9 bytes"));
    }
}
