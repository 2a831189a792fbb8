//! Values of levels come back, as near as they may be; and invalid bytes do not panic.

use super::{NO_NORMAL, SLACK, Upwards, code_colors, code_normals, code_offsets, code_singles};
use crate::reel::coder::{SymbolCoder, SymbolDecoder, SymbolEncoder};
use crate::reel::parent_level::{Families, ParentValue};
use proptest::prelude::*;

/// A level below another one.
#[derive(Debug, Clone)]
struct Tree {
    /// The values of the level above the parents, and of the parents.
    masks: [Vec<u8>; 2],
    /// Points of cells, and outside.
    counts: Vec<u32>,
    outside: usize,
    has_points: bool,
    parent_value: ParentValue,
}

fn trees() -> impl Strategy<Value = Tree> {
    let mask = prop_oneof![1u8..=255, (0u32..8).prop_map(|octant| 1 << octant)];
    let below = prop::collection::vec(mask.clone(), 8 * 300);
    let parent_value = prop::sample::select(vec![ParentValue::Mean, ParentValue::FirstChild]);
    let above = prop::collection::vec(mask, 1..300);
    (above, below, any::<bool>(), 0usize..700, parent_value).prop_map(
        |(above, mut masks, has_points, outside, parent_value)| {
            masks.truncate(above.iter().map(|mask| mask.count_ones() as usize).sum());
            let counts = masks.iter().map(|&mask| u32::from(mask % 11)).collect();
            Tree {
                masks: [above, masks],
                counts,
                outside,
                has_points,
                parent_value,
            }
        },
    )
}

impl Tree {
    fn parents(&self) -> usize {
        self.masks[1].len()
    }

    fn upwards(&self) -> Upwards<'_> {
        Upwards {
            families: if self.has_points {
                Families::Counts(&self.counts, self.outside)
            } else {
                Families::Masks(&self.masks[1])
            },
            masks: if self.has_points { &[] } else { &self.masks[0] },
            parent_value: self.parent_value,
        }
    }

    fn nodes(&self) -> usize {
        if self.has_points {
            self.counts.iter().map(|&count| count as usize).sum::<usize>() + self.outside
        } else {
            self.masks[1].iter().map(|mask| mask.count_ones() as usize).sum()
        }
    }

    /// Each node's parent, and true if it has its value: an only child, or a first one.
    fn owners(&self) -> Vec<(usize, bool)> {
        let counts: Vec<usize> = if self.has_points {
            self.counts.iter().map(|&count| count as usize).collect()
        } else {
            self.masks[1].iter().map(|mask| mask.count_ones() as usize).collect()
        };
        let knows_first = self.parent_value == ParentValue::FirstChild;
        let owner = |(parent, count): (usize, usize)| {
            (0..count).map(move |child| (parent, count == 1 || knows_first && child == 0))
        };
        counts.into_iter().enumerate().flat_map(owner).collect()
    }
}

/// Some number for each place.
fn numbers(count: usize, seed: u64) -> impl Iterator<Item = u64> {
    (0..count as u64).map(move |place| {
        let number = (place + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15 ^ seed.wrapping_mul(0xbf58_476d));
        number ^ number >> 29
    })
}

/// A kind of values.
struct Kind<V> {
    make: fn(u64) -> V,
    /// As near the parent as numbers of this many bits.
    near: fn(V, u64, u32) -> V,
    decode: fn(&mut SymbolDecoder<'_>, Upwards<'_>, &[V], &mut [V], u8),
    encode: fn(&mut SymbolEncoder, Upwards<'_>, &[V], &mut [V], u8),
    is_near: fn(V, V, u8) -> bool,
}

/// Codes a level, compares it, and reads it again with bytes changed.
fn check<V: Copy + Default + PartialEq + std::fmt::Debug>(
    kind: &Kind<V>,
    tree: &Tree,
    seed: u64,
    bits: u32,
    parameter: u8,
    changes: &[(prop::sample::Index, u8)],
) {
    let parents: Vec<V> = numbers(tree.parents(), seed).map(kind.make).collect();
    let owners = tree.owners();
    let mut values: Vec<V> = numbers(tree.nodes(), !seed)
        .enumerate()
        .map(|(node, number)| match owners.get(node) {
            Some(&(parent, true)) => parents[parent],
            Some(&(parent, false)) => (kind.near)(parents[parent], number, bits),
            None => (kind.make)(number),
        })
        .collect();
    let given = values.clone();
    values.resize(given.len() + SLACK, V::default());
    let mut encoder = SymbolEncoder::new(1);
    (kind.encode)(&mut encoder, tree.upwards(), &parents, &mut values, parameter);
    let mut bytes = encoder.finish();
    for (given, value) in given.iter().zip(&values) {
        assert!((kind.is_near)(*given, *value, parameter), "{given:?} became {value:?}");
    }
    let mut decoder = SymbolDecoder::new(&bytes, 1).unwrap();
    let mut read = vec![V::default(); given.len() + SLACK];
    (kind.decode)(&mut decoder, tree.upwards(), &parents, &mut read, parameter);
    assert!(decoder.is_at_end());
    assert_eq!(read[..given.len()], values[..given.len()]);
    for (place, value) in changes {
        if !bytes.is_empty() {
            *place.get_mut(&mut bytes) = *value;
        }
    }
    if let Ok(mut decoder) = SymbolDecoder::new(&bytes, 1) {
        (kind.decode)(&mut decoder, tree.upwards(), &parents, &mut read, parameter);
    }
}

fn changes() -> impl Strategy<Value = Vec<(prop::sample::Index, u8)>> {
    prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..9)
}

/// A normal of a grid of 13, 15 or 17 bits; few are missing.
fn normal(number: u64, bits: u8) -> u32 {
    if number.is_multiple_of(13) {
        return NO_NORMAL;
    }
    let first = u32::from(bits - 3) / 2 + 2;
    (number >> 8) as u32 & ((1 << first) - 1) | ((number >> 30) as u32 & ((1 << (first - 1)) - 1)) << 16
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn colors_are_close_to_the_input(tree in trees(), seed: u64, bits in 0u32..9, error in 0u8..=100,
        changes in changes()) {
        let kind = Kind {
            make: |number| { let [r, g, b, ..] = number.to_le_bytes(); [r, g, b, 255] },
            near: |[red, green, blue, _]: [u8; 4], number, bits| {
                let mask = ((1u32 << bits) - 1) as u8;
                let [r, g, b, ..] = (number >> 9).to_le_bytes();
                [red.wrapping_add(r & mask), green.saturating_sub(g & mask), blue ^ b & mask, 255]
            },
            decode: |coder, upwards, parents, values, step| code_colors(coder, upwards, parents, values, step),
            encode: |coder, upwards, parents, values, step| code_colors(coder, upwards, parents, values, step),
            is_near: |given, is, step| given.iter().zip(is).all(|(given, is)| given.abs_diff(is) <= step / 2),
        };
        check(&kind, &tree, seed, bits, 2 * error + 1, &changes);
    }

    #[test]
    fn normals_round_trip(tree in trees(), seed: u64, bits in 0u32..9, grid in 0u8..3, changes in changes()) {
        let kind = Kind {
            make: |number| normal(number, 13),
            near: |parent: u32, number, bits| {
                if number % 17 == 0 || parent == NO_NORMAL {
                    return normal(number >> 3, 13);
                }
                let near = (number >> 20) as u32 & ((1 << bits) - 1);
                (parent & 0xffff ^ near) & 127 | ((parent >> 16).wrapping_sub(near) & 63) << 16
            },
            decode: |coder, upwards, parents, values, bits| code_normals(coder, bits, upwards, parents, values),
            encode: |coder, upwards, parents, values, bits| code_normals(coder, bits, upwards, parents, values),
            is_near: |given, is, _| given == is || given & is & NO_NORMAL != 0,
        };
        check(&kind, &tree, seed, bits, 13 + 2 * grid, &changes);
    }

    #[test]
    fn single_numbers_round_trip(tree in trees(), seed: u64, bits in 0u32..17, changes in changes()) {
        let kind = Kind {
            make: |number| [number as u16],
            near: |[parent]: [u16; 1], number, bits| {
                [parent.saturating_add(((number >> 20) & ((1 << bits) - 1)) as u16)]
            },
            decode: |coder, upwards, parents, values, _| code_singles(coder, upwards, parents, values, u16::MAX),
            encode: |coder, upwards, parents, values, _| code_singles(coder, upwards, parents, values, u16::MAX),
            is_near: |given, is, _| given == is,
        };
        check(&kind, &tree, seed, bits, 0, &changes);
    }

    #[test]
    fn offsets_round_trip(mut offsets in prop::collection::vec(0u8..16, 0..70), bits in 1u8..=4) {
        for offset in &mut offsets {
            *offset &= (1 << bits) - 1;
        }
        let mut encoder = SymbolEncoder::new(1);
        code_offsets(&mut encoder, bits, &mut offsets);
        let bytes = encoder.finish();
        let mut decoder = SymbolDecoder::new(&bytes, 1).unwrap();
        let mut read = vec![0; offsets.len()];
        code_offsets(&mut decoder, bits, &mut read);
        prop_assert!(decoder.is_at_end());
        prop_assert_eq!(read, offsets);
    }
}

/// Slopes pay off where values change within families as they do between them.
#[test]
fn slopes_are_used_where_they_save_space() {
    let tree = Tree {
        masks: [vec![255; 64], vec![255; 512]],
        counts: Vec::new(),
        outside: 0,
        has_points: false,
        parent_value: ParentValue::Mean,
    };
    let has_slopes = |change: i32| {
        let color = |along: i32| [along as u8, 200, 9, 255];
        let side = |node: usize, axis: usize| if node >> axis & 1 == 0 { -1 } else { 1 };
        let parents: Vec<[u8; 4]> = (0..512).map(|parent| color(128 + 24 * side(parent, 0))).collect();
        let mut values: Vec<[u8; 4]> = (0..4096)
            .map(|node| color(128 + 24 * side(node, 3) + change * side(node, 0)))
            .collect();
        values.resize(values.len() + SLACK, [0; 4]);
        let mut encoder = SymbolEncoder::new(1);
        code_colors(&mut encoder, tree.upwards(), &parents, &mut values, 1);
        let bytes = encoder.finish();
        let mut decoder = SymbolDecoder::new(&bytes, 1).unwrap();
        decoder.raw(3, 0);
        decoder.raw(1, 0) != 0
    };
    assert!(has_slopes(12));
    assert!(!has_slopes(-12));
    assert!(!has_slopes(0));
}
