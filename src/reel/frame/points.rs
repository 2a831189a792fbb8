//! Coordinates of points below their cells: bits, or ranks among the floats that are in the cell.

use super::floats::Floats;
use super::grid::Grid;
use super::schema::{Retained, Schema, Values};
use crate::cloud::{Attributes, Positions};
use glam::Vec3;

/// The bits of a coordinate.
fn bits(positions: &Positions, index: usize, axis: usize) -> u64 {
    match positions {
        Positions::F32(positions) => u64::from(positions[index][axis].to_bits()),
        Positions::F64(positions) => positions[index][axis].to_bits(),
    }
}

/// Returns true if a point is among the numbers of its cell, and so of all cells around that: always, except for
/// rounding where cells are finer than floats, and for points off the lattice.
pub(super) fn has_rank(floats: Floats, grid: &Grid, positions: &Positions, index: usize) -> bool {
    (0..3).all(|axis| floats.rank_in_cell(grid, positions, index, axis).is_some())
}

/// Returns the position bits below the cells of points.
pub(super) fn below(schema: &Schema, grid: &Grid, positions: &Positions, order: &[u32]) -> Vec<[u64; 3]> {
    let of_point = |&point: &u32| {
        let index = point as usize;
        let position = positions.get(index);
        [0, 1, 2].map(|axis| match schema.retained {
            Retained::Merged => 0,
            Retained::Exact => schema.floats().rank_in_cell(grid, positions, index, axis).unwrap_or(0),
            Retained::Bits(bits) => {
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
