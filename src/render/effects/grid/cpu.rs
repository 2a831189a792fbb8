//! The grid on the ground on the CPU (`shaders/effects/grid.wgsl`): eight pixels of a row at a time.

use crate::render::constants::{COARSE_LINES, FINE_LINES, NARROWEST_CELL_PX, USUAL_LINES, WIDEST_CELL_PX};
use crate::render::cpu::eight::{Vectors, lane_numbers};
use crate::render::cpu::pixels::{pack, unpacked};
use crate::render::cpu::tile::LANES;
use crate::render::cpu::view::PixelView;
use crate::render::effects::effect::{PictureRow, RowStep};
use crate::scene::{ScenePacket, SeenGround};
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch, f32x8};
use glam::Vec3;

/// The plane, and the rays through pixels.
#[derive(Debug)]
struct Grid {
    ground: SeenGround,
    view: PixelView,
    /// Slope per pixel of the displayed image: lines are as wide as these pixels.
    slope_per_px: [f32; 2],
}

/// The settings of a packet.
pub(super) fn step(packet: &ScenePacket) -> Option<Box<dyn RowStep>> {
    let ground = packet.ground?.seen_by(&packet.view);
    Some(Box::new(Grid::new(ground, packet)))
}

impl RowStep for Grid {
    fn draw(&self, row: &mut PictureRow<'_>) {
        let [width, _] = row.size_px;
        let depths = &row.depths[width * row.y..width * (row.y + 1)];
        dispatch!(row.level, simd => {
            simd.vectorize(
                #[inline(always)]
                || self.draw_row(simd, row.y, depths, row.pixels),
            );
        });
    }
}

impl Grid {
    fn new(ground: SeenGround, packet: &ScenePacket) -> Self {
        let view = PixelView::new(packet);
        let samples = packet.style.drawing.antialiasing.samples_per_edge() as f32;
        Self {
            ground,
            slope_per_px: view.px_per_slope.map(|px| samples / px),
            view,
        }
    }

    /// Lays lines over a row of the image, where nothing is in front of them.
    #[inline(always)]
    fn draw_row<S: Simd>(&self, simd: S, y: usize, depths: &[f32], pixels: &mut [[u8; 4]]) {
        let [line_red, line_green, line_blue] = self.ground.color;
        let nothing = f32x8::splat(simd, 0.0);
        for (chunk, pixels) in pixels.chunks_mut(LANES).enumerate() {
            let x = LANES * chunk;
            let Some((opacity, depth)) = self.eight(simd, x, y) else {
                continue;
            };
            let mut there = [0.0; LANES];
            let count = LANES.min(depths.len() - x);
            there[..count].copy_from_slice(&depths[x..x + count]);
            let is_hidden = f32x8::from_slice(simd, &there).simd_gt(depth);
            let opacity = simd.select_f32x8(is_hidden, nothing, opacity);
            let ([red, green, blue], _) = unpacked(simd, pixels);
            let colors = [
                (line_red - red).mul_add(opacity, red),
                (line_green - green).mul_add(opacity, green),
                (line_blue - blue).mul_add(opacity, blue),
            ];
            pack(simd, colors, pixels);
        }
    }

    /// Computes the line coverage of eight pixels, and their reversed depths; `None` where no line is seen from any of
    /// them.
    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, x: usize, y: usize) -> Option<(f32x8<S>, f32x8<S>)> {
        let (ground, view) = (&self.ground, &self.view);
        let [across_px, down_px] = view.px_per_slope;
        let right = lane_numbers(simd) + (x as f32 + 0.5 - view.center_px[0]);
        let ray = Vectors {
            x: right * (1.0 / across_px),
            y: f32x8::splat(simd, (y as f32 + 0.5 - view.center_px[1]) / down_px),
            z: f32x8::splat(simd, -1.0),
        };
        let per_facing = 1.0 / Vectors::splat(simd, ground.normal).dot(ray);
        let distance = per_facing * ground.height;
        let [first, second] = [0, 1].map(|axis| Coordinate {
            axis: ground.axes[axis],
            of_point: ground.point_along_axes[axis],
        });
        let first = first.seen(simd, self, ray, [per_facing, distance]);
        let second = second.seen(simd, self, ray, [per_facing, distance]);
        let away = first[0].mul_add(first[0], second[0] * second[0]).sqrt();
        let fading = (2.0 - away * (2.0 / ground.reach)).max(0.0).min(1.0);
        // False if parallel to the plane, behind the eye or too near.
        let is_seen = distance.simd_gt(view.near) & per_facing.abs().simd_lt(1e6) & fading.simd_gt(0.0);
        if !simd.any_true_mask32x8(is_seen) {
            return None;
        }
        let [usual, coarse, fine] = [1.0, 10.0, 0.1].map(|factor| ground.spacing * factor);
        let opacity = lines(first, usual, USUAL_LINES)
            .max(lines(second, usual, USUAL_LINES))
            .max(lines(first, coarse, COARSE_LINES))
            .max(lines(second, coarse, COARSE_LINES))
            .max(lines(first, fine, FINE_LINES))
            .max(lines(second, fine, FINE_LINES));
        let nothing = f32x8::splat(simd, 0.0);
        let opacity = simd.select_f32x8(is_seen, opacity * fading, nothing);
        Some((opacity, view.near / distance))
    }
}

/// A coordinate on the plane.
#[derive(Clone, Copy)]
struct Coordinate {
    axis: Vec3,
    of_point: f32,
}

impl Coordinate {
    /// Computes the coordinate where eight rays meet the plane, and the number of pixels across the lines per unit of
    /// it: from the derivative of a quotient of two functions that are affine in pixels.
    #[inline(always)]
    fn seen<S: Simd>(
        self,
        simd: S,
        grid: &Grid,
        ray: Vectors<S>,
        [per_facing, distance]: [f32x8<S>; 2],
    ) -> [f32x8<S>; 2] {
        let normal = grid.ground.normal;
        let [across_slope, down_slope] = grid.slope_per_px;
        let along = Vectors::splat(simd, self.axis).dot(ray);
        let slope = along * per_facing;
        let to_right = (self.axis.x - slope * normal.x) * across_slope;
        let downwards = (self.axis.y - slope * normal.y) * down_slope;
        let per_px = distance * to_right.mul_add(to_right, downwards * downwards).sqrt();
        [distance * along - self.of_point, 1.0 / per_px.max(1e-30)]
    }
}

/// Computes the coverage of eight pixels by lines that cross a coordinate at multiples of a spacing, times an opacity.
#[inline(always)]
fn lines<S: Simd>([place, px_per_unit]: [f32x8<S>; 2], spacing: f32, opacity: f32) -> f32x8<S> {
    let cells = place * (1.0 / spacing);
    let cell_px = px_per_unit * spacing;
    let nearest = (cells + 0.5).floor();
    let covered = (1.0 - (cells - nearest).abs() * cell_px).max(0.0);
    let space = (cell_px - NARROWEST_CELL_PX) * (1.0 / (WIDEST_CELL_PX - NARROWEST_CELL_PX));
    covered * space.max(0.0).min(1.0) * opacity
}
