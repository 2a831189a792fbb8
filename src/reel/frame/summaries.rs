//! Attributes as codes: of points, of the leaves that they are in, and of the nodes above, each the mean of the codes
//! below, or of colours the first.

use super::StreamKind;
use super::grid::Grid;
use super::levels::LevelValues;
use super::schema::{Retained, Schema};
use crate::cloud::{RawCloud, coarser_normal, quantise_normal};
use crate::math::morton;
use crate::reel::attributes::{MISSING, NormalGrid, offset_of};
use crate::reel::parent_level::ParentValue;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// A radius of a cell's edge has this code; sixteen codes are an octave, and 0 means no radius.
const RADIUS_OF_EDGE: f64 = 128.0;
const CODES_AN_OCTAVE: f64 = 16.0;

/// The code of a radius in edges of the cell.
fn radius_code(edges: f64) -> u16 {
    if edges > 0.0 {
        (RADIUS_OF_EDGE + CODES_AN_OCTAVE * edges.log2())
            .round()
            .clamp(1.0, 255.0) as u16
    } else {
        0
    }
}

/// The radius of a code in edges of the cell.
pub(super) fn radius_edges(code: u16) -> f64 {
    match code {
        0 => 0.0,
        code => ((f64::from(code) - RADIUS_OF_EDGE) / CODES_AN_OCTAVE).exp2(),
    }
}

/// Attributes of points as codes.
pub(super) struct PointValues<'a> {
    schema: &'a Schema,
    cloud: &'a RawCloud,
    edge: f64,
    grid: Grid,
}

/// Means of some nodes.
pub(super) struct Summaries {
    colors: Vec<[u16; 3]>,
    normals: Vec<Vec3>,
    places: Vec<[i16; 2]>,
    singles: Vec<Vec<[u16; 1]>>,
}

/// The children of each node of a level with these masks.
pub(super) fn children(masks: &[u8]) -> Vec<Range<usize>> {
    let mut next = 0;
    let of_node = |mask: &u8| {
        let start = next;
        next += mask.count_ones() as usize;
        start..next
    };
    masks.iter().map(of_node).collect()
}

impl LevelValues {
    pub(super) fn take(&mut self, summaries: &Summaries) {
        self.colors.clone_from(&summaries.colors);
        self.normals.clone_from(&summaries.places);
        self.singles.clone_from(&summaries.singles);
    }
}

fn mean(sum: u32, count: u32) -> u16 {
    ((2 * sum + count) / (2 * count)) as u16
}

fn place(grid: &NormalGrid, bits: u8, normal: Vec3) -> [i16; 2] {
    match normal.try_normalize() {
        Some(unit) => grid.place(coarser_normal(quantise_normal(unit), u32::from(bits))),
        None => MISSING,
    }
}

/// Computes the mean of codes, where 0 is none; for labels, the median.
fn single_mean(codes: &mut [u16], is_label: bool) -> [u16; 1] {
    codes.sort_unstable();
    let none = codes.partition_point(|&code| code == 0);
    let codes = &codes[none..];
    match codes.len() {
        0 => [0],
        count if is_label => [codes[(count - 1) / 2]],
        count => [mean(codes.iter().map(|&code| u32::from(code)).sum(), count as u32)],
    }
}

impl<'a> PointValues<'a> {
    pub(super) fn new(schema: &'a Schema, grid: &Grid, cloud: &'a RawCloud) -> Self {
        Self {
            schema,
            cloud,
            edge: grid.cell,
            grid: *grid,
        }
    }

    /// The single numbers of a point.
    fn single(&self, single: usize, point: usize) -> u16 {
        let attributes = &self.cloud.attributes;
        let scalar = |place: usize| {
            let schema = &self.schema.scalars[place];
            schema.code(attributes.scalars[place].values[point])
        };
        let first_scalar = self.schema.singles() - self.schema.scalars.len();
        if single >= first_scalar {
            return scalar(single - first_scalar);
        }
        match (single, self.schema.has_alpha, &attributes.colors, &attributes.radii) {
            (0, true, Some(colors), _) => u16::from(colors[point][3]),
            (_, _, _, Some(radii)) => radius_code(f64::from(radii[point]) / self.edge),
            _ => 0,
        }
    }

    /// The means of the points of each range, by their order.
    pub(super) fn leaves(&self, ranges: &[Range<usize>], order: &[u32]) -> Summaries {
        let attributes = &self.cloud.attributes;
        let mut summaries = Summaries {
            colors: Vec::new(),
            normals: Vec::new(),
            places: Vec::new(),
            singles: Vec::new(),
        };
        if let Some(colors) = &attributes.colors {
            let color = |range: &Range<usize>| {
                let mut sums = [0u32; 3];
                let points = match (self.schema.color_of_parents, self.schema.retained) {
                    // Merged points are drawn, so they have the mean.
                    (ParentValue::Mean, _) | (_, Retained::Merged) => range.clone(),
                    (ParentValue::FirstChild, _) => range.start..range.start + 1,
                };
                for &point in &order[points.clone()] {
                    let [red, green, blue, _] = colors[point as usize];
                    for (sum, channel) in sums.iter_mut().zip([green, red, blue]) {
                        *sum += u32::from(channel);
                    }
                }
                sums.map(|sum| mean(sum, points.len() as u32))
            };
            summaries.colors = ranges.iter().map(color).collect();
        }
        if let (Some(normals), bits @ 1..) = (&attributes.normals, self.schema.normal_bits) {
            let grid = NormalGrid::of(bits);
            let normal = |range: &Range<usize>| {
                let units = order[range.clone()].iter();
                let units = units.map(|&point| Vec3::from_array(normals[point as usize]).normalize_or_zero());
                let sum: Vec3 = units.clone().sum();
                if sum.length_squared() > 1e-6 {
                    sum.normalize()
                } else {
                    units.into_iter().find(|unit| *unit != Vec3::ZERO).unwrap_or(Vec3::ZERO)
                }
            };
            summaries.normals = ranges.iter().map(normal).collect();
            summaries.places = summaries
                .normals
                .iter()
                .map(|&normal| place(grid, bits, normal))
                .collect();
        }
        for single in 0..self.schema.singles() {
            let is_label = self.is_label(single);
            let is_radius = self.schema.stream_of_single(single) == StreamKind::Radius;
            let mut codes = Vec::new();
            let of_ranges = ranges.iter().map(|range| {
                codes.clear();
                codes.extend(
                    order[range.clone()]
                        .iter()
                        .map(|&point| self.single(single, point as usize)),
                );
                if is_radius && (range.len() > 1 || self.schema.retained == Retained::Merged) {
                    return [self.covering_radius(&order[range.clone()])];
                }
                single_mean(&mut codes, is_label)
            });
            summaries.singles.push(of_ranges.collect());
        }
        summaries
    }

    /// The code of the largest radius among the points of each range.
    pub(super) fn largest_radii(&self, ranges: &[Range<usize>], order: &[u32]) -> Vec<u16> {
        let Some(radii) = &self.cloud.attributes.radii else {
            return Vec::new();
        };
        let largest = |range: &Range<usize>| {
            let points = order[range.clone()].iter();
            radius_code(
                points
                    .map(|&point| f64::from(radii[point as usize]))
                    .fold(0.0, f64::max)
                    / self.edge,
            )
        };
        ranges.iter().map(largest).collect()
    }

    fn is_label(&self, single: usize) -> bool {
        let first_scalar = self.schema.singles() - self.schema.scalars.len();
        single >= first_scalar && self.schema.scalars[single - first_scalar].is_label
    }

    /// Computes the code of the radius that covers, from the centre of a cell, all disks of its points: these are drawn
    /// there, or offset along the normal. Disks of single points would leave gaps, as they move apart.
    fn covering_radius(&self, points: &[u32]) -> u16 {
        let Some(radii) = &self.cloud.attributes.radii else {
            return 0;
        };
        let cell = |position: DVec3| [0, 1, 2].map(|axis| self.grid.index(axis, position[axis]) as u32);
        let reach = |&point: &u32| {
            let point = point as usize;
            let radius = f64::from(radii[point]);
            if radius <= 0.0 {
                return 0.0;
            }
            let position = self.cloud.positions.get(point);
            let away = position - self.grid.center(self.grid.depth, cell(position));
            let normals = self.cloud.attributes.normals.as_ref();
            let normal = normals.and_then(|normals| Vec3::from_array(normals[point]).as_dvec3().try_normalize());
            away.reject_from_normalized(normal.unwrap_or(DVec3::ZERO)).length() + radius
        };
        radius_code(points.iter().map(reach).fold(0.0, f64::max) / self.edge)
    }
}

impl Summaries {
    /// Unit normals, not rounded; none if there are none.
    pub(super) fn directions(&self) -> &[Vec3] {
        &self.normals
    }

    /// Replaces the codes of a single number.
    pub(super) fn set_single(&mut self, single: usize, codes: Vec<[u16; 1]>) {
        self.singles[single] = codes;
    }

    /// The values of the nodes above.
    pub(super) fn above(&self, schema: &Schema, masks: &[u8]) -> Self {
        let ranges = children(masks);
        let color = |range: &Range<usize>| {
            if schema.color_of_parents == ParentValue::FirstChild {
                return self.colors[range.start];
            }
            let sum = |channel: usize| {
                self.colors[range.clone()]
                    .iter()
                    .map(|color| u32::from(color[channel]))
                    .sum()
            };
            [0, 1, 2].map(|channel| mean(sum(channel), range.len() as u32))
        };
        let normal = |range: &Range<usize>| {
            let normals = &self.normals[range.clone()];
            // Not normalised again: an only child has exactly the normal of its parent.
            if let &[only] = normals {
                return only;
            }
            let sum: Vec3 = normals.iter().sum();
            if sum.length_squared() > 1e-6 {
                sum.normalize()
            } else {
                normals[0]
            }
        };
        let normals: Vec<Vec3> = if self.normals.is_empty() {
            Vec::new()
        } else {
            ranges.iter().map(normal).collect()
        };
        let bits = schema.normal_bits;
        let places = normals
            .iter()
            .map(|&normal| place(NormalGrid::of(bits), bits, normal))
            .collect();
        let first_scalar = schema.singles() - schema.scalars.len();
        let single = |(single, codes): (usize, &Vec<[u16; 1]>)| {
            let is_label = single >= first_scalar && schema.scalars[single - first_scalar].is_label;
            let of_range = |range: &Range<usize>| {
                let mut codes: Vec<u16> = codes[range.clone()].iter().map(|code| code[0]).collect();
                single_mean(&mut codes, is_label)
            };
            ranges.iter().map(of_range).collect()
        };
        Self {
            colors: if self.colors.is_empty() {
                Vec::new()
            } else {
                ranges.iter().map(color).collect()
            },
            normals,
            places,
            singles: self.singles.iter().enumerate().map(single).collect(),
        }
    }
}

/// Computes the offsets of leaves: from the centre to the mean of the points, along the normal.
pub(super) fn offsets(
    schema: &Schema,
    grid: &Grid,
    cloud: &RawCloud,
    order: &[u32],
    ranges: &[Range<usize>],
    leaves: &[u64],
    summaries: &Summaries,
) -> Vec<u8> {
    let normals = NormalGrid::of(schema.normal_bits);
    let offset = |((range, &leaf), &place): ((&Range<usize>, &u64), &[i16; 2])| {
        if place == MISSING {
            return offset_of(0.0, schema.offset_bits);
        }
        let points = order[range.clone()].iter();
        let sum: DVec3 = points.map(|&point| cloud.positions.get(point as usize)).sum();
        let from_center = sum / range.len() as f64 - grid.center(grid.depth, morton::decode(leaf));
        offset_of(
            from_center.dot(normals.unit(place).as_dvec3()) / grid.cell,
            schema.offset_bits,
        )
    };
    ranges.iter().zip(leaves).zip(&summaries.places).map(offset).collect()
}
