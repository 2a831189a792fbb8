//! The image in tiles: a piece of it, with all data that its pixels need while they are drawn, stays in the second
//! cache.

use super::view::PixelRect;
use std::ops::Range;

/// Pixels of a tile, a multiple of [`LANES`] wide.
pub(super) const WIDTH: usize = 128;
pub(super) const HEIGHT: usize = 64;
pub(super) const PIXELS: usize = WIDTH * HEIGHT;

/// The first of [`LANES`] places after all pixels, for pixels outside the tile.
pub(super) const NOWHERE: usize = PIXELS;

/// Pixels processed together: consecutive ones of a row that begin at a multiple of it.
pub(in crate::render) const LANES: usize = 8;

/// Tiling of an image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tiles {
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl Tiles {
    pub(super) fn of_picture(size_px: [u32; 2]) -> Self {
        Self {
            columns: (size_px[0] as usize).div_ceil(WIDTH),
            rows: (size_px[1] as usize).div_ceil(HEIGHT),
        }
    }

    pub(super) fn count(self) -> usize {
        self.columns * self.rows
    }

    /// Columns and rows of the tiles that overlap a rectangle of the image.
    pub(super) fn covered_by(rect: PixelRect) -> [Range<usize>; 2] {
        if rect.is_empty() {
            return [0..0, 0..0];
        }
        let range =
            |axis: usize, edge: usize| rect.start[axis] as usize / edge..(rect.end[axis] as usize).div_ceil(edge);
        [range(0, WIDTH), range(1, HEIGHT)]
    }
}

/// The pixels of one tile while it is drawn, row after row.
#[derive(Debug)]
pub(super) struct Tile {
    /// The pixel of the image in its upper left corner.
    pub(super) origin: [i32; 2],
    /// Reversed depth, `near/distance`; 0 where nothing is.
    pub(super) depth: Vec<f32>,
    /// Red, green and blue from 0 to 1, times a weight where weights are summed up.
    pub(super) colors: [Vec<f32>; 3],
    pub(super) weight: Vec<f32>,
    /// Normals along the axes of view space, and reversed depths, times a weight; if the blended surface is lit.
    pub(super) surfaces: [Vec<f32>; 4],
    /// The bits of the depth above 32 of colour, for points; and those from [`NOWHERE`] on.
    pub(super) keys: Vec<u64>,
    /// Reciprocal lengths of the rays through pixels, for light that is computed at each.
    pub(super) per_ray_length: Vec<f32>,
}

impl Tile {
    /// A tile without pixels: they get memory when something is drawn that needs it.
    pub(super) fn new() -> Self {
        Self {
            origin: [0; 2],
            depth: Vec::new(),
            colors: [const { Vec::new() }; 3],
            weight: Vec::new(),
            surfaces: [const { Vec::new() }; 4],
            keys: Vec::new(),
            per_ray_length: Vec::new(),
        }
    }

    /// Its pixels in the image.
    pub(super) fn rect(&self) -> PixelRect {
        let [x, y] = self.origin;
        PixelRect {
            start: self.origin,
            end: [x + WIDTH as i32, y + HEIGHT as i32],
        }
    }
}
