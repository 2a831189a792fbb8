//! The loop over the tiles of an image, the same for everything drawn into them.

use super::finish::{Finish, Held};
use super::illumination::Illumination;
use super::photos::{PhotoAnswer, Projected};
use super::rows::TileRow;
use super::tile::{HEIGHT, Tile, Tiles, WIDTH};
use super::view::{PixelRect, PixelView};
use crate::render::effects::background::cpu::Gradient;
use crate::scene::ScenePacket;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Content that is drawn into tiles.
pub(super) trait InTiles: Sync {
    /// Scratch memory that a thread keeps from tile to tile.
    type Scratch: Default;

    /// Draws the records that touch the tile of this number, within `clip`. The tile is cleared already.
    fn draw<S: Simd>(&self, simd: S, tile: &mut Tile, clip: PixelRect, number: usize, scratch: &mut Self::Scratch);
}

/// State that all tiles of an image share.
pub(super) struct Painter<'a> {
    pub(super) tiles: Tiles,
    finish: Finish<'a>,
}

impl<'a> Painter<'a> {
    /// Creates a painter for pixels that hold `held`, lit by this illumination if they are surfaces.
    pub(super) fn new(packet: &ScenePacket, held: Held, illumination: Option<Illumination<'a>>) -> Self {
        Self {
            tiles: Tiles::of_picture(packet.viewport_px),
            finish: Finish {
                view: PixelView::new(packet),
                held,
                gradient: Gradient::of(packet),
                illumination,
            },
        }
    }

    pub(super) fn view(&self) -> &PixelView {
        &self.finish.view
    }

    /// Draws every tile, and writes it to its place in its row of the image.
    pub(super) fn paint<T: InTiles>(&self, content: &T, bands: Vec<TileRow<'_>>) {
        let level = Level::new();
        bands.into_par_iter().enumerate().for_each_init(
            || (Tile::new(), T::Scratch::default()),
            |(tile, scratch), (row, mut band)| {
                for column in 0..self.tiles.columns {
                    let place = [column, row];
                    dispatch!(level, simd => self.paint_tile(simd, content, tile, scratch, place, &mut band));
                }
            },
        );
    }

    #[inline(always)]
    fn paint_tile<S: Simd, T: InTiles>(
        &self,
        simd: S,
        content: &T,
        tile: &mut Tile,
        scratch: &mut T::Scratch,
        [column, row]: [usize; 2],
        rows: &mut TileRow<'_>,
    ) {
        let origin = [(WIDTH * column) as i32, (HEIGHT * row) as i32];
        tile.begin(origin, self.finish.held, &self.finish.gradient);
        let picture = PixelRect::of_picture(self.finish.view.size_px);
        let clip = tile.rect().intersection(picture);
        content.draw(simd, tile, clip, self.tiles.columns * row + column, scratch);
        if let Some(posed_images) = self.finish.illumination.and_then(|light| light.posed_images) {
            if let TileRow::Textured(rows) = rows {
                return look_at_tile(simd, posed_images, tile, &self.finish.view, clip, rows);
            }
            color_tile(simd, posed_images, tile, &self.finish.view, clip);
        }
        finish_tile(simd, tile, &self.finish, rows);
    }
}

/// Colours the surface in a tile from images. Compiled once, and not for each primitive.
#[inline(never)]
fn color_tile<S: Simd>(simd: S, posed_images: &Projected<'_>, tile: &mut Tile, view: &PixelView, clip: PixelRect) {
    simd.vectorize(
        #[inline(always)]
        || posed_images.color(simd, tile, view, clip),
    );
}

/// Writes the image samples of the surface in a tile.
#[inline(never)]
fn look_at_tile<S: Simd>(
    simd: S,
    posed_images: &Projected<'_>,
    tile: &Tile,
    view: &PixelView,
    clip: PixelRect,
    rows: &mut [PhotoAnswer],
) {
    simd.vectorize(
        #[inline(always)]
        || posed_images.look(simd, tile, view, clip, rows),
    );
}

/// Writes the pixels of a tile to the image. All lighting is computed here: compiled once, and not for each primitive.
#[inline(never)]
fn finish_tile<S: Simd>(simd: S, tile: &Tile, finish: &Finish<'_>, rows: &mut TileRow<'_>) {
    simd.vectorize(
        #[inline(always)]
        || tile.write(simd, finish, rows),
    );
}
