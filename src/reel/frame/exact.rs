//! Data kept per point: how many points are in each cell, where they are in it, and numbers verbatim.

use super::columns::{code_counts, code_even, code_floats, code_missing_bits};
use super::grid::Grid;
use super::levels::PosePoints;
use super::schema::{Retained, Schema, StreamKind, Values};
use crate::math::morton;
use crate::reel::coder::{BitCoder, BitModel};
use crate::reel::error::Fault;

/// Numbers of points in cells, and the bits below.
pub(super) fn code_positions<C: BitCoder>(
    coder: &mut C,
    schema: &Schema,
    grid: &Grid,
    cells: &[u64],
    points: &mut PosePoints,
) -> Result<(), Fault> {
    code_counts(coder, &mut points.counts);
    let total: u64 = points.counts.iter().map(|&count| u64::from(count)).sum();
    if total != points.below.len() as u64 {
        return Err(Fault::new(format!(
            "cells have {total} points instead of {}",
            points.below.len()
        )));
    }
    if let Retained::Bits(bits) = schema.retained {
        code_missing_bits(coder, &mut points.missing_bits, &points.counts, bits);
    }
    let missing = points.missing_bits.iter().copied().chain(std::iter::repeat(0));
    let mut below = points.below.iter_mut();
    for ((&cell, missing), &count) in cells.iter().zip(missing).zip(&points.counts) {
        let cell = morton::decode(cell);
        let spans = [0, 1, 2].map(|axis| match schema.retained {
            Retained::Exact => schema.floats().ranks(grid, axis, u64::from(cell[axis])).1,
            _ => 0,
        });
        for point in below.by_ref().take(count as usize) {
            for (axis, value) in point.iter_mut().enumerate() {
                *value = match schema.retained {
                    Retained::Merged => 0,
                    Retained::Bits(bits) => coder.even_bits(u32::from(bits - missing), *value >> missing) << missing,
                    Retained::Exact => code_even(coder, spans[axis], *value),
                };
            }
        }
    }
    let bits = if schema.is_double { 64 } else { 32 };
    let mut same = BitModel::default();
    let mut last = [0; 3];
    for point in &mut points.outside {
        let is_same = coder.bit(&mut same, *point == last);
        *point = if is_same {
            last
        } else {
            point.map(|value| coder.even_bits(bits, value))
        };
        last = *point;
    }
    Ok(())
}

/// Codes columns of numbers that are stored unchanged.
pub(super) fn code_columns<C: BitCoder>(coder: &mut C, columns: &mut [Vec<u32>]) {
    for column in columns {
        code_floats(coder, column);
    }
}

/// Columns by the stream that they are in.
pub(super) fn columns_by_kind<'a>(
    schema: &Schema,
    mut columns: &'a mut [Vec<u32>],
) -> Vec<(StreamKind, &'a mut [Vec<u32>])> {
    let of_kind = |(kind, count): (StreamKind, usize)| {
        let count = count.min(columns.len());
        let (of_kind, rest) = std::mem::take(&mut columns).split_at_mut(count);
        columns = rest;
        (kind, of_kind)
    };
    columns_of(schema).map(of_kind).collect()
}

/// Columns of unchanged numbers: their attribute and count, in the order in which they are stored.
pub(super) fn columns_of(schema: &Schema) -> impl Iterator<Item = (StreamKind, usize)> {
    let all = [
        (StreamKind::Normal, 3 * usize::from(schema.has_exact_normals)),
        (StreamKind::Radius, usize::from(schema.radii == Values::Exact)),
        (StreamKind::Ellipse, 4 * usize::from(schema.has_ellipses)),
        (
            StreamKind::Scalar,
            if schema.has_exact_scalars {
                schema.scalars.len()
            } else {
                0
            },
        ),
    ];
    all.into_iter().filter(|&(_, count)| count > 0)
}
