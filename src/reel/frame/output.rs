//! Levels of whole numbers as a cloud.

use super::drawn::DrawnNodes;
use super::grid::Grid;
use super::levels::{LevelValues, Pose};
use super::schema::{Retained, Schema, StreamKind, Values};
use super::summaries::radius_edges;
use crate::cloud::{Ellipse, Positions, RawCloud, ScalarField};
use crate::math::morton;
use crate::reel::attributes::{MISSING, NormalGrid, offset_edges};
use glam::{DVec3, Vec3};

/// A disk of this part of a cell's edge covers the cell whatever its normal.
const CLOSING: f64 = 0.87;

/// The cloud of a pose: of its points if they are there, or else of the nodes of its last level. Scalars have the
/// offsets given.
pub(in crate::reel) fn cloud_of(schema: &Schema, grid: &Grid, mut pose: Pose, offsets: &[f64]) -> RawCloud {
    match (&pose.points, pose.flat.take(), pose.levels.last()) {
        (Some(_), ..) => cloud_of_points(schema, grid, &pose, offsets),
        (None, Some(flat), Some(last)) => {
            let level = pose.levels.len() as u32 - 1;
            let mut cloud = RawCloud::from_positions(Positions::F32(Vec::new()));
            fill_singles(schema, grid, &flat.singles, &mut cloud, offsets);
            let nodes = DrawnNodes {
                schema,
                grid,
                level,
                cells: &last.cells,
                offsets: &last.values.offsets,
            };
            nodes.fill(flat, &mut cloud);
            close(&mut cloud, closing_edge(schema, grid, level));
            cloud
        }
        _ => cloud_of_nodes(schema, grid, &pose, offsets),
    }
}

/// Edge of the cells that the disks of a level have to close, where points have none of their own. The cells of a whole
/// frame are as fine as its densest part: disks of their size would leave gaps in others.
fn closing_edge(schema: &Schema, grid: &Grid, level: u32) -> Option<f64> {
    let needs_closing = level < grid.depth || schema.retained != Retained::Merged;
    needs_closing.then_some(grid.edge(level))
}

/// Gives points disks that close cells.
fn close(cloud: &mut RawCloud, edge: Option<f64>) {
    if let Some(edge) = edge {
        cloud.attributes.radii = Some(vec![(CLOSING * edge) as f32; cloud.positions.len()]);
    }
}

/// Positions of points, and their attributes.
pub(super) struct Places<'a, I> {
    pub(super) values: &'a LevelValues,
    pub(super) at: I,
    /// Edge of the cells that disks have to close, where points have none of their own.
    pub(super) closing_edge: Option<f64>,
}

/// A cloud of points with attributes in steps.
pub(super) fn cloud_of_places(
    schema: &Schema,
    grid: &Grid,
    points: Places<'_, impl Iterator<Item = DVec3>>,
    offsets: &[f64],
) -> RawCloud {
    let mut cloud = RawCloud::from_positions(positions(schema, points.at));
    fill(schema, grid, points.values, &mut cloud, offsets);
    close(&mut cloud, points.closing_edge);
    cloud
}

fn cloud_of_nodes(schema: &Schema, grid: &Grid, pose: &Pose, offsets: &[f64]) -> RawCloud {
    let level = pose.levels.len().saturating_sub(1) as u32;
    let Some(of_level) = pose.levels.last() else {
        return RawCloud::from_positions(positions(schema, std::iter::empty()));
    };
    let values = &of_level.values;
    let edge = grid.edge(level);
    let lengths: [f64; 16] = std::array::from_fn(|code| offset_edges(code as u8, schema.offset_bits) * edge);
    let lifted = |node: usize| match (values.offsets.get(node), values.normals.get(node)) {
        (Some(&code), Some(&normal)) if normal != MISSING => {
            let normals = NormalGrid::of(schema.normal_bits);
            normals.unit(normal).as_dvec3() * lengths[usize::from(code) & 15]
        }
        _ => DVec3::ZERO,
    };
    let centers = of_level
        .cells
        .iter()
        .map(|&cell| grid.center(level, morton::decode(cell)));
    let places = Places {
        values,
        at: centers.enumerate().map(|(node, center)| center + lifted(node)),
        closing_edge: closing_edge(schema, grid, level),
    };
    cloud_of_places(schema, grid, places, offsets)
}

fn positions(schema: &Schema, places: impl Iterator<Item = DVec3>) -> Positions {
    if schema.is_double {
        Positions::F64(places.map(|place| place.to_array()).collect())
    } else {
        // The centre of a cell around the largest number may overflow.
        let narrowed = |place: DVec3| {
            place
                .as_vec3()
                .clamp(Vec3::splat(-f32::MAX), Vec3::splat(f32::MAX))
                .to_array()
        };
        Positions::F32(places.map(narrowed).collect())
    }
}

/// Attributes in steps.
fn fill(schema: &Schema, grid: &Grid, values: &LevelValues, cloud: &mut RawCloud, offsets: &[f64]) {
    let attributes = &mut cloud.attributes;
    if schema.color_step > 0 {
        let alpha = values.singles.first().filter(|_| schema.has_alpha);
        let color = |(point, &[green, red, blue]): (usize, &[u16; 3])| {
            let alpha = alpha.map_or(255, |alpha| alpha[point][0]);
            [red, green, blue, alpha].map(|channel| channel as u8)
        };
        attributes.colors = Some(values.colors.iter().enumerate().map(color).collect());
    }
    if schema.normal_bits > 0 {
        let normals = NormalGrid::of(schema.normal_bits);
        let unit = |&place: &[i16; 2]| {
            if place == MISSING {
                [0.0; 3]
            } else {
                normals.unit(place).to_array()
            }
        };
        attributes.normals = Some(values.normals.iter().map(unit).collect());
    }
    fill_singles(schema, grid, &values.singles, cloud, offsets);
}

/// Radii and scalars.
fn fill_singles(schema: &Schema, grid: &Grid, singles: &[Vec<[u16; 1]>], cloud: &mut RawCloud, offsets: &[f64]) {
    let attributes = &mut cloud.attributes;
    let first_scalar = schema.singles() - schema.scalars.len();
    for (single, codes) in singles.iter().enumerate() {
        match schema.stream_of_single(single) {
            StreamKind::Radius => {
                let radius = |code: &[u16; 1]| (radius_edges(code[0]) * grid.cell) as f32;
                attributes.radii = Some(codes.iter().map(radius).collect());
            }
            StreamKind::Scalar => {
                let scalar = single - first_scalar;
                let of_field = &schema.scalars[scalar];
                attributes.scalars.push(ScalarField {
                    name: crate::printable::name(of_field.name.clone()),
                    values: codes.iter().map(|code| of_field.value(code[0])).collect(),
                    offset: offsets.get(scalar).copied().unwrap_or(0.0),
                });
            }
            _ => {}
        }
    }
}

fn cloud_of_points(schema: &Schema, grid: &Grid, pose: &Pose, offsets: &[f64]) -> RawCloud {
    let (Some(points), Some(deepest)) = (&pose.points, pose.levels.last()) else {
        return RawCloud::from_positions(Positions::F32(Vec::new()));
    };
    let placed = points.cell_of_each(&deepest.cells).zip(&points.below);
    let bits = placed.map(|((cell, missing), below)| {
        let cell = morton::decode(cell).map(u64::from);
        [0, 1, 2].map(|axis| match schema.retained {
            Retained::Exact => {
                let (first, _) = schema.floats().ranks(grid, axis, cell[axis]);
                schema.floats().bits(axis, first.saturating_add(below[axis]))
            }
            Retained::Bits(bits) => {
                let edge = grid.cell / (1u64 << bits) as f64;
                let half = 0.5 * (1u64 << missing) as f64;
                let center = grid.min[axis] + ((cell[axis] << bits | below[axis]) as f64 + half) * edge;
                if schema.is_double {
                    center.to_bits()
                } else {
                    u64::from((center as f32).to_bits())
                }
            }
            Retained::Merged => 0,
        })
    });
    let bits = bits.chain(points.outside.iter().copied());
    let all = if schema.is_double {
        Positions::F64(bits.map(|bits| bits.map(f64::from_bits)).collect())
    } else {
        Positions::F32(bits.map(|bits| bits.map(|bits| f32::from_bits(bits as u32))).collect())
    };
    let mut cloud = RawCloud::from_positions(all);
    fill(schema, grid, &points.values, &mut cloud, offsets);
    fill_exactly(schema, &points.columns, &mut cloud);
    if schema.has_order {
        in_file_order(&points.order, &mut cloud);
    }
    cloud
}

/// Attributes as they are.
fn fill_exactly(schema: &Schema, columns: &[Vec<u32>], cloud: &mut RawCloud) {
    let attributes = &mut cloud.attributes;
    let mut columns = columns.iter();
    let floats = |column: &Vec<u32>| column.iter().map(|&bits| f32::from_bits(bits)).collect::<Vec<f32>>();
    if schema.has_exact_normals
        && let (Some(x), Some(y), Some(z)) = (columns.next(), columns.next(), columns.next())
    {
        let normals = x
            .iter()
            .zip(y)
            .zip(z)
            .map(|((&x, &y), &z)| [x, y, z].map(f32::from_bits));
        attributes.normals = Some(normals.collect());
    }
    if schema.radii == Values::Exact
        && let Some(column) = columns.next()
    {
        attributes.radii = Some(floats(column));
    }
    if schema.has_ellipses {
        let of_ellipses: Vec<Vec<f32>> = columns.by_ref().take(4).map(floats).collect();
        if let [x, y, z, ratio] = of_ellipses.as_slice() {
            let ellipse = |point: usize| Ellipse {
                axis: Vec3::new(x[point], y[point], z[point]),
                ratio: ratio[point],
            };
            attributes.ellipses = Some((0..ratio.len()).map(ellipse).collect());
        }
    }
    if schema.has_exact_scalars {
        for (field, column) in attributes.scalars.iter_mut().zip(columns) {
            field.values = floats(column);
        }
    }
}

/// Puts points where they were in the file. Places that damaged bytes repeat or put beyond the end are left alone.
pub(super) fn in_file_order(order: &[u32], cloud: &mut RawCloud) {
    let mut places = vec![u32::MAX; order.len()];
    for (point, &place) in (0u32..).zip(order) {
        if let Some(of_place) = places.get_mut(place as usize) {
            *of_place = point;
        }
    }
    if !places.contains(&u32::MAX) {
        cloud.keep(&places);
    }
}
