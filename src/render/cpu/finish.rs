//! From the pixels of a tile to bytes of the image: background, resolve and the grey of depths (`shaders/passes`).

use super::deferred::{Surface, shade};
use super::eight::Vectors;
use super::illumination::Illumination;
use super::photos::Projected;
use super::pixels::{OPAQUE_ALPHA, opaque};
use super::raster::load;
use super::rows::TileRow;
use super::tile::{HEIGHT, LANES, NOWHERE, PIXELS, Tile, WIDTH};
use super::view::{PixelRect, PixelView};
use crate::render::constants::{FARTHEST_GREY, NEAREST_GREY, opaque_weight};
use crate::render::effects::background::cpu::Gradient;
use crate::scene::{Lights, ScenePacket};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};

/// Contents of the pixels of a tile when everything is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) enum Held {
    /// Colours where there is a depth.
    SolidColors,
    /// Colours that were laid over the background.
    BlendedColors,
    /// Sums of weighted colours, and of weights, which hide the background from this one on.
    Sums { opaque_weight: f32 },
    /// Sums as in [`Held::Sums`], with sums of weighted normals, for lighting.
    Surfaces { opaque_weight: f32 },
    /// Keys of points.
    Keys,
    /// Depths, to be shown between these distances.
    Depths { near: f32, white: f32, black: f32 },
}

impl Held {
    /// Sums, of splats in the mode of a packet.
    pub(super) fn sums(packet: &ScenePacket) -> Self {
        Self::surfaces(packet).unwrap_or(Self::Sums {
            opaque_weight: opaque_weight(&packet.style),
        })
    }

    /// Surfaces, if shading is deferred.
    pub(super) fn surfaces(packet: &ScenePacket) -> Option<Self> {
        Lights::of(packet).map(|_| Self::Surfaces {
            opaque_weight: opaque_weight(&packet.style),
        })
    }

    /// Depths, with the distances that are shown white and black.
    pub(super) fn depths(packet: &ScenePacket) -> Self {
        let [white, black] = packet.depth_range();
        Self::Depths {
            near: packet.view.near,
            white,
            black,
        }
    }
}

/// Final processing of the pixels of tiles.
#[derive(Debug)]
pub(super) struct Finish<'a> {
    pub(super) view: PixelView,
    pub(super) held: Held,
    pub(super) gradient: Gradient,
    /// Illumination, if pixels hold surfaces.
    pub(super) illumination: Option<Illumination<'a>>,
}

impl Finish<'_> {
    /// Returns true if gaps in the surface are closed once everything is drawn.
    fn closes_gaps(&self) -> bool {
        let posed_images = self
            .illumination
            .as_ref()
            .and_then(|illumination| illumination.posed_images);
        matches!(self.held, Held::Surfaces { .. }) && posed_images.is_some_and(Projected::closes_gaps)
    }
}

impl Tile {
    /// Clears the buffers that will be drawn to.
    pub(super) fn begin(&mut self, origin: [i32; 2], held: Held, gradient: &Gradient) {
        self.origin = origin;
        match held {
            Held::Keys => clear(&mut self.keys, NOWHERE + LANES),
            Held::Depths { .. } => clear(&mut self.depth, PIXELS),
            // Colours are only read where depths mark a pixel as drawn.
            Held::SolidColors => {
                clear(&mut self.depth, PIXELS);
                self.colors.iter_mut().for_each(|color| color.resize(PIXELS, 0.0));
            }
            Held::Sums { .. } => {
                clear(&mut self.depth, PIXELS);
                clear(&mut self.weight, PIXELS);
                self.colors.iter_mut().for_each(|color| clear(color, PIXELS));
            }
            Held::Surfaces { .. } => {
                clear(&mut self.depth, PIXELS);
                clear(&mut self.weight, PIXELS);
                let sums = self.colors.iter_mut().chain(&mut self.surfaces);
                sums.for_each(|sums| clear(sums, PIXELS));
            }
            Held::BlendedColors => {
                clear(&mut self.depth, PIXELS);
                for color in &mut self.colors {
                    color.resize(PIXELS, 0.0);
                }
                for (row, y) in (0..HEIGHT).zip(origin[1]..) {
                    let color = gradient.at_row(y);
                    for (channel, value) in self.colors.iter_mut().zip(color) {
                        channel[WIDTH * row..WIDTH * (row + 1)].fill(value);
                    }
                }
            }
        }
    }

    /// Writes its pixels to their places in its rows of the image.
    #[inline(always)]
    pub(super) fn write<S: Simd>(&self, simd: S, finish: &Finish<'_>, rows: &mut TileRow<'_>) {
        let held = finish.held;
        let size_px = finish.view.size_px;
        let clip = self.rect().intersection(PixelRect::of_picture(size_px));
        let width_px = size_px[0] as usize;
        let columns = clip.start[0] as usize..clip.end[0] as usize;
        for (row, y) in (clip.start[1]..clip.end[1]).enumerate() {
            let columns = width_px * row + columns.start..width_px * row + columns.end;
            let byte_columns = 4 * columns.start..4 * columns.end;
            match rows {
                TileRow::Bytes(bytes) => {
                    let (pixels, _) = bytes[byte_columns].as_chunks_mut();
                    self.finish_row(simd, finish, row, finish.gradient.at_row(y), pixels);
                }
                TileRow::Unfinished { bytes, depths } => {
                    let (pixels, _) = bytes[byte_columns].as_chunks_mut();
                    self.finish_row(simd, finish, row, finish.gradient.at_row(y), pixels);
                    let depths = &mut depths[columns];
                    if finish.closes_gaps() {
                        self.write_surface_depths(row, depths);
                    } else {
                        self.write_depths(row, held, depths);
                    }
                    self.write_opacities(row, held, depths, pixels);
                }
                TileRow::Depths(depths) => self.write_depths(row, held, &mut depths[columns]),
                // Already written.
                TileRow::Textured(_) => {}
            }
        }
    }

    /// Writes reversed depths of a row.
    #[inline(always)]
    fn write_depths(&self, row: usize, held: Held, depths: &mut [f32]) {
        let first = WIDTH * row;
        if let Held::Keys = held {
            for (depth, key) in depths.iter_mut().zip(&self.keys[first..]) {
                *depth = f32::from_bits((key >> 32) as u32);
            }
        } else {
            let count = depths.len();
            depths.copy_from_slice(&self.depth[first..first + count]);
        }
    }

    /// Writes reversed depths of the blended surface of a row: occluding ones are pushed back.
    #[inline(always)]
    fn write_surface_depths(&self, row: usize, depths: &mut [f32]) {
        let first = WIDTH * row;
        let sums = self.surfaces[3][first..].iter().zip(&self.weight[first..]);
        for (depth, (sum, weight)) in depths.iter_mut().zip(sums) {
            *depth = if *weight > 0.0 { sum / weight } else { 0.0 };
        }
    }

    /// Writes the fraction of the background that the pixels of a row hide, instead of the alpha of an opaque image.
    #[inline(always)]
    fn write_opacities(&self, row: usize, held: Held, depths: &[f32], pixels: &mut [[u8; 4]]) {
        // Retained in the image, through eye-dome lighting, until splat edges are filled.
        if let Held::Sums { opaque_weight } | Held::Surfaces { opaque_weight } = held {
            let weights = &self.weight[WIDTH * row..];
            for (pixel, weight) in pixels.iter_mut().zip(weights) {
                pixel[3] = ((weight * (255.0 / opaque_weight)).min(255.0) + 0.5) as u8;
            }
        } else {
            for (pixel, &depth) in pixels.iter_mut().zip(depths) {
                pixel[3] = if depth > 0.0 { 255 } else { 0 };
            }
        }
    }

    #[inline(always)]
    fn finish_row<S: Simd>(
        &self,
        simd: S,
        finish: &Finish<'_>,
        row: usize,
        background: [f32; 3],
        pixels: &mut [[u8; 4]],
    ) {
        // Nothing here may go through `map` or `from_fn`, and closures must be inlined: see `raster.rs`. With a closure
        // over eight pixels that was not inlined, deferred shading took 42 to 94 ms instead of 9 to 12 ms (1280×720,
        // two threads).
        let splat = |value: f32| f32x8::splat(simd, value);
        let [red, green, blue] = background;
        let background = [splat(red), splat(green), splat(blue)];
        let first = WIDTH * row;
        match finish.held {
            Held::Keys => {
                let empty = opaque(simd, background)[0];
                for (pixel, &key) in pixels.iter_mut().zip(&self.keys[first..]) {
                    // Points are opaque, regardless of their fourth byte.
                    let color = key as u32 | OPAQUE_ALPHA;
                    *pixel = if key == 0 { empty } else { color }.to_le_bytes();
                }
            }
            Held::SolidColors => write(
                simd,
                pixels,
                #[inline(always)]
                |place| {
                    let are_drawn = load(simd, &self.depth, first + place).simd_gt(splat(0.0));
                    select(
                        simd,
                        are_drawn,
                        load_colors(simd, &self.colors, first + place),
                        background,
                    )
                },
            ),
            Held::BlendedColors => write(
                simd,
                pixels,
                #[inline(always)]
                |place| load_colors(simd, &self.colors, first + place),
            ),
            Held::Sums { opaque_weight } => write(
                simd,
                pixels,
                #[inline(always)]
                |place| {
                    let weight = load(simd, &self.weight, first + place);
                    let opacity = (weight * (1.0 / opaque_weight)).min(splat(1.0));
                    // Zero without weight: sums are 0 then.
                    let share = opacity / weight.max(splat(f32::MIN_POSITIVE));
                    let shows_through = 1.0 - opacity;
                    let sums = load_colors(simd, &self.colors, first + place);
                    [
                        sums[0].mul_add(share, background[0] * shows_through),
                        sums[1].mul_add(share, background[1] * shows_through),
                        sums[2].mul_add(share, background[2] * shows_through),
                    ]
                },
            ),
            Held::Surfaces { opaque_weight } => write(
                simd,
                pixels,
                #[inline(always)]
                |place| {
                    let weight = load(simd, &self.weight, first + place);
                    if !simd.any_true_mask32x8(weight.simd_gt(splat(0.0))) {
                        return background;
                    }
                    let per_weight = 1.0 / weight.max(splat(f32::MIN_POSITIVE));
                    let [red, green, blue] = load_colors(simd, &self.colors, first + place);
                    let [x, y, z, depth] = &self.surfaces;
                    let surface = Surface {
                        albedo: [red * per_weight, green * per_weight, blue * per_weight],
                        normal: Vectors {
                            x: load(simd, x, first + place),
                            y: load(simd, y, first + place),
                            z: load(simd, z, first + place),
                        },
                        // Blended like normals: the depths of `Tile::depth` are pushed back by a splat radius.
                        depth: load(simd, depth, first + place) * per_weight,
                    };
                    let pixel = [self.origin[0] + place as i32, self.origin[1] + row as i32];
                    let lit = match &finish.illumination {
                        Some(illumination) => shade(simd, illumination, &finish.view, pixel, &surface),
                        None => surface.albedo,
                    };
                    let opacity = (weight * (1.0 / opaque_weight)).min(splat(1.0));
                    over(simd, lit, opacity, background)
                },
            ),
            Held::Depths { near, white, black } => write(
                simd,
                pixels,
                #[inline(always)]
                |place| {
                    let depth = load(simd, &self.depth, first + place);
                    let share = (near / depth - white) * (1.0 / (black - white));
                    let share = share.max(splat(0.0)).min(splat(1.0));
                    let grey = share.mul_add(splat(FARTHEST_GREY - NEAREST_GREY), splat(NEAREST_GREY));
                    select(simd, depth.simd_gt(splat(0.0)), [grey; 3], background)
                },
            ),
        }
    }
}

#[inline(always)]
fn load_colors<S: Simd>(simd: S, [red, green, blue]: &[Vec<f32>; 3], at: usize) -> [f32x8<S>; 3] {
    [load(simd, red, at), load(simd, green, at), load(simd, blue, at)]
}

/// Writes eight colours after the other to pixels; `colors` makes them for those from a place on.
#[inline(always)]
fn write<S: Simd>(simd: S, pixels: &mut [[u8; 4]], mut colors: impl FnMut(usize) -> [f32x8<S>; 3]) {
    for (chunk, pixels) in pixels.chunks_mut(LANES).enumerate() {
        let eight = opaque(simd, colors(LANES * chunk));
        for (pixel, &color) in pixels.iter_mut().zip(eight.as_slice()) {
            *pixel = color.to_le_bytes();
        }
    }
}

#[inline(always)]
fn select<S: Simd>(simd: S, mask: mask32x8<S>, yes: [f32x8<S>; 3], no: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [
        simd.select_f32x8(mask, yes[0], no[0]),
        simd.select_f32x8(mask, yes[1], no[1]),
        simd.select_f32x8(mask, yes[2], no[2]),
    ]
}

/// Colours over the background colours behind them.
#[inline(always)]
fn over<S: Simd>(simd: S, colors: [f32x8<S>; 3], opacity: f32x8<S>, behind: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    let shows_through = f32x8::splat(simd, 1.0) - opacity;
    [
        colors[0].mul_add(opacity, behind[0] * shows_through),
        colors[1].mul_add(opacity, behind[1] * shows_through),
        colors[2].mul_add(opacity, behind[2] * shows_through),
    ]
}

/// Fills the buffer with `count` zeros.
fn clear<T: Copy + Default>(values: &mut Vec<T>, count: usize) {
    values.clear();
    values.resize(count, T::default());
}
