//! Cells as cubes: the three faces of each that can face the eye.

use super::blocks::Placed;
use super::facet::{Facet, Outline, Patch};
use super::raster;
use super::shading::{Light, Shading, unit_color};
use super::tile::Tile;
use super::view::{PixelRect, PixelView};
use crate::cloud::VoxelRecord;
use crate::scene::{Lighting, Voxels};
use fearless_simd::Simd;
use glam::Vec3;
use std::ops::Range;

/// Cells of a packet, and how they are drawn.
pub(super) struct Cubes<'a> {
    records: &'a [VoxelRecord],
    cube_edge: f32,
    lighting: Lighting,
}

impl Placed for Cubes<'_> {
    fn len(&self) -> usize {
        self.records.len()
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.records[record].center
    }

    fn reach(&self, record: usize) -> f32 {
        // The corner of the cube.
        3f32.sqrt() * self.half_edge(record)
    }
}

impl<'a> Cubes<'a> {
    pub(super) fn new(voxels: &'a Voxels, lighting: Lighting) -> Self {
        Self {
            records: &voxels.records,
            cube_edge: voxels.cube_edge,
            lighting,
        }
    }

    fn half_edge(&self, record: usize) -> f32 {
        0.5 * self.cube_edge / (1u32 << self.records[record].level) as f32
    }

    /// Draws those of some records that touch a tile.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>>,
    ) {
        for record in records.flatten() {
            let VoxelRecord { center, color, .. } = self.records[record];
            let center = view.offset_from_eye(center);
            if !view.may_touch(clip, view.rotate(center), self.reach(record)) {
                continue;
            }
            let half_edge = self.half_edge(record);
            for axis in 0..3 {
                // The face towards the eye. For an eye between the two planes it is turned away and culled.
                let towards = if center[axis] < 0.0 { 1.0 } else { -1.0 };
                let mut edges = [Vec3::ZERO; 3];
                edges[0][axis] = towards * half_edge;
                // Ordered so that their cross product points outwards.
                edges[1][(axis + 1) % 3] = towards * half_edge;
                edges[2][(axis + 2) % 3] = half_edge;
                let middle = view.rotate(center + edges[0]);
                let [normal, u, v] = edges.map(|edge| view.rotate(edge));
                let patch = Patch {
                    center: middle,
                    u,
                    v,
                };
                if let Some(facet) = Facet::new(view, clip, patch, Outline::Parallelogram, true) {
                    let normal = normal.normalize_or_zero();
                    let light = Light::new(self.lighting, normal, middle, u, v);
                    let color = unit_color(color);
                    raster::solid(simd, view, tile, &facet, &Shading { color, light });
                }
            }
        }
    }
}
