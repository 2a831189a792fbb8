//! The nodes of a level as the fast coding has them, as a cloud: positions and unit vectors are worked out, colours
//! handed over.

use super::flat::cell_of;
use super::grid::Grid;
use super::levels::FlatValues;
use super::schema::Schema;
use crate::cloud::{Positions, RawCloud};
use crate::math::morton;
use crate::reel::attributes::{NormalGrid, offset_edges};
use fearless_simd::{Level, dispatch};
use glam::{DVec3, Vec3};

/// Nodes of a level.
pub(super) struct DrawnNodes<'a> {
    pub(super) schema: &'a Schema,
    pub(super) grid: &'a Grid,
    pub(super) level: u32,
    pub(super) cells: &'a [u64],
    /// Codes of offsets, if there are any.
    pub(super) offsets: &'a [u8],
}

impl DrawnNodes<'_> {
    /// Puts positions, colours and normals into a cloud.
    pub(super) fn fill(&self, flat: FlatValues, cloud: &mut RawCloud) {
        if self.schema.color_step > 0 {
            let mut colors = flat.colors;
            if let (true, Some(alpha)) = (self.schema.has_alpha, flat.singles.first()) {
                for (color, &[alpha]) in colors.iter_mut().zip(alpha) {
                    color[3] = alpha as u8;
                }
            }
            cloud.attributes.colors = Some(colors);
        }
        let normals = (self.schema.normal_bits > 0).then(|| self.normals(&flat.normals));
        cloud.positions = if self.schema.is_double {
            Positions::F64(self.positions(normals.as_deref(), DVec3::to_array))
        } else {
            // The centre of a cell around the largest number may overflow.
            let largest = Vec3::splat(f32::MAX);
            Positions::F32(self.positions(normals.as_deref(), |place| {
                place.as_vec3().clamp(-largest, largest).to_array()
            }))
        };
        cloud.attributes.normals = normals;
    }

    /// Unit normals.
    fn normals(&self, normals: &[u32]) -> Vec<[f32; 3]> {
        let bits = self.schema.normal_bits;
        let units = NormalGrid::of(bits).units();
        let unit = |&normal: &u32| {
            cell_of(bits, normal)
                .and_then(|cell| units.get(cell))
                .map_or([0.0; 3], Vec3::to_array)
        };
        normals.iter().map(unit).collect()
    }

    /// Computes the centres of cells, moved along normals.
    fn positions<T>(&self, normals: Option<&[[f32; 3]]>, narrowed: impl Fn(&DVec3) -> T) -> Vec<T> {
        let edge = self.grid.edge(self.level);
        let lengths: [f64; 16] = std::array::from_fn(|code| offset_edges(code as u8, self.schema.offset_bits) * edge);
        let center = |&cell: &u64| self.grid.center(self.level, morton::decode(cell));
        match normals {
            Some(normals) if !self.offsets.is_empty() => dispatch!(Level::new(), _simd => {
                let nodes = self.cells.iter().zip(normals).zip(self.offsets);
                nodes.map(|((cell, &normal), &code)| {
                    let lifted = Vec3::from_array(normal).as_dvec3() * lengths[usize::from(code) & 15];
                    narrowed(&(center(cell) + lifted))
                }).collect()
            }),
            _ => dispatch!(Level::new(), _simd => self.cells.iter().map(|cell| narrowed(&center(cell))).collect()),
        }
    }
}
