//! The shadow of the key light on the CPU (`shaders/effects/shadow.wgsl`): on eight pixels at a time. How:
//! `scene/light/shadow.rs`.

use crate::render::cpu::eight::Vectors;
use crate::render::cpu::tile::LANES;
use crate::scene::Shadow;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// The reversed depths that the key light sees.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct ShadowMap<'a> {
    pub(in crate::render) shadow: &'a Shadow,
    pub(in crate::render) depths: &'a [f32],
}

impl ShadowMap<'_> {
    /// Computes the fraction of the key light that reaches eight positions in view space, given the cosines `facing`
    /// between their normals and the directions to the lamp.
    #[inline(always)]
    pub(in crate::render) fn light_of_key<S: Simd>(
        &self,
        simd: S,
        position: Vectors<S>,
        normal: Vectors<S>,
        facing: f32x8<S>,
    ) -> f32x8<S> {
        let splat = |value: f32| f32x8::splat(simd, value);
        let Shadow {
            lamp_packet,
            lamp_from_view: [x, y, z],
            texel,
            ..
        } = self.shadow;
        let [always, sloping] = Shadow::OFFSET_TEXELS.map(|texels| texels * texel);
        let slope = (1.0 - facing * facing).max(splat(0.0)).sqrt();
        let place = position.plus(normal.times(slope.mul_add(splat(sloping), splat(always))));
        let along = |row: &glam::Vec4| Vectors::splat(simd, row.truncate()).dot(place) + row.w;
        let view = &lamp_packet.view;
        let per_distance = -1.0 / along(z);
        let [focal, _] = view.focal;
        let half_edge_px = 0.5 * Shadow::EDGE_PX as f32;
        let right_px = along(x) * per_distance * (focal * half_edge_px) + (half_edge_px - 1.5);
        let down_px = (half_edge_px - 1.5) - along(y) * per_distance * (focal * half_edge_px);
        let depth = per_distance * view.near;
        // The corner of a square of 3×3 texels.
        let (left, top) = (right_px.floor(), down_px.floor());
        let (beyond_left, beyond_top) = (right_px - left, down_px - top);
        let one = splat(1.0);
        let columns = [one - beyond_left, one, one, beyond_left];
        let mut lit = splat(0.0);
        for (row, of_row) in [one - beyond_top, one, one, beyond_top].into_iter().enumerate() {
            for (column, of_column) in columns.into_iter().enumerate() {
                let there = self.at(simd, left + column as f32, top + row as f32);
                let is_lit = there.simd_le(depth);
                lit += simd.select_f32x8(is_lit, of_row * of_column, splat(0.0));
            }
        }
        simd.select_f32x8(facing.simd_gt(splat(0.0)), lit * (1.0 / 9.0), one)
    }

    /// Depths of texels, clamped to the border of the shadow map.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, columns: f32x8<S>, rows: f32x8<S>) -> f32x8<S> {
        let last = f32x8::splat(simd, Shadow::EDGE_PX as f32 - 1.0);
        let nothing = f32x8::splat(simd, 0.0);
        let columns = simd.cvt_i32_f32x8(columns.max(nothing).min(last));
        let rows = simd.cvt_i32_f32x8(rows.max(nothing).min(last));
        let mut eight = [0.0; LANES];
        for (lane, depth) in eight.iter_mut().enumerate() {
            *depth = self.depths[Shadow::EDGE_PX as usize * rows[lane] as usize + columns[lane] as usize];
        }
        f32x8::from_slice(simd, &eight)
    }
}
