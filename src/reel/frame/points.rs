//! Coordinates of points below their cells: bits, or ranks among the floats that are in the cell.

use super::columns::{ordered32, ordered64, unordered32, unordered64};
use super::grid::Grid;
use super::schema::{Kept, Schema, Values};
use crate::cloud::{Attributes, Positions};
use glam::Vec3;

/// The place in the order of all floats of the least one that is not below a border. Zero begins with −0.
fn first_rank(is_double: bool, border: f64) -> u64 {
    if is_double {
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

/// The first rank in a cell, and how many there are.
pub(super) fn ranks(is_double: bool, grid: &Grid, axis: usize, index: u64) -> (u64, u64) {
    let first = first_rank(is_double, grid.border(axis, index));
    let end = first_rank(is_double, grid.border(axis, index + 1));
    (first, end.saturating_sub(first).max(1))
}

/// The bits of a coordinate.
fn bits(positions: &Positions, index: usize, axis: usize) -> u64 {
    match positions {
        Positions::F32(positions) => u64::from(positions[index][axis].to_bits()),
        Positions::F64(positions) => positions[index][axis].to_bits(),
    }
}

fn rank(positions: &Positions, index: usize, axis: usize) -> u64 {
    match positions {
        Positions::F32(positions) => u64::from(ordered32(positions[index][axis].to_bits())),
        Positions::F64(positions) => ordered64(positions[index][axis].to_bits()),
    }
}

/// The bits of the float at a place in the order of all.
pub(super) fn bits_of_rank(is_double: bool, rank: u64) -> u64 {
    if is_double {
        unordered64(rank)
    } else {
        u64::from(unordered32(rank as u32))
    }
}

/// Whether a point is among the floats of its cell, and so of all cells around that: always, but for rounding where
/// cells are finer than floats.
pub(super) fn has_rank(grid: &Grid, positions: &Positions, index: usize) -> bool {
    let is_double = matches!(positions, Positions::F64(_));
    let position = positions.get(index);
    (0..3).all(|axis| {
        let (first, count) = ranks(is_double, grid, axis, grid.index(axis, position[axis]));
        (first..first.saturating_add(count)).contains(&rank(positions, index, axis))
    })
}

/// What is below the cells of points.
pub(super) fn below(schema: &Schema, grid: &Grid, positions: &Positions, order: &[u32]) -> Vec<[u64; 3]> {
    let of_point = |&point: &u32| {
        let index = point as usize;
        let position = positions.get(index);
        [0, 1, 2].map(|axis| match schema.kept {
            Kept::Merged => 0,
            Kept::Exact => {
                let cell = grid.index(axis, position[axis]);
                rank(positions, index, axis).saturating_sub(ranks(schema.is_double, grid, axis, cell).0)
            }
            Kept::Bits(bits) => {
                let finest = Grid {
                    cell: grid.cell / (1u64 << bits) as f64,
                    ..*grid
                };
                let offset = ((position[axis] - grid.min[axis]) / finest.cell).floor().max(0.0) as u64;
                let cell = grid.index(axis, position[axis]);
                offset.saturating_sub(cell << bits).min((1 << bits) - 1)
            }
        })
    };
    order.iter().map(of_point).collect()
}

/// The coordinates of some points as bits.
pub(super) fn bits_of(positions: &Positions, order: &[u32]) -> Vec<[u64; 3]> {
    let of_point = |&point: &u32| [0, 1, 2].map(|axis| bits(positions, point as usize, axis));
    order.iter().map(of_point).collect()
}

/// Normals, radii, ellipses and scalars as they are, in this order.
pub(super) fn columns(schema: &Schema, attributes: &Attributes, order: &[u32]) -> Vec<Vec<u32>> {
    let mut columns = Vec::new();
    let mut add = |value: &dyn Fn(usize) -> f32| {
        columns.push(order.iter().map(|&point| value(point as usize).to_bits()).collect());
    };
    if let (Some(normals), true) = (&attributes.normals, schema.has_exact_normals) {
        for axis in 0..3 {
            add(&|point| Vec3::from(normals[point])[axis]);
        }
    }
    if let (Some(radii), Values::Exact) = (&attributes.radii, schema.radii) {
        add(&|point| radii[point]);
    }
    if let (Some(ellipses), true) = (&attributes.ellipses, schema.has_ellipses) {
        for axis in 0..3 {
            add(&|point| ellipses[point].axis[axis]);
        }
        add(&|point| ellipses[point].ratio);
    }
    if schema.has_exact_scalars {
        for field in &attributes.scalars {
            add(&|point| field.values[point]);
        }
    }
    columns
}
