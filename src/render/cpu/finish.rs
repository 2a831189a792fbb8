//! From the pixels of a tile to bytes of the picture: background, resolve and the grey of depths (`shaders/passes`).

use super::tile::{HEIGHT, NOWHERE, PIXELS, Tile, WIDTH};
use super::view::PixelRect;
use crate::scene::{Background, ScenePacket};

/// Summed weight from which a pixel hides the background, as in `shaders/passes/resolve.wgsl`.
const OPAQUE_WEIGHT: f32 = 0.22;

/// What the pixels of a tile hold when all is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) enum Held {
    /// Colours where there is a depth.
    SolidColors,
    /// Colours that were laid over the background.
    BlendedColors,
    /// Sums of weighted colours, and of weights.
    Sums,
    /// Keys of points.
    Keys,
    /// Depths, to be shown between these distances.
    Depths { near: f32, white: f32, black: f32 },
}

impl Held {
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

/// The vertical gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gradient {
    pub(super) background: Background,
    pub(super) height_px: u32,
}

impl Gradient {
    /// The colour of a row, 0 to 1.
    pub(super) fn at_row(&self, y: i32) -> [f32; 3] {
        let share = (y as f32 + 0.5) / self.height_px as f32;
        let Background { top, bottom } = self.background;
        std::array::from_fn(|channel| {
            let [top, bottom] = [top, bottom].map(|color| f32::from(color[channel]) / 255.0);
            top * (1.0 - share) + bottom * share
        })
    }
}

impl Tile {
    /// Clears what will be drawn to.
    pub(super) fn begin(&mut self, origin: [i32; 2], held: Held, gradient: &Gradient) {
        self.origin = origin;
        match held {
            Held::Keys => clear(&mut self.keys, NOWHERE + 1),
            Held::Depths { .. } => clear(&mut self.depth, PIXELS),
            // What is drawn is covered by depths.
            Held::SolidColors => {
                clear(&mut self.depth, PIXELS);
                self.colors
                    .iter_mut()
                    .for_each(|color| color.resize(PIXELS, 0.0));
            }
            Held::Sums => {
                clear(&mut self.depth, PIXELS);
                clear(&mut self.weight, PIXELS);
                self.colors
                    .iter_mut()
                    .for_each(|color| clear(color, PIXELS));
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

    /// Writes a part of its pixels to their places in the rows of the picture that it is in.
    #[inline(always)]
    pub(super) fn finish(
        &self,
        clip: PixelRect,
        held: Held,
        gradient: &Gradient,
        width_px: usize,
        rows: &mut [u8],
    ) {
        let columns = clip.start[0] as usize..clip.end[0] as usize;
        for (row, y) in (clip.start[1]..clip.end[1]).enumerate() {
            let pixels = &mut rows[4 * width_px * row..][4 * columns.start..4 * columns.end];
            let (pixels, _) = pixels.as_chunks_mut::<4>();
            let first = WIDTH * row;
            self.finish_row(
                first..first + columns.len(),
                held,
                gradient.at_row(y),
                pixels,
            );
        }
    }

    /// Writes the distances of a part of its pixels along the view axis to their places in the rows of the picture that it is in.
    #[inline(always)]
    pub(super) fn write_depths(
        &self,
        clip: PixelRect,
        held: Held,
        near: f32,
        width_px: usize,
        rows: &mut [f32],
    ) {
        let columns = clip.start[0] as usize..clip.end[0] as usize;
        for row in 0..(clip.end[1] - clip.start[1]) as usize {
            let depths = &mut rows[width_px * row..][columns.clone()];
            for (place, depth) in (WIDTH * row..).zip(depths) {
                let reversed = match held {
                    Held::Keys => f32::from_bits((self.keys[place] >> 32) as u32),
                    _ => self.depth[place],
                };
                *depth = near / reversed;
            }
        }
    }

    #[inline(always)]
    fn finish_row(
        &self,
        places: std::ops::Range<usize>,
        held: Held,
        background: [f32; 3],
        pixels: &mut [[u8; 4]],
    ) {
        // Nothing here may go through `map` or `from_fn`: see `raster.rs`.
        let [red, green, blue] = &self.colors;
        let color_at = |place: usize| [red[place], green[place], blue[place]];
        match held {
            Held::Keys => {
                let empty = opaque(background);
                for (pixel, &key) in pixels.iter_mut().zip(&self.keys[places]) {
                    let [red, green, blue, _] = (key as u32).to_le_bytes();
                    *pixel = if key == 0 {
                        empty
                    } else {
                        [red, green, blue, 255]
                    };
                }
            }
            Held::SolidColors => {
                for (place, pixel) in places.zip(pixels) {
                    let is_drawn = self.depth[place] > 0.0;
                    *pixel = opaque(if is_drawn {
                        color_at(place)
                    } else {
                        background
                    });
                }
            }
            Held::BlendedColors => {
                for (place, pixel) in places.zip(pixels) {
                    *pixel = opaque(color_at(place));
                }
            }
            Held::Sums => {
                for (place, pixel) in places.zip(pixels) {
                    let weight = self.weight[place];
                    let opacity = (weight / OPAQUE_WEIGHT).min(1.0);
                    let share = if weight > 0.0 { opacity / weight } else { 0.0 };
                    let sums = color_at(place);
                    let over =
                        |sum: f32, background: f32| sum * share + background * (1.0 - opacity);
                    *pixel = opaque([
                        over(sums[0], background[0]),
                        over(sums[1], background[1]),
                        over(sums[2], background[2]),
                    ]);
                }
            }
            Held::Depths { near, white, black } => {
                for (pixel, &depth) in pixels.iter_mut().zip(&self.depth[places]) {
                    let share = ((near / depth - white) / (black - white)).clamp(0.0, 1.0);
                    let grey = 0.95 * (1.0 - share) + 0.15 * share;
                    *pixel = opaque(if depth > 0.0 { [grey; 3] } else { background });
                }
            }
        }
    }
}

/// As many zeros.
fn clear<T: Copy + Default>(values: &mut Vec<T>, count: usize) {
    values.clear();
    values.resize(count, T::default());
}

/// Bytes of a colour, which is 0 to 1.
#[inline(always)]
fn opaque(color: [f32; 3]) -> [u8; 4] {
    let byte = |channel: f32| (channel * 255.0 + 0.5) as u8;
    [byte(color[0]), byte(color[1]), byte(color[2]), 255]
}
