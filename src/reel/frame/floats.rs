//! Numbers that the coordinates of a file may be, in their order: all floats, or the numbers of a lattice.
//!
//! How it works: a coordinate stored to its last bit is coded by its rank among the numbers that may be in its cell.
//! There are as many floats as the precision distinguishes. But most files were written with a fixed number of digits:
//! their coordinates are thousandths, or sixteenths of a pixel, or integers. There are few of those in a cell. The
//! lattice is looked for in the points; those that are not on it are stored outside cells.
//!
//! When it wins: former text files, LAS, E57 with scaled integers, voxels. For metres in thousandths around ten, in
//! single precision, each coordinate saves ten bits; in double precision thirty.

use super::columns::{ordered32, ordered64, unordered32, unordered64};
use super::grid::Grid;
use crate::cloud::{Positions, RawCloud};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};

/// Numbers of a lattice are within this from 0.
const MAX_NUMBER: f64 = (1u64 << 50) as f64;

/// Distance below the rank of 0 at which ranks of lattice numbers begin.
const RANK_OF_ZERO: i64 = 1 << 60;

/// Maximum distance of the first number in a cell from where it is looked for, in steps.
const MAX_STEPS: usize = 8;

/// Whole numbers of the same fraction of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::reel) struct Lattice {
    /// Numbers in a unit.
    per_unit: u64,
    /// Offset added to products with the fraction; without it, integers are divided, and zero is a number.
    offset: Option<[f64; 3]>,
}

impl Lattice {
    /// A number along an axis.
    fn value(self, axis: usize, number: f64) -> f64 {
        let per_unit = self.per_unit as f64;
        match self.offset {
            // The formula of LAS.
            Some(offset) => number * (1.0 / per_unit) + offset[axis],
            None => number / per_unit,
        }
    }

    /// About which number a coordinate is.
    fn about(self, axis: usize, coordinate: f64) -> f64 {
        (coordinate - self.offset.map_or(0.0, |offset| offset[axis])) * self.per_unit as f64
    }

    pub(super) fn write(self, writer: &mut ByteWriter) {
        writer.number(self.per_unit);
        writer.byte(u8::from(self.offset.is_some()));
        for offset in self.offset.into_iter().flatten() {
            writer.f64(offset);
        }
    }

    pub(super) fn read(reader: &mut ByteReader<'_>) -> Result<Self, Fault> {
        let per_unit = reader.number()?;
        let offset = match reader.byte()? {
            0 => None,
            _ => Some([reader.f64()?, reader.f64()?, reader.f64()?]),
        };
        let is_finite = offset.iter().flatten().all(|offset| offset.is_finite());
        if !(1..=1 << 50).contains(&per_unit) || !is_finite {
            return Err(Fault::new(format!(
                "coordinates of {per_unit} parts of a unit from {offset:?} on"
            )));
        }
        Ok(Self { per_unit, offset })
    }
}

/// The numbers that coordinates may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Floats {
    pub(super) is_double: bool,
    /// Lattice; if set, only numbers of the lattice.
    pub(super) lattice: Option<Lattice>,
}

impl Floats {
    /// Rounds a value to the precision of the file.
    fn rounded(self, value: f64) -> f64 {
        if self.is_double { value } else { f64::from(value as f32) }
    }

    fn number(self, lattice: Lattice, axis: usize, number: i64) -> f64 {
        self.rounded(lattice.value(axis, number as f64))
    }

    /// The rank of the least number that is not below a border. Zero begins with −0.
    fn first(self, axis: usize, border: f64) -> u64 {
        if let Some(lattice) = self.lattice {
            return rank_of(self.first_number(lattice, axis, border));
        }
        if self.is_double {
            let border = if border == 0.0 { -0.0 } else { border };
            return ordered64(border.to_bits());
        }
        let nearest = border as f32;
        let first = if f64::from(nearest) < border {
            nearest.next_up()
        } else {
            nearest
        };
        let first = if first == 0.0 { -0.0 } else { first };
        u64::from(ordered32(first.to_bits()))
    }

    fn first_number(self, lattice: Lattice, axis: usize, border: f64) -> i64 {
        let about = lattice.about(axis, border).ceil().clamp(-MAX_NUMBER, MAX_NUMBER);
        // Rounding may have shifted it by one.
        let mut number = about as i64;
        for _ in 0..MAX_STEPS {
            if self.number(lattice, axis, number - 1) < border {
                break;
            }
            number -= 1;
        }
        for _ in 0..MAX_STEPS {
            if self.number(lattice, axis, number) >= border {
                break;
            }
            number += 1;
        }
        number
    }

    /// The first rank in a cell, and how many there are.
    pub(super) fn ranks(self, grid: &Grid, axis: usize, index: u64) -> (u64, u64) {
        let first = self.first(axis, grid.border(axis, index));
        let end = self.first(axis, grid.border(axis, index + 1));
        (first, end.saturating_sub(first).max(1))
    }

    /// The rank of a coordinate; `None` if it is not on the lattice.
    fn rank(self, positions: &Positions, index: usize, axis: usize) -> Option<u64> {
        if let Some(lattice) = self.lattice {
            let coordinate = positions.get(index)[axis];
            let about = lattice.about(axis, coordinate).round();
            if about.abs() >= MAX_NUMBER || about.is_nan() {
                return None;
            }
            let is_it = |rank: &u64| self.of_rank(lattice, axis, *rank).to_bits() == coordinate.to_bits();
            // Zero has two representations, and rounding may have shifted a number by one.
            let ranks = [0, -1, 1].map(|step| rank_of(about as i64 + step));
            return ranks.into_iter().chain([RANK_OF_ZERO as u64]).find(is_it);
        }
        Some(match positions {
            Positions::F32(positions) => u64::from(ordered32(positions[index][axis].to_bits())),
            Positions::F64(positions) => ordered64(positions[index][axis].to_bits()),
        })
    }

    /// Returns the rank of a coordinate relative to the first of its cell.
    pub(super) fn rank_in_cell(self, grid: &Grid, positions: &Positions, index: usize, axis: usize) -> Option<u64> {
        let (first, count) = self.ranks(grid, axis, grid.index(axis, positions.get(index)[axis]));
        let above = self.rank(positions, index, axis)?.checked_sub(first)?;
        (above < count).then_some(above)
    }

    fn of_rank(self, lattice: Lattice, axis: usize, rank: u64) -> f64 {
        self.rounded(lattice.value(axis, number_of(rank)))
    }

    /// The bits of the number of a rank.
    pub(super) fn bits(self, axis: usize, rank: u64) -> u64 {
        match (self.lattice, self.is_double) {
            (Some(lattice), true) => self.of_rank(lattice, axis, rank).to_bits(),
            (Some(lattice), false) => u64::from((self.of_rank(lattice, axis, rank) as f32).to_bits()),
            (None, true) => unordered64(rank),
            (None, false) => u64::from(unordered32(rank as u32)),
        }
    }
}

/// The rank of a number, of −0 if it is 0: both are in texts. The rank of +0 is the next one.
fn rank_of(number: i64) -> u64 {
    (number + RANK_OF_ZERO - i64::from(number <= 0)) as u64
}

fn number_of(rank: u64) -> f64 {
    match (rank as i64).wrapping_sub(RANK_OF_ZERO) {
        -1 => -0.0,
        above @ 0.. => above as f64,
        below => (below + 1) as f64,
    }
}

/// Points of a cloud that are tried before all of them are.
const TRIED: usize = 256;

/// One point in this many may be off the lattice.
const POINTS_PER_OUTLIER: usize = 500;

/// The coarsest lattice that the points of clouds are on; `None` if there is none that saves anything.
pub(super) fn lattice_of(clouds: &[&RawCloud]) -> Option<Lattice> {
    let is_double = clouds.iter().any(|cloud| matches!(cloud.positions, Positions::F64(_)));
    let finite = |cloud: &&RawCloud| {
        let places = (0..cloud.positions.len()).map(|index| cloud.positions.get(index));
        places
            .filter(|place| place.is_finite())
            .fold(0.0, |most: f64, place| most.max(place.abs().max_element()))
    };
    let largest = clouds.iter().map(finite).fold(0.0, f64::max);
    let spacing = largest * 2f64.powi(if is_double { -52 } else { -23 });
    // With twice as many numbers as these, floats are encoded just as well directly.
    let most = (0.25 / spacing.max(f64::MIN_POSITIVE)).min(MAX_NUMBER / largest.max(1.0));
    let decimal = (0..10u32).flat_map(|digits| [1, 2, 4].map(|parts| parts * 10u64.pow(digits)));
    let binary = (2..=24u32).map(|bits| 1u64 << bits);
    let mut candidates: Vec<u64> = decimal
        .chain(binary)
        .filter(|&per_unit| per_unit as f64 <= most)
        .collect();
    candidates.sort_unstable();
    candidates.dedup();
    candidates.into_iter().find_map(|per_unit| {
        let plain = Lattice { per_unit, offset: None };
        let scaled = clouds.first().and_then(|cloud| offset_of(cloud, per_unit));
        let scaled = scaled.map(|offset| Lattice {
            per_unit,
            offset: Some(offset),
        });
        std::iter::once(plain).chain(scaled).find(|&lattice| {
            let is_on_each = |stride: &dyn Fn(usize) -> usize| {
                clouds.iter().all(|cloud| {
                    let count = cloud.positions.len();
                    is_on(lattice, cloud, stride(count).max(1))
                })
            };
            is_on_each(&|count| count / TRIED) && is_on_each(&|_| 1)
        })
    })
}

/// Returns true if the points of a cloud are on a lattice, all but few.
fn is_on(lattice: Lattice, cloud: &RawCloud, stride: usize) -> bool {
    let floats = Floats {
        is_double: matches!(cloud.positions, Positions::F64(_)),
        lattice: Some(lattice),
    };
    let count = cloud.positions.len();
    let tried = count / stride;
    let mut left = (tried / 16).min(4) + tried / POINTS_PER_OUTLIER;
    (0..count).step_by(stride).all(|index| {
        let is_on = (0..3).all(|axis| floats.rank(&cloud.positions, index, axis).is_some());
        let is_outlier = !is_on && left > 0;
        left -= usize::from(is_outlier);
        is_on || is_outlier
    })
}

/// Estimates the offset that was added to integers of a fraction: the roundest number that reproduces most of the first
/// coordinates.
fn offset_of(cloud: &RawCloud, per_unit: u64) -> Option<[f64; 3]> {
    let mut offset = [0.0; 3];
    let count = cloud.positions.len();
    for (axis, offset) in offset.iter_mut().enumerate() {
        let coordinates = (0..count).step_by((count / TRIED).max(1));
        let coordinates: Vec<f64> = coordinates.map(|index| cloud.positions.get(index)[axis]).collect();
        let least = coordinates
            .iter()
            .copied()
            .filter(|along| along.is_finite())
            .fold(f64::INFINITY, f64::min);
        if !least.is_finite() || !matches!(cloud.positions, Positions::F64(_)) {
            return None;
        }
        let round = (0..7)
            .rev()
            .map(|digits| (least / 10f64.powi(digits)).floor() * 10f64.powi(digits));
        let is_it = |offset: &f64| {
            let lattice = Lattice {
                per_unit,
                offset: Some([*offset; 3]),
            };
            let on = coordinates.iter().filter(|&&along| {
                let number = lattice.about(axis, along).round();
                number.abs() < MAX_NUMBER && lattice.value(axis, number) == along
            });
            on.count() * 20 >= coordinates.len() * 19
        };
        *offset = std::iter::once(0.0).chain(round).find(is_it)?;
    }
    Some(offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn grid(depth: u32) -> Grid {
        Grid {
            min: DVec3::splat(-128.0),
            cell: 256.0 / f64::from(1u32 << depth),
            depth,
        }
    }

    fn cloud(is_double: bool, along: &[f64]) -> RawCloud {
        RawCloud::from_positions(if is_double {
            Positions::F64(along.iter().map(|&along| [along; 3]).collect())
        } else {
            Positions::F32(along.iter().map(|&along| [along as f32; 3]).collect())
        })
    }

    proptest! {
        #[test]
        fn lattice_numbers_are_encoded_by_their_ranks(numbers in prop::collection::vec(-100_000i64..100_000, 1..50),
            depth in 1u32..21, per_unit in prop::sample::select(vec![1u64, 2, 64, 1000, 4000]),
            offset in prop::option::of(-3.0f64..3.0), is_double in any::<bool>()) {
            let offset = offset.map(|offset| [offset; 3]);
            let lattice = Lattice { per_unit, offset };
            let per_unit_and_more = numbers
                .iter()
                .map(|&number| lattice.value(0, (number * per_unit as i64 / 1000) as f64));
            let along: Vec<f64> = per_unit_and_more.filter(|along| along.abs() < 127.0).collect();
            let cloud = cloud(is_double, &along);
            let floats = Floats { is_double, lattice: Some(lattice) };
            let grid = grid(depth);
            for index in 0..along.len() {
                let coordinate = cloud.positions.get(index)[1];
                let above = floats.rank_in_cell(&grid, &cloud.positions, index, 1);
                let Some(above) = above else {
                    // Only rounding may put a number on the other side of a border.
                    prop_assert!(!is_double || offset.is_some(), "{} is not told", coordinate);
                    continue;
                };
                let (first, count) = floats.ranks(&grid, 1, grid.index(1, coordinate));
                prop_assert!(above < count);
                let bits = floats.bits(1, first + above);
                let found = if is_double { f64::from_bits(bits) } else { f64::from(f32::from_bits(bits as u32)) };
                prop_assert_eq!(found.to_bits(), coordinate.to_bits());
            }
        }
    }

    #[test]
    fn lattices_are_detected() {
        let number = |point: i64| point * 7919 % 50_021 - 25_000;
        let of = |is_double: bool, value: &dyn Fn(i64) -> f64| {
            let along: Vec<f64> = (0..2000).map(|point| value(number(point))).collect();
            lattice_of(&[&cloud(is_double, &along)])
        };
        let plain = |per_unit: u64| Some(Lattice { per_unit, offset: None });
        assert_eq!(of(false, &|number| number as f64 / 1000.0), plain(1000));
        assert_eq!(of(true, &|number| number as f64 / 100.0), plain(100));
        assert_eq!(of(false, &|number| number as f64 / 64.0), plain(64));
        assert_eq!(of(true, &|number| number as f64), plain(1));
        let scaled = of(true, &|number| number as f64 * 0.01 + 637_000.0);
        assert_eq!(scaled.map(|lattice| lattice.per_unit), Some(100));
        assert_eq!(of(false, &|number| f64::from(number as f32).sin()), None);
        // A few values off the lattice change nothing.
        let mut along: Vec<f64> = (0..2000).map(|point| number(point) as f64 / 1000.0).collect();
        along[77] = 0.123_456;
        along[78] = f64::NAN;
        assert_eq!(lattice_of(&[&cloud(false, &along)]), plain(1000));
    }
}
