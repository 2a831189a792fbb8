//! Patches to pixels: eight pixels of a row at a time, as CPU registers hold them.
//!
//! Each function does the work of one pass of `shaders/passes` on a fragment.

use super::eight::lane_numbers;
use super::facet::{Facet, Outline};
use super::shading::{Light, Shading, SurfaceNormal};
use super::tile::{LANES, PIXELS, Tile, WIDTH};
use super::view::{Affine, PixelRect, PixelView};
use crate::render::constants::MASK_FALLOFF;
use crate::scene::{Kernel, SplatFilter};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use glam::Vec3;

/// Eight pixels of a patch.
pub(super) struct Fragments<S: Simd> {
    pub(super) p: f32x8<S>,
    pub(super) q: f32x8<S>,
    pub(super) w: f32x8<S>,
}

/// Calls `visit` with the place in the tile of every eight pixels that a patch may cover.
///
/// Closures that take registers say that they are to be inlined: the functions of this file are used by disks and by
/// byte codes, and a function used twice is otherwise compiled separately, for the baseline CPU.
#[inline(always)]
// When it was not inlined, the closure was compiled for the baseline instruction set as soon as byte codes used this
// function as well: surfels took 492 ms until it was marked for inlining.
fn for_each<S: Simd>(simd: S, tile_rect: PixelRect, facet: &Facet, mut visit: impl FnMut(usize, &Fragments<S>)) {
    let rect = facet.bounds.intersection(tile_rect);
    let [tile_x, tile_y] = tile_rect.start;
    let first_x = rect.start[0] - (rect.start[0] - tile_x) % LANES as i32;
    let lanes = lane_numbers(simd);
    let splat = |value| f32x8::splat(simd, value);
    let row_of = |function: &Affine, y| {
        let first = splat(function.at_px(first_x, y));
        lanes.mul_add(splat(function.per_px[0]), first)
    };
    let step = |function: &Affine| splat(function.per_px[0] * LANES as f32);
    let (step_p, step_q, step_w) = (step(&facet.p), step(&facet.q), step(&facet.w));
    for y in rect.start[1]..rect.end[1] {
        let row = (y - tile_y) as usize * WIDTH;
        let mut fragments = Fragments {
            p: row_of(&facet.p, y),
            q: row_of(&facet.q, y),
            w: row_of(&facet.w, y),
        };
        for x in (first_x..rect.end[0]).step_by(LANES) {
            visit(row + (x - tile_x) as usize, &fragments);
            fragments.p += step_p;
            fragments.q += step_q;
            fragments.w += step_w;
        }
    }
}

impl<S: Simd> Fragments<S> {
    /// Computes the coverage mask of the fragments that lie inside the outline or, where depths are negative, inside
    /// its mirror image behind the eye.
    #[inline(always)]
    fn are_inside(&self, outline: Outline) -> mask32x8<S> {
        match outline {
            Outline::Disk => {
                let across = self.p.mul_add(self.p, self.q * self.q);
                across.simd_le(self.w * self.w)
            }
            Outline::Parallelogram => self.p.abs().max(self.q.abs()).simd_le(self.w),
        }
    }

    /// Returns the weighted sum of the pixel functions, each multiplied by its factor.
    #[inline(always)]
    fn sum(&self, simd: S, [p, q, w]: [f32; 3]) -> f32x8<S> {
        let splat = |factor| f32x8::splat(simd, factor);
        let of_two = self.q.mul_add(splat(q), self.w * splat(w));
        self.p.mul_add(splat(p), of_two)
    }

    /// Reversed depths.
    #[inline(always)]
    fn depths(&self, simd: S, depth_per_w: f32) -> f32x8<S> {
        self.w * f32x8::splat(simd, depth_per_w)
    }
}

/// Fragments are in front of the eye by at least the distance to the near plane.
#[inline(always)]
fn are_beyond_near<S: Simd>(simd: S, depths: f32x8<S>) -> mask32x8<S> {
    depths.simd_le(f32x8::splat(simd, 1.0))
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, values: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &values[at..at + LANES])
}

#[inline(always)]
pub(super) fn store<S: Simd>(register: f32x8<S>, values: &mut [f32], at: usize) {
    values[at..at + LANES].copy_from_slice(register.as_slice());
}

/// The depth of the nearest surface, pushed back: depths are multiplied with `push_back`.
#[inline(always)]
pub(super) fn visibility<S: Simd>(simd: S, tile: &mut Tile, facet: &Facet, push_back: f32, outline: Outline) {
    let depth_per_w = facet.depth_per_w * push_back;
    let nothing = f32x8::splat(simd, 0.0);
    for_each(
        simd,
        tile.rect(),
        facet,
        #[inline(always)]
        |at, fragments| {
            let depths = fragments.depths(simd, depth_per_w);
            // Depths behind the eye are negative, and less than the stored ones.
            let drawn = fragments.are_inside(outline) & are_beyond_near(simd, depths);
            let nearest = load(simd, &tile.depth, at).max(simd.select_f32x8(drawn, depths, nothing));
            store(nearest, &mut tile.depth, at);
        },
    );
}

/// Sums weighted colours of fragments that are not behind the existing depths.
#[inline(always)]
pub(super) fn attribute<S: Simd>(simd: S, tile: &mut Tile, facet: &Facet, shading: &Shading, kernel: Kernel) {
    let nothing = f32x8::splat(simd, 0.0);
    for_each(
        simd,
        tile.rect(),
        facet,
        #[inline(always)]
        |at, fragments| {
            let depths = fragments.depths(simd, facet.depth_per_w);
            let drawn = fragments.are_inside(Outline::Disk)
                & are_beyond_near(simd, depths)
                & depths.simd_ge(load(simd, &tile.depth, at));
            if !simd.any_true_mask32x8(drawn) {
                return;
            }
            let mask = mask_weight(simd, fragments, kernel) * shading.weight;
            let weight = simd.select_f32x8(drawn, mask, nothing);
            add(simd, tile, at, facet, shading, fragments, [depths, weight]);
        },
    );
}

/// Draws attributes of splats that are at least as large as [`SplatFilter::Clamp`](crate::scene::SplatFilter) requires:
/// a mask is the disk's, or the one of the circle around its centre where that is stronger.
#[inline(always)]
pub(super) fn attribute_clamped<S: Simd>(simd: S, tile: &mut Tile, facet: &Facet, shading: &Shading, center: &Center) {
    let splat = |value: f32| f32x8::splat(simd, value);
    let (nothing, neighbor) = (splat(0.0), splat(2.0));
    let [left, top] = tile.origin;
    let per_radius = 1.0 / SplatFilter::CLAMP_RADIUS_PX;
    let lanes = lane_numbers(simd) * per_radius;
    let is_in_front = center.depth > 0.0;
    for_each(
        simd,
        tile.rect(),
        facet,
        #[inline(always)]
        |at, fragments| {
            let on_plane = fragments.depths(simd, facet.depth_per_w);
            let across = fragments.p.mul_add(fragments.p, fragments.q * fragments.q) / (fragments.w * fragments.w);
            let is_on_plane = fragments.w.simd_gt(nothing) & are_beyond_near(simd, on_plane);
            let of_disk = simd.select_f32x8(is_on_plane, across, neighbor);
            let center_of = |px: i32, axis: usize| (px as f32 + 0.5 - center.place_px[axis]) * per_radius;
            let right = lanes + splat(center_of(left + (at % WIDTH) as i32, 0));
            let down = splat(center_of(top + (at / WIDTH) as i32, 1));
            let of_circle = right.mul_add(right, down * down);
            let of_circle = if is_in_front { of_circle } else { neighbor };
            let is_circle = of_circle.simd_lt(of_disk);
            let depths = simd.select_f32x8(is_circle, splat(center.depth), on_plane);
            let radius2 = of_circle.min(of_disk);
            let drawn = radius2.simd_le(splat(1.0)) & depths.simd_ge(load(simd, &tile.depth, at));
            if !simd.any_true_mask32x8(drawn) {
                return;
            }
            let weight = simd.select_f32x8(drawn, gaussian(simd, radius2.min(splat(1.0))), nothing);
            add(simd, tile, at, facet, shading, fragments, [depths, weight]);
        },
    );
}

/// Screen position of the centre of a splat.
#[derive(Debug, Clone, Copy)]
pub(super) struct Center {
    pub(super) place_px: [f32; 2],
    /// Reversed; 0 where it is not in front of the eye.
    pub(super) depth: f32,
}

/// Adds the contributions of eight fragments, times a weight each.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    tile: &mut Tile,
    at: usize,
    facet: &Facet,
    shading: &Shading,
    fragments: &Fragments<S>,
    [depths, weight]: [f32x8<S>; 2],
) {
    let colors = shading.colors(simd, &tile.per_ray_length, at, facet, fragments);
    for (channel, sums) in tile.colors.iter_mut().enumerate() {
        store(colors[channel].mul_add(weight, load(simd, sums, at)), sums, at);
    }
    store(load(simd, &tile.weight, at) + weight, &mut tile.weight, at);
    if let Some(normal) = shading.normal {
        for (value, sums) in surface(simd, normal, fragments, depths)
            .into_iter()
            .zip(&mut tile.surfaces)
        {
            store(value.mul_add(weight, load(simd, sums, at)), sums, at);
        }
    }
}

/// Lays a splat over the existing pixels, with its mask as opacity. The outline `with_depth`, if any, occludes: for a
/// parallelogram including the corners.
#[inline(always)]
pub(super) fn over<S: Simd>(
    simd: S,
    tile: &mut Tile,
    facet: &Facet,
    shading: &Shading,
    kernel: Kernel,
    with_depth: Option<Outline>,
) {
    let nothing = f32x8::splat(simd, 0.0);
    for_each(
        simd,
        tile.rect(),
        facet,
        #[inline(always)]
        |at, fragments| {
            let depths = fragments.depths(simd, facet.depth_per_w);
            let mut drawn = fragments.are_inside(Outline::Parallelogram) & are_beyond_near(simd, depths);
            if let Some(outline) = with_depth {
                drawn &= fragments.are_inside(outline);
                let before = load(simd, &tile.depth, at);
                drawn &= depths.simd_ge(before);
                store(simd.select_f32x8(drawn, depths, before), &mut tile.depth, at);
            }
            drawn &= fragments.are_inside(Outline::Disk);
            if !simd.any_true_mask32x8(drawn) {
                return;
            }
            let opacity = simd.select_f32x8(drawn, mask_weight(simd, fragments, kernel), nothing);
            let colors = shading.colors(simd, &tile.per_ray_length, at, facet, fragments);
            for (channel, below) in tile.colors.iter_mut().enumerate() {
                let there = load(simd, below, at);
                // Blended in f32: not rounded to bytes in between.
                store((colors[channel] - there).mul_add(opacity, there), below, at);
            }
            if let Some(normal) = shading.normal {
                let surface = surface(simd, normal, fragments, depths)
                    .into_iter()
                    .zip(&mut tile.surfaces);
                for (value, below) in surface.chain([(f32x8::splat(simd, 1.0), &mut tile.weight)]) {
                    let there = load(simd, below, at);
                    store((value - there).mul_add(opacity, there), below, at);
                }
            }
        },
    );
}

/// Draws the nearest surface, opaque.
#[inline(always)]
pub(super) fn solid<S: Simd>(simd: S, tile: &mut Tile, facet: &Facet, shading: &Shading, outline: Outline) {
    for_each(
        simd,
        tile.rect(),
        facet,
        #[inline(always)]
        |at, fragments| {
            let depths = fragments.depths(simd, facet.depth_per_w);
            let before = load(simd, &tile.depth, at);
            let drawn = fragments.are_inside(outline) & are_beyond_near(simd, depths) & depths.simd_ge(before);
            if !simd.any_true_mask32x8(drawn) {
                return;
            }
            store(simd.select_f32x8(drawn, depths, before), &mut tile.depth, at);
            let colors = shading.colors(simd, &tile.per_ray_length, at, facet, fragments);
            for (channel, below) in tile.colors.iter_mut().enumerate() {
                let there = load(simd, below, at);
                store(simd.select_f32x8(drawn, colors[channel], there), below, at);
            }
            if let Some(normal) = shading.normal {
                let surface = surface(simd, normal, fragments, depths)
                    .into_iter()
                    .zip(&mut tile.surfaces);
                for (value, below) in surface.chain([(f32x8::splat(simd, 1.0), &mut tile.weight)]) {
                    let there = load(simd, below, at);
                    store(simd.select_f32x8(drawn, value, there), below, at);
                }
            }
        },
    );
}

/// Computes the surface attributes that eight fragments leave for deferred shading in addition to their colours, in the
/// layout of [`Tile::surfaces`].
#[inline(always)]
fn surface<S: Simd>(simd: S, normal: SurfaceNormal, fragments: &Fragments<S>, depths: f32x8<S>) -> [f32x8<S>; 4] {
    let splat = |value: f32| f32x8::splat(simd, value);
    match normal {
        SurfaceNormal::Same(Vec3 { x, y, z }) => [splat(x), splat(y), splat(z), depths],
        SurfaceNormal::OfSideSeen { normal, along_rays } => {
            let side = splat(1.0).copysign(-fragments.sum(simd, along_rays));
            [side * normal.x, side * normal.y, side * normal.z, depths]
        }
    }
}

/// The mask of a kernel inside the disk (`shaders/common/varyings.wgsl`).
#[inline(always)]
fn mask_weight<S: Simd>(simd: S, fragments: &Fragments<S>, kernel: Kernel) -> f32x8<S> {
    let across = fragments.p.mul_add(fragments.p, fragments.q * fragments.q);
    match kernel {
        Kernel::Gaussian => gaussian(simd, across / (fragments.w * fragments.w)),
        Kernel::Hat => 1.0 - across.sqrt() / fragments.w,
        Kernel::Flat => f32x8::splat(simd, 1.0),
    }
}

/// The circular Gaussian mask of the 4D media paper §V, `exp(−MASK_FALLOFF·r²)`, of squares up to 1. Relative error
/// below 4·10⁻⁵.
#[inline(always)]
pub(super) fn gaussian<S: Simd>(simd: S, radius2: f32x8<S>) -> f32x8<S> {
    let splat = |value| f32x8::splat(simd, value);
    // The eighth root brings the argument into the range of a short series.
    let y = radius2 * splat(-MASK_FALLOFF / 8.0);
    let series = y.mul_add(splat(1.0 / 120.0), splat(1.0 / 24.0));
    let series = y.mul_add(series, splat(1.0 / 6.0));
    let series = y.mul_add(series, splat(0.5));
    let series = y.mul_add(series, splat(1.0));
    let root = y.mul_add(series, splat(1.0));
    let squared = root * root;
    let fourth_power = squared * squared;
    fourth_power * fourth_power
}

/// For every pixel of a tile, 1 over the length of the ray through it that has z = −1: light needs it for every
/// fragment, and a root and a division take as long as all else.
#[inline(always)]
pub(super) fn measure_rays<S: Simd>(simd: S, view: &PixelView, tile: &mut Tile) {
    tile.per_ray_length.resize(PIXELS, 0.0);
    let to_right = |x: f32x8<S>| (x - view.center_px[0]) * (1.0 / view.px_per_slope[0]);
    let [left, top] = tile.origin.map(|edge| edge as f32 + 0.5);
    for (row, lengths) in tile.per_ray_length.chunks_exact_mut(WIDTH).enumerate() {
        let down = (top + row as f32 - view.center_px[1]) / view.px_per_slope[1];
        for column in (0..WIDTH).step_by(LANES) {
            let right = to_right(lane_numbers(simd) + (left + column as f32));
            let length2 = right.mul_add(right, f32x8::splat(simd, down * down + 1.0));
            store(1.0 / length2.sqrt(), lengths, column);
        }
    }
}

impl Shading {
    /// The lit colours of eight pixels (`shaders/common/light.wgsl`).
    #[inline(always)]
    fn colors<S: Simd>(
        &self,
        simd: S,
        per_ray_length: &[f32],
        at: usize,
        facet: &Facet,
        fragments: &Fragments<S>,
    ) -> [f32x8<S>; 3] {
        let splat = |value| f32x8::splat(simd, value);
        // No `map` over arrays of registers: the standard library is not compiled for them, and passes them through
        // memory. Spilled in this way, surfels took 309 ms on one thread instead of 153 ms.
        let [factor, white] = match &self.light {
            Light::Same([factor, white]) => [splat(*factor), splat(*white)],
            Light::OfCorners([factors, whites]) => [
                between_corners(simd, *factors, fragments),
                between_corners(simd, *whites, fragments),
            ],
            Light::OfPixels => {
                let per_length = load(simd, per_ray_length, at) * (1.0 / facet.normal_length);
                // Negative behind the eye, where splats extend beyond their disks.
                let facing = (fragments.w * per_length).abs();
                headlight_of(simd, facing)
            }
            Light::OfPixelsOn(along_rays) => {
                let facing = fragments.sum(simd, *along_rays).abs() * load(simd, per_ray_length, at);
                headlight_of(simd, facing)
            }
        };
        let [red, green, blue] = self.color;
        let lit = |channel| splat(channel).mul_add(factor, white).min(splat(1.0));
        [lit(red), lit(green), lit(blue)]
    }
}

/// As [`super::shading::headlight`].
#[inline(always)]
pub(super) fn headlight_of<S: Simd>(simd: S, facing: f32x8<S>) -> [f32x8<S>; 2] {
    use super::shading::{AMBIENT, SPECULAR};
    let splat = |value| f32x8::splat(simd, value);
    let facing2 = facing * facing;
    let facing4 = facing2 * facing2;
    let facing8 = facing4 * facing4;
    [
        facing.mul_add(splat(1.0 - AMBIENT), splat(AMBIENT)),
        splat(SPECULAR) * facing8 * facing8 * facing8,
    ]
}

/// Interpolates between the values at the corners of a quad that is drawn as two triangles, split from its second
/// corner to its third.
#[inline(always)]
fn between_corners<S: Simd>(simd: S, [a, b, c, d]: [f32; 4], fragments: &Fragments<S>) -> f32x8<S> {
    let splat = |value| f32x8::splat(simd, value);
    let (p, q) = (fragments.p / fragments.w, fragments.q / fragments.w);
    // An affine function of p and q on each triangle.
    let lower = p.mul_add(
        splat(0.5 * (b - a)),
        q.mul_add(splat(0.5 * (c - a)), splat(0.5 * (b + c))),
    );
    let upper = p.mul_add(
        splat(0.5 * (d - c)),
        q.mul_add(splat(0.5 * (d - b)), splat(0.5 * (b + c))),
    );
    simd.select_f32x8((p + q).simd_le(splat(0.0)), lower, upper)
}
