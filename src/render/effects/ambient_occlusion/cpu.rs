//! Ambient occlusion on the CPU (`shaders/effects/ambient_occlusion.wgsl`): of eight pixels of a row at a time. The
//! formula: `scene/effects/ambient_occlusion.rs`.
//!
//! Depths are drawn before all else: a tile is lit when it is drawn, and needs the depths of its neighbours.

use crate::render::cpu::eight::{Vectors, lane_numbers};
use crate::render::cpu::tile::LANES;
use crate::render::cpu::view::PixelView;
use crate::scene::AmbientOcclusion;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// The reversed depths of an image, and the parameters of their occlusion.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Occlusion<'a> {
    settings: AmbientOcclusion,
    lines: [[f32; 2]; AmbientOcclusion::LINES],
    size_px: [usize; 2],
    depths: &'a [f32],
}

impl<'a> Occlusion<'a> {
    pub(in crate::render) fn new(settings: AmbientOcclusion, size_px: [u32; 2], depths: &'a [f32]) -> Self {
        Self {
            settings,
            lines: AmbientOcclusion::lines(),
            size_px: size_px.map(|edge| edge as usize),
            depths,
        }
    }

    /// The share of the light from around that reaches eight pixels from `pixel` on to the right, with normals towards
    /// the eye whose products with the rays through the pixels are `facing`.
    #[inline(always)]
    pub(in crate::render) fn openness<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        [x, y]: [i32; 2],
        normal: Vectors<S>,
        facing: f32x8<S>,
    ) -> f32x8<S> {
        let splat = |value: f32| f32x8::splat(simd, value);
        let nothing = splat(0.0);
        let depth = self.eight_of_row(simd, [x as usize, y as usize]);
        let is_drawn = depth.simd_gt(nothing);
        if !simd.any_true_mask32x8(is_drawn) {
            return splat(1.0);
        }
        let AmbientOcclusion {
            near_radius_px,
            max_radius_px,
            px_per_slope,
            strength,
        } = self.settings;
        let radius_px = (depth * near_radius_px)
            .min(splat(max_radius_px))
            .max(splat(f32::MIN_POSITIVE));
        let per_radius = 1.0 / radius_px;
        let heights = per_radius * px_per_slope;
        let [right, down] = view.px_per_slope.map(|px| 1.0 / px);
        let (across, along) = (normal.x * right, normal.y * down);
        let column = lane_numbers(simd) + x as f32;
        let row = splat(y as f32);
        let [last_column, last_row] = self.size_px.map(|edge| splat(edge as f32 - 1.0));
        let mut filled = nothing;
        let mut space = nothing;
        for [to_right, downwards] in self.lines {
            let column_there = (column + radius_px.mul_add(splat(to_right), splat(0.5)).floor())
                .max(nothing)
                .min(last_column);
            let row_there = (row + radius_px.mul_add(splat(downwards), splat(0.5)).floor())
                .max(nothing)
                .min(last_row);
            let [aside_px, below_px] = [column_there - column, row_there - row];
            let [aside, below] = [aside_px * per_radius, below_px * per_radius];
            let top = (1.0 - aside.mul_add(aside, below * below)).max(nothing).sqrt();
            // Where the plane is not visible from the eye, it is far behind the ball.
            let facing_there = across
                .mul_add(aside_px, along.mul_add(below_px, facing))
                .min(splat(-1e-6));
            let bottom = (heights * (1.0 - facing / facing_there)).max(-top).min(top);
            let depth_there = self.at(simd, column_there, row_there).max(splat(1e-30));
            let height = heights.mul_sub(1.0 - depth / depth_there, splat(AmbientOcclusion::ROUGHNESS));
            let nearness = (2.0 + top - height).max(nothing).min(splat(1.0));
            filled = (height.max(bottom).min(top) - bottom).mul_add(nearness, filled);
            space += top - bottom;
        }
        let open = (1.0 - filled * strength / space.max(splat(1e-6))).max(nothing);
        simd.select_f32x8(is_drawn, open, splat(1.0))
    }

    /// Depths from a pixel on; none past the edge of the image.
    #[inline(always)]
    fn eight_of_row<S: Simd>(&self, simd: S, [x, y]: [usize; 2]) -> f32x8<S> {
        let [width, _] = self.size_px;
        let row = &self.depths[width * y..width * (y + 1)];
        let mut eight = [0.0; LANES];
        let there = &row[x..row.len().min(x + LANES)];
        eight[..there.len()].copy_from_slice(there);
        f32x8::from_slice(simd, &eight)
    }

    /// Depths of pixels of the image.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, columns: f32x8<S>, rows: f32x8<S>) -> f32x8<S> {
        let [columns, rows] = [simd.cvt_i32_f32x8(columns), simd.cvt_i32_f32x8(rows)];
        let mut eight = [0.0; LANES];
        for (lane, depth) in eight.iter_mut().enumerate() {
            *depth = self.depths[self.size_px[0] * rows[lane] as usize + columns[lane] as usize];
        }
        f32x8::from_slice(simd, &eight)
    }
}
