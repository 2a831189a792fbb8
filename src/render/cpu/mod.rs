//! The software renderer: the passes of `render/gpu` on the processor, for machines without a GPU.
//!
//! How it works: the picture is divided into tiles whose pixels stay in the second cache while everything that may
//! touch them is drawn (`blocks.rs`), pass after pass, and are then written to the picture once. Bands of tiles are
//! tasks that share nothing, so there are no locks and no atomic operations, and pictures do not depend on the number
//! of threads. Patches are affine functions of pixels (`facet.rs`), evaluated eight at a time (`raster.rs`). What looks
//! beyond a tile, as eye-dome lighting does, follows when all of them are drawn (`screen.rs`).
//!
//! Modes, lights and background are those of the shaders; `tests/cpu_renderer.rs` holds the two against each other.

mod blocks;
mod eight;
mod eye_dome;
mod facet;
mod finish;
mod grid;
mod primitives;
mod raster;
mod screen;
mod shading;
#[cfg(test)]
mod tests;
mod tile;
mod view;

use super::{DEPTH_SLACK_RADII, RenderError, RenderStats, Renderer};
use crate::measure::DepthImage;
use crate::scene::{Content, Lighting, ScenePacket, Splatting};
use blocks::{Blocks, TileLists};
use fearless_simd::{Level, Simd, dispatch};
use finish::{Gradient, Held};
use image::RgbaImage;
use primitives::coded;
use primitives::points::Points;
use primitives::surfels::{Surfels, Waiting};
use primitives::voxels::Cubes;
use rayon::prelude::*;
use screen::Screen;
use std::time::Instant;
use tile::{HEIGHT, Tile, Tiles, WIDTH};
use view::{PixelRect, PixelView};

/// Draws on the processor.
#[derive(Debug, Default)]
pub struct CpuRenderer {
    prepared: Option<ScenePacket>,
    drawn: Option<ScenePacket>,
    /// Boxes around what the prepared packet draws, made for the records of this one.
    blocks: Option<(Content, Blocks)>,
    image: RgbaImage,
    /// Reversed depths of the picture, where something follows that needs them.
    depths: Vec<f32>,
    stats: RenderStats,
}

impl CpuRenderer {
    /// Longest edge of a picture: as that of textures of most GPUs.
    pub const MAX_EDGE_PX: u32 = 32_768;

    /// A renderer that has drawn nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets what was drawn, so that the same packet is drawn again: benchmarks measure that.
    pub fn invalidate(&mut self) {
        self.drawn = None;
    }

    /// The depth of what the prepared packet's picture shows, drawn apart: of surfels blended in two passes that of the
    /// nearest disk, without the slack that lets them blend. [`Splatting::NoDepth`] shows no surface in particular:
    /// infinite everywhere.
    pub fn draw_depths(&mut self) -> Result<DepthImage, RenderError> {
        let (Some(packet), Some((_, blocks))) = (&self.prepared, &self.blocks) else {
            return Err(RenderError::NothingPrepared);
        };
        let size_px = packet.viewport_px;
        let mut depth = vec![f32::INFINITY; size_px.map(|edge| edge as usize).iter().product()];
        let bands = bands_of(packet, &mut depth, 1).map(Rows::Distances);
        rayon::scope(|_| draw(&of_surfaces(packet), blocks, 0.0, bands.collect()));
        Ok(DepthImage { size_px, depth })
    }

    /// The last picture.
    pub fn image(&self) -> &RgbaImage {
        &self.image
    }
}

impl Renderer for CpuRenderer {
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        let start = Instant::now();
        let [width, height] = packet.viewport_px;
        if width.max(height) > Self::MAX_EDGE_PX {
            let max = Self::MAX_EDGE_PX;
            return Err(RenderError::TooLarge { width, height, max });
        }
        let is_kept = self
            .blocks
            .as_ref()
            .is_some_and(|(of, _)| *of == packet.content);
        if !is_kept {
            let blocks = match Drawable::of(packet, DEPTH_SLACK_RADII) {
                Drawable::Points(points) => Blocks::of(&points),
                Drawable::Surfels(surfels) => Blocks::of(&surfels),
                Drawable::Cubes(cubes) => Blocks::of(&cubes),
                Drawable::Nothing => Blocks::of(&Points::NONE),
            };
            self.blocks = Some((packet.content.clone(), blocks));
        }
        self.prepared = Some(packet.clone());
        self.stats.prepare_ms = milliseconds_since(start);
        Ok(())
    }

    fn render(&mut self) -> Result<(), RenderError> {
        let (Some(packet), Some((_, blocks))) = (&self.prepared, &self.blocks) else {
            return Err(RenderError::NothingPrepared);
        };
        if self.drawn.as_ref() == Some(packet) {
            return Ok(());
        }
        let start = Instant::now();
        let [width, height] = packet.viewport_px;
        if self.image.dimensions() != (width, height) {
            self.image = RgbaImage::new(width, height);
        }
        let screen = Screen::of(packet);
        let pixels = if screen.is_some() {
            self.image.len() / 4
        } else {
            0
        };
        self.depths.resize(pixels, 0.0);
        let bytes = bands_of(packet, &mut self.image, 4);
        let bands: Vec<Rows<'_>> = if screen.is_some() {
            let both = bytes.zip(bands_of(packet, &mut self.depths, 1));
            both.map(|(bytes, depths)| Rows::Unfinished { bytes, depths })
                .collect()
        } else {
            bytes.map(Rows::Bytes).collect()
        };
        let drawn_records = if packet.content.coded().is_some() {
            coded::draw(packet, bands)
        } else {
            rayon::scope(|_| draw(packet, blocks, DEPTH_SLACK_RADII, bands))
        };
        self.stats.screen_ms = 0.0;
        if let Some(screen) = screen {
            let start = Instant::now();
            rayon::scope(|_| screen.draw(&mut self.image, &self.depths));
            self.stats.screen_ms = milliseconds_since(start);
        }
        self.stats.frames += 1;
        self.stats.passes += 1;
        self.stats.draw_calls = 1;
        self.stats.drawn_instances = drawn_records;
        self.stats.encode_ms = milliseconds_since(start);
        self.drawn = Some(packet.clone());
        Ok(())
    }

    fn read_image(&mut self) -> Result<RgbaImage, RenderError> {
        if self.drawn.is_none() {
            return Err(RenderError::NothingPrepared);
        }
        Ok(self.image.clone())
    }

    fn stats(&self) -> RenderStats {
        self.stats
    }
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// What a packet shows.
enum Drawable<'a> {
    Points(Points<'a>),
    Surfels(Surfels<'a>),
    Cubes(Cubes<'a>),
    /// Nothing that stands in blocks of records.
    Nothing,
}

impl<'a> Drawable<'a> {
    fn of(packet: &'a ScenePacket, slack_radii: f32) -> Self {
        let settings = &packet.settings;
        match &packet.content {
            Content::Nothing | Content::Coded(_) => Self::Nothing,
            Content::Points(records) => Self::Points(Points {
                records,
                size_px: settings.points.size_px,
                shape: settings.points.shape,
            }),
            Content::Surfels(surfels) => Self::Surfels(Surfels {
                points: &surfels.points,
                shapes: &surfels.shapes,
                settings,
                slack_radii,
            }),
            Content::Voxels(voxels) => Self::Cubes(Cubes::new(voxels, settings.light.lighting)),
        }
    }
}

/// `packet` as it is drawn for depths alone: what is blended in two passes lies on the disks of its first.
fn of_surfaces(packet: &ScenePacket) -> ScenePacket {
    let mut packet = packet.clone();
    let settings = &mut packet.settings;
    match settings.surfels.splatting {
        Splatting::Regular | Splatting::NoDepth | Splatting::Visibility => {}
        Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
            settings.surfels.splat_scale *= settings
                .surfels
                .splatting
                .scales(settings.surfels.enlargement)[0];
            settings.surfels.splatting = Splatting::Visibility;
        }
    }
    packet
}

/// A row of tiles of what is made of their pixels.
enum Rows<'a> {
    /// Of a picture, four bytes a pixel.
    Bytes(&'a mut [u8]),
    /// Of a picture that [`Screen`] finishes: the fourth byte of a pixel is its opacity. And reversed depths.
    Unfinished {
        bytes: &'a mut [u8],
        depths: &'a mut [f32],
    },
    /// Distances along the view axis.
    Distances(&'a mut [f32]),
}

/// What belongs to rows of tiles, of as many values for each pixel of a picture.
fn bands_of<'a, T>(
    packet: &ScenePacket,
    values: &'a mut [T],
    per_pixel: usize,
) -> impl Iterator<Item = &'a mut [T]> {
    values.chunks_mut(per_pixel * packet.viewport_px[0] as usize * HEIGHT)
}

/// Draws a packet; how many records were handed to tiles.
fn draw(packet: &ScenePacket, blocks: &Blocks, slack_radii: f32, bands: Vec<Rows<'_>>) -> u64 {
    let view = PixelView::new(packet);
    let tiles = Tiles::of_picture(packet.viewport_px);
    let drawable = Drawable::of(packet, slack_radii);
    let (scale, margin_px) = match &drawable {
        Drawable::Points(points) => (0.0, 0.5 * points.size_px),
        Drawable::Surfels(surfels) => (surfels.largest_scale(), 0.0),
        Drawable::Cubes(_) | Drawable::Nothing => (1.0, 0.0),
    };
    let lists = blocks.by_tile(&view, tiles, scale, margin_px);
    let held = match (&drawable, packet.settings.surfels.splatting) {
        (Drawable::Points(_), _) => Held::Keys,
        (Drawable::Cubes(_) | Drawable::Nothing, _) => Held::SolidColors,
        (Drawable::Surfels(_), Splatting::Regular | Splatting::NoDepth) => Held::BlendedColors,
        (Drawable::Surfels(_), Splatting::Visibility) => Held::depths(packet),
        (Drawable::Surfels(_), _) => Held::Sums,
    };
    let picture = Picture {
        view,
        tiles,
        drawable,
        lists,
        held,
        gradient: Gradient::of(packet),
        are_rays_measured: packet.settings.light.lighting == Lighting::PerFragment
            && matches!(held, Held::Sums | Held::BlendedColors | Held::SolidColors),
    };
    let level = Level::new();
    bands.into_par_iter().enumerate().for_each_init(
        || (Tile::new(), Waiting::new()),
        |(tile, waiting), (row, mut band)| {
            for column in 0..tiles.columns {
                dispatch!(level, simd => picture.draw_tile(simd, tile, waiting, [column, row], &mut band));
            }
        },
    );
    picture.lists.handed_out()
}

/// Everything that a tile is drawn from.
struct Picture<'a> {
    view: PixelView,
    tiles: Tiles,
    drawable: Drawable<'a>,
    lists: TileLists,
    held: Held,
    gradient: Gradient,
    /// For light that is worked out at each pixel.
    are_rays_measured: bool,
}

impl Picture<'_> {
    /// Draws a tile, and writes it to its place in some rows of the picture.
    #[inline(always)]
    fn draw_tile<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        waiting: &mut Waiting,
        [column, row]: [usize; 2],
        rows: &mut Rows<'_>,
    ) {
        let origin = [(WIDTH * column) as i32, (HEIGHT * row) as i32];
        tile.begin(origin, self.held, &self.gradient);
        let picture = PixelRect::of_picture(self.view.size_px);
        let clip = tile.rect().intersection(picture);
        let records = self.lists.records(self.tiles.columns * row + column);
        if self.are_rays_measured && records.len() > 0 {
            simd.vectorize(
                #[inline(always)]
                || raster::measure_rays(simd, &self.view, tile),
            );
        }
        match &self.drawable {
            Drawable::Points(points) => simd.vectorize(
                #[inline(always)]
                || points.draw(simd, &self.view, tile, clip, records),
            ),
            Drawable::Surfels(surfels) => simd.vectorize(
                #[inline(always)]
                || surfels.draw(simd, &self.view, tile, clip, records, waiting),
            ),
            Drawable::Cubes(cubes) => simd.vectorize(
                #[inline(always)]
                || cubes.draw(simd, &self.view, tile, clip, records),
            ),
            Drawable::Nothing => {}
        }
        tile.write(simd, &self.view, self.held, &self.gradient, rows);
    }
}
