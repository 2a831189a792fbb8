//! Local point spacing around each point, and thus the edge of the cell that may stand for it.
//!
//! How it works: the distance of each point to the nearest other position is found; the spacing at a point is the
//! median of that distance among the points around it. So two points that nearly coincide do not need cells that
//! separate them, and a dense part of a scan gets finer cells than a sparse one. The medians of three neighbourhoods
//! are taken and the least counts: where density changes, measuring it over another neighbourhood still finds the bound
//! kept.

use crate::analysis::nearest_neighbours;
use crate::cloud::{Positions, RawCloud};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A position is off by no more than the spacing around it over this.
// An eighth costs 15.3 bits per point for positions (walking man, 50,000 points); merged points take 6.5 bits with all
// attributes.
pub(in crate::reel) const SPACING_PARTS: f64 = 8.0;

/// Points around a point that are looked at.
const NEIGHBOURS: usize = 12;

/// Number of neighbours in each neighbourhood.
const NEIGHBOURHOODS: [usize; 3] = [4, 8, NEIGHBOURS];

/// Computes the largest edge of a cell that may stand for each point: no corner of it is farther from the centre than
/// the spacing allows, once the centre is rounded to a float of the file. Points that are not `placed` have none:
/// infinity.
pub(super) fn largest_cells(cloud: &RawCloud, placed: &[u32]) -> Vec<f64> {
    // Turns −0 into 0.
    let position = |point: u32| cloud.positions.get(point as usize) + DVec3::ZERO;
    let key = |point: u32| position(point).to_array().map(f64::to_bits);
    let mut order = placed.to_vec();
    order.par_sort_unstable_by_key(|&point| (key(point), point));
    let mut distinct: Vec<DVec3> = Vec::new();
    let mut place_of_each = Vec::with_capacity(order.len());
    for &point in &order {
        let position = position(point);
        if distinct.last() != Some(&position) {
            distinct.push(position);
        }
        place_of_each.push(distinct.len() - 1);
    }
    let (float_bits, from) = match &cloud.positions {
        // Differences of single-precision numbers may need more bits than these have.
        Positions::F32(_) => (24, DVec3::ZERO),
        Positions::F64(_) => (53, distinct.iter().copied().reduce(DVec3::min).unwrap_or_default()),
    };
    let spacings = spacings(&distinct, from);
    let mut edges = vec![f64::INFINITY; cloud.positions.len()];
    for (&point, &place) in order.iter().zip(&place_of_each) {
        // Per point, not per group, so that a dense corner does not make all points expensive.
        edges[point as usize] = largest_cell(spacings[place], distinct[place], float_bits);
    }
    edges
}

/// The edge for a spacing at a position, whose coordinates are floats with this number of bits.
fn largest_cell(spacing: f64, position: DVec3, float_bits: i32) -> f64 {
    let largest = position.abs().max_element().max(f64::MIN_POSITIVE);
    // The distance between floats of that magnitude.
    let rounding = (power_of_two_below(largest) * 2f64.powi(1 - float_bits)).max(f64::from(f32::from_bits(1)));
    // The distance from the centre of a cube to its corners is half of its diagonal.
    let edge = spacing / SPACING_PARTS * 2.0 / 3f64.sqrt() * (1.0 - 1e-6);
    if edge.is_finite() {
        // Rounding moves the centre by half of the rounding, or by half of the cell if a float lies inside it.
        (edge - rounding).max(0.5 * edge)
    } else {
        rounding
    }
}

/// The largest power of two that is not above a positive number.
fn power_of_two_below(number: f64) -> f64 {
    f64::from_bits(number.to_bits() & !((1 << 52) - 1)).max(f64::MIN_POSITIVE)
}

/// The spacing around each of some positions, no two of them alike; infinity around a single one. They are looked for
/// as singles, in relation to `from`.
fn spacings(positions: &[DVec3], from: DVec3) -> Vec<f64> {
    if positions.len() < 2 {
        return vec![f64::INFINITY; positions.len()];
    }
    let reach = positions
        .iter()
        .map(|&position| (position - from).abs().max_element())
        .fold(0.0, f64::max);
    let scale = power_of_two_below(reach.max(f64::MIN_POSITIVE)).recip().min(f64::MAX);
    let narrow: Vec<Vec3> = positions
        .iter()
        .map(|&position| ((position - from) * scale).as_vec3())
        .collect();
    let neighbours = nearest_neighbours(&narrow, NEIGHBOURS);
    let nearest = |point: usize| {
        let others = neighbours.of(point).iter();
        let lengths = others.map(|&other| positions[other as usize].distance_squared(positions[point]));
        lengths.fold(f64::INFINITY, f64::min).sqrt()
    };
    let nearest: Vec<f64> = (0..positions.len()).into_par_iter().map(nearest).collect();
    let spacing = |point: usize| {
        let around = neighbours.of(point);
        let of_neighbourhood = |&count: &usize| {
            let others = around.iter().take(count).map(|&other| nearest[other as usize]);
            let mut lengths: Vec<f64> = others.chain([nearest[point]]).collect();
            let center = (lengths.len() - 1) / 2;
            *lengths.select_nth_unstable_by(center, f64::total_cmp).1
        };
        NEIGHBOURHOODS
            .iter()
            .map(of_neighbourhood)
            .fold(f64::INFINITY, f64::min)
    };
    let mut spacings: Vec<f64> = (0..positions.len()).into_par_iter().map(spacing).collect();
    for clump in clumps(&narrow) {
        let of_clump: Vec<DVec3> = clump.iter().map(|&point| positions[point as usize]).collect();
        let from = of_clump.iter().copied().reduce(DVec3::min).unwrap_or_default();
        // Only if that resolves them any better.
        if clump.len() < positions.len() || from != DVec3::ZERO {
            for (&point, spacing) in clump.iter().zip(spacings_of_clump(&of_clump, from)) {
                spacings[point as usize] = spacing;
            }
        }
    }
    spacings
}

/// [`spacings`] of positions that coincided as singles. Where they still cannot be distinguished, they get the spacing
/// of the nearest of all pairs of a row: each is finer than necessary.
fn spacings_of_clump(positions: &[DVec3], from: DVec3) -> Vec<f64> {
    let reach = positions
        .iter()
        .map(|&position| (position - from).abs().max_element())
        .fold(0.0, f64::max);
    if reach > 0.0 && reach.is_normal() {
        spacings(positions, from)
    } else {
        vec![f64::MIN_POSITIVE; positions.len()]
    }
}

/// Positions that are one as singles, more of them than are looked at around each.
fn clumps(narrow: &[Vec3]) -> Vec<Vec<u32>> {
    let key = |point: u32| (narrow[point as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..narrow.len() as u32).collect();
    order.par_sort_unstable_by_key(|&point| (key(point), point));
    let clumps = order.chunk_by(|&a, &b| key(a) == key(b));
    clumps
        .filter(|clump| clump.len() > NEIGHBOURS)
        .map(<[u32]>::to_vec)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacing_is_that_of_the_surrounding_points() {
        let line: Vec<DVec3> = (0..40).map(|place| DVec3::new(f64::from(place), 0.0, 0.0)).collect();
        assert!(spacings(&line, DVec3::ZERO).iter().all(|&spacing| spacing == 1.0));
        assert_eq!(spacings(&line[..1], DVec3::ZERO), [f64::INFINITY]);
        // A pair does not demand more precision than its surroundings.
        let mut with_pair = line.clone();
        with_pair.push(DVec3::new(20.0, 1e-9, 0.0));
        assert!(spacings(&with_pair, DVec3::ZERO).iter().all(|&spacing| spacing == 1.0));
    }

    #[test]
    fn spacing_is_found_below_single_precision() {
        let fine = (0..40).map(|place| DVec3::new(3.0 + 1e-10 * f64::from(place), 0.0, 0.0));
        // So far away that none of the fine points is among the neighbours of a coarse one.
        let coarse = (0..40).map(|place| DVec3::new(f64::from(place) * 100.0, 1e5, 0.0));
        let positions: Vec<DVec3> = fine.chain(coarse).collect();
        let found = spacings(&positions, DVec3::ZERO);
        for (place, spacing) in found.iter().enumerate() {
            let expected = if place < 40 { 1e-10 } else { 100.0 };
            assert!((spacing / expected - 1.0).abs() < 0.01, "{place}: {spacing}");
        }
    }

    #[test]
    fn cell_corners_are_an_eighth_of_the_spacing_away() {
        let half_diagonal = |edge: f64| 0.5 * 3f64.sqrt() * edge;
        assert!((half_diagonal(largest_cell(8.0, DVec3::ONE, 53)) - 1.0).abs() < 1e-5);
        // With large single-precision coordinates, space is left for the rounding.
        let edge = largest_cell(1.0, DVec3::splat(1e6), 24);
        assert!(half_diagonal(edge + 0.0625) <= 0.125, "{edge}");
        assert!(largest_cell(f64::INFINITY, DVec3::ONE, 24) <= 2f64.powi(-23));
    }
}
