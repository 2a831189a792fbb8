//! Triangle rasterisation: interpolates the corners at each pixel, eight pixels of a row at a time.
//!
//! A position on a triangle is `a + p·(b − a) + q·(c − a)`. As for patches (`facet.rs`), `p = P/W` and `q = Q/W` with
//! functions that are affine in the pixel's coordinates, and the reversed depth is a multiple of W. The covered pixels
//! are determined separately (`spans.rs`): along edges the functions are rounded differently on both sides.

use super::deferred::rays;
use super::eight::{Vectors, lane_numbers};
use super::linear::{to_display, to_linear};
use super::raster::{headlight_of, load, store};
use super::shading::headlight;
use super::tile::{LANES, Tile, WIDTH};
use super::view::{Affine, PixelView};
use crate::cloud::Textures;
use crate::scene::Lighting;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use glam::Vec3;
use std::ops::Range;

/// A triangle on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    p: Affine,
    q: Affine,
    w: Affine,
    /// Reversed depth, `near/distance`, for each unit of `w`.
    depth_per_w: f32,
    /// The minimum and maximum depth of its corners.
    depths: [f32; 2],
}

impl Triangle {
    /// Creates it from its corners in view space.
    #[inline(always)]
    pub(super) fn new(view: &PixelView, [a, b, c]: [Vec3; 3]) -> Self {
        let reversed = [a, b, c].map(|corner| {
            // The part behind the near plane is clipped.
            let is_in_front = corner.z <= -view.near;
            if is_in_front { view.near / -corner.z } else { 1.0 }
        });
        let min = reversed[0].min(reversed[1]).min(reversed[2]);
        let greatest = reversed[0].max(reversed[1]).max(reversed[2]);
        let (u, v) = (b - a, c - a);
        // Sizes are relative to the distance, so that products of small or large numbers neither underflow nor
        // overflow.
        let largest = a.abs().max(u.abs()).max(v.abs()).max_element();
        let per_scale = 1.0 / largest;
        let [a, u, v] = [a, u, v].map(|vector| vector * per_scale);
        let normal = u.cross(v);
        let determinant = normal.dot(a);
        let depth_per_w = view.near * per_scale / determinant.abs();
        if !depth_per_w.is_finite() {
            // Seen edge-on: if rounding leaves it a pixel, that shows its first corner.
            let one = Affine {
                at_origin: 1.0,
                ..Affine::default()
            };
            return Self {
                p: Affine::default(),
                q: Affine::default(),
                w: one,
                depth_per_w: greatest,
                depths: [greatest; 2],
            };
        }
        let sign = 1f32.copysign(determinant);
        Self {
            p: view.along_rays(v.cross(a) * sign),
            q: view.along_rays(a.cross(u) * sign),
            w: view.along_rays(normal * sign),
            depth_per_w,
            depths: [min, greatest],
        }
    }
}

/// A triangle on the screen, and how it is shaded.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShadedTriangle<'a> {
    pub(super) triangle: Triangle,
    pub(super) shading: TriangleShading<'a>,
}

/// The colour of a triangle and its light.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriangleShading<'a> {
    /// Red, green and blue at the corners, 0 to 1.
    pub(super) colors: [[f32; 3]; 3],
    /// Texture that colours are multiplied with, as with the light.
    pub(super) texture: Option<TextureOnTriangle<'a>>,
    pub(super) light: TriangleLight,
    /// In view space, at the corners: if the finished surface is lit.
    pub(super) normals: Option<[Vec3; 3]>,
}

/// A texture, and the positions of the corners in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct TextureOnTriangle<'a> {
    pub(super) textures: &'a Textures,
    pub(super) texture: usize,
    pub(super) places: [[f32; 2]; 3],
}

/// Lighting evaluation points of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) enum TriangleLight {
    /// Factors, and white, at the corners.
    OfCorners([[f32; 2]; 3]),
    /// At each pixel, by the normals at the corners in view space.
    OfPixels([Vec3; 3]),
}

impl TriangleLight {
    /// Computes the lighting of a triangle with these corners and normals, in view space; `face` is the normal of the
    /// whole.
    #[inline(always)]
    pub(super) fn new(lighting: Lighting, corners: [Vec3; 3], normals: [Vec3; 3], face: Vec3) -> Self {
        match lighting {
            Lighting::Unlit | Lighting::Lambert | Lighting::BlinnPhong | Lighting::Physical => {
                Self::OfCorners([[1.0, 0.0]; 3])
            }
            Lighting::PerSurfel => {
                let [a, b, c] = corners;
                Self::OfCorners([headlight(face, a + b + c); 3])
            }
            Lighting::PerVertex => Self::OfCorners([0, 1, 2].map(|index| headlight(normals[index], corners[index]))),
            Lighting::PerFragment => Self::OfPixels(normals),
        }
    }
}

/// Positions of eight pixels on a triangle.
struct Places<S: Simd> {
    /// On the triangle.
    p: f32x8<S>,
    q: f32x8<S>,
    /// The first of them in the image, and in its tile.
    pixel: [i32; 2],
    at: usize,
}

impl<S: Simd> Places<S> {
    /// Interpolates between the values at the corners.
    #[inline(always)]
    fn between(&self, simd: S, [a, b, c]: [f32; 3]) -> f32x8<S> {
        let splat = |value: f32| f32x8::splat(simd, value);
        self.p.mul_add(splat(b - a), self.q.mul_add(splat(c - a), splat(a)))
    }

    #[inline(always)]
    fn vectors_between(&self, simd: S, [a, b, c]: [Vec3; 3]) -> Vectors<S> {
        Vectors {
            x: self.between(simd, [a.x, b.x, c.x]),
            y: self.between(simd, [a.y, b.y, c.y]),
            z: self.between(simd, [a.z, b.z, c.z]),
        }
    }
}

/// Draws a row of a triangle where nothing is nearer, opaque.
#[inline(always)]
pub(super) fn fill<S: Simd>(
    simd: S,
    view: &PixelView,
    tile: &mut Tile,
    shaded: &ShadedTriangle<'_>,
    y: i32,
    columns: Range<i32>,
) {
    let splat = |value: f32| f32x8::splat(simd, value);
    let ShadedTriangle { triangle, shading } = shaded;
    let [left, top] = tile.origin;
    let row = (y - top) as usize * WIDTH;
    let first = columns.start - (columns.start - left) % LANES as i32;
    let lanes = lane_numbers(simd);
    for x in (first..columns.end).step_by(LANES) {
        let at = row + (x - left) as usize;
        let value = |function: &Affine| lanes.mul_add(splat(function.per_px[0]), splat(function.at_px(x, y)));
        let w = value(&triangle.w);
        let depths = (w * triangle.depth_per_w)
            .max(splat(triangle.depths[0]))
            .min(splat(triangle.depths[1]));
        let before = load(simd, &tile.depth, at);
        let drawn = lanes.simd_ge(splat((columns.start - x) as f32))
            & lanes.simd_lt(splat((columns.end - x) as f32))
            & depths.simd_ge(before);
        if !simd.any_true_mask32x8(drawn) {
            continue;
        }
        store(simd.select_f32x8(drawn, depths, before), &mut tile.depth, at);
        let per_w = 1.0 / w;
        let p = share(simd, value(&triangle.p) * per_w, splat(1.0));
        let q = share(simd, value(&triangle.q) * per_w, 1.0 - p);
        let pixel = [x, y];
        let places = Places { p, q, pixel, at };
        let colors = shading.colors(simd, view, &tile.per_ray_length, &places);
        for (channel, below) in tile.colors.iter_mut().enumerate() {
            keep(simd, drawn, colors[channel], below, at);
        }
        if let Some(normals) = shading.normals {
            let Vectors { x, y, z } = places.vectors_between(simd, normals);
            for (value, below) in [x, y, z, depths].into_iter().zip(&mut tile.surfaces) {
                keep(simd, drawn, value, below, at);
            }
            keep(simd, drawn, splat(1.0), &mut tile.weight, at);
        }
    }
}

/// Clamped from 0 to the maximum, and 0 for NaN: on its borders a triangle may be missed by rounding.
#[inline(always)]
fn share<S: Simd>(simd: S, value: f32x8<S>, max: f32x8<S>) -> f32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    simd.select_f32x8(value.simd_gt(zero), value.min(max), zero)
}

/// Writes the drawn ones of eight values over the existing ones.
#[inline(always)]
fn keep<S: Simd>(simd: S, drawn: mask32x8<S>, value: f32x8<S>, below: &mut [f32], at: usize) {
    let there = load(simd, below, at);
    store(simd.select_f32x8(drawn, value, there), below, at);
}

impl TextureOnTriangle<'_> {
    /// Display-referred red, green and blue of eight pixels. Texels are anywhere: they are looked up one by one.
    #[inline(always)]
    fn colors<S: Simd>(&self, simd: S, places: &Places<S>) -> [f32x8<S>; 3] {
        let [a, b, c] = self.places;
        let u = places.between(simd, [a[0], b[0], c[0]]);
        let v = places.between(simd, [a[1], b[1], c[1]]);
        let mut colors = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let color = self.textures.color(self.texture, [u[lane], v[lane]]);
            for (channel, value) in colors.iter_mut().zip(color) {
                channel[lane] = value;
            }
        }
        let [red, green, blue] = &colors;
        [
            f32x8::from_slice(simd, red),
            f32x8::from_slice(simd, green),
            f32x8::from_slice(simd, blue),
        ]
    }
}

/// Two display-referred channels multiplied as light is.
#[inline(always)]
fn filtered<S: Simd>(simd: S, channel: f32x8<S>, by: f32x8<S>) -> f32x8<S> {
    to_display(simd, to_linear(simd, channel) * to_linear(simd, by))
}

impl TriangleShading<'_> {
    /// The lit colours of eight pixels.
    #[inline(always)]
    fn colors<S: Simd>(&self, simd: S, view: &PixelView, per_ray_length: &[f32], places: &Places<S>) -> [f32x8<S>; 3] {
        let splat = |value: f32| f32x8::splat(simd, value);
        // No `map` over arrays of registers: see `raster.rs`.
        let [factor, white] = match self.light {
            TriangleLight::OfCorners([a, b, c]) => [
                places.between(simd, [a[0], b[0], c[0]]),
                places.between(simd, [a[1], b[1], c[1]]),
            ],
            TriangleLight::OfPixels(normals) => {
                let normal = places.vectors_between(simd, normals);
                let per_length =
                    load(simd, per_ray_length, places.at) / normal.dot(normal).max(f32::MIN_POSITIVE).sqrt();
                let facing = normal.dot(rays(simd, view, places.pixel)).abs() * per_length;
                headlight_of(simd, facing)
            }
        };
        let [a, b, c] = self.colors;
        let mut red = places.between(simd, [a[0], b[0], c[0]]);
        let mut green = places.between(simd, [a[1], b[1], c[1]]);
        let mut blue = places.between(simd, [a[2], b[2], c[2]]);
        if let Some(texture) = &self.texture {
            let [of_red, of_green, of_blue] = texture.colors(simd, places);
            red = filtered(simd, red, of_red);
            green = filtered(simd, green, of_green);
            blue = filtered(simd, blue, of_blue);
        }
        [
            red.mul_add(factor, white).min(splat(1.0)),
            green.mul_add(factor, white).min(splat(1.0)),
            blue.mul_add(factor, white).min(splat(1.0)),
        ]
    }
}
