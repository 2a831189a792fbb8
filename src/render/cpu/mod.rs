//! The software renderer: the passes of `render/gpu` on the processor, for machines without a GPU.
//!
//! How it works: the picture is divided into tiles whose pixels stay in the second cache while everything that may touch them is
//! drawn (`blocks.rs`), pass after pass, and are then written to the picture once. Bands of tiles are tasks that share
//! nothing, so there are no locks and no atomic operations, and pictures do not depend on the number of threads. Patches
//! are affine functions of pixels (`facet.rs`), evaluated eight at a time (`raster.rs`).
//!
//! Modes, lights and background are those of the shaders; `tests/cpu_renderer.rs` holds the two against each other.

mod blocks;
mod coded;
mod eight;
mod facet;
mod finish;
mod points;
mod raster;
mod shading;
mod surfels;
#[cfg(test)]
mod tests;
mod tile;
mod view;
mod voxels;

use super::{DEPTH_SLACK_RADII, RenderError, RenderStats, Renderer};
use crate::measure::DepthImage;
use crate::scene::{Lighting, Primitive, ScenePacket, Splatting};
use blocks::{Blocks, TileLists};
use fearless_simd::{Level, Simd, dispatch};
use finish::{Gradient, Held};
use image::RgbaImage;
use points::Points;
use rayon::prelude::*;
use std::time::Instant;
use surfels::{Surfels, Waiting};
use tile::{HEIGHT, Tile, Tiles, WIDTH};
use view::{PixelRect, PixelView};
use voxels::Cubes;

/// Draws on the processor.
#[derive(Debug, Default)]
pub struct CpuRenderer {
    prepared: Option<ScenePacket>,
    drawn: Option<ScenePacket>,
    /// Boxes around what the prepared packet draws, made for the records of this one.
    blocks: Option<(ScenePacket, Blocks)>,
    image: RgbaImage,
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

    /// The depth of what the prepared packet's picture shows, drawn apart: of surfels blended in two passes that of the nearest disk,
    /// without the slack that lets them blend. [`Splatting::NoDepth`] shows no surface in particular: infinite everywhere.
    pub fn draw_depths(&mut self) -> Result<DepthImage, RenderError> {
        let (Some(packet), Some((_, blocks))) = (&self.prepared, &self.blocks) else {
            return Err(RenderError::NothingPrepared);
        };
        let size_px = packet.viewport_px;
        let mut depth = vec![f32::INFINITY; size_px.map(|edge| edge as usize).iter().product()];
        rayon::scope(|_| draw(&of_surfaces(packet), blocks, 0.0, &mut depth));
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
        let is_kept = self.blocks.as_ref().is_some_and(|(of, _)| {
            of.has_same_records(packet) && of.settings.primitive == packet.settings.primitive
        });
        if !is_kept {
            let blocks = match Drawable::of(packet, DEPTH_SLACK_RADII) {
                Drawable::Points(points) => Blocks::of(&points),
                Drawable::Surfels(surfels) => Blocks::of(&surfels),
                Drawable::Cubes(cubes) => Blocks::of(&cubes),
                Drawable::Nothing => Blocks::of(&Points::NONE),
            };
            self.blocks = Some((packet.clone(), blocks));
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
        let drawn_records = match coded::draw(packet, &mut self.image) {
            Some(drawn_nodes) => drawn_nodes,
            None => rayon::scope(|_| draw(packet, blocks, DEPTH_SLACK_RADII, &mut self.image)),
        };
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
    /// The frame lacks what the primitive needs.
    Nothing,
}

impl<'a> Drawable<'a> {
    fn of(packet: &'a ScenePacket, slack_radii: f32) -> Self {
        let settings = &packet.settings;
        match settings.primitive {
            Primitive::Point => Self::Points(Points {
                records: &packet.points,
                size_px: settings.point_size_px,
            }),
            Primitive::Surfel => packet.shapes.as_ref().map_or(Self::Nothing, |shapes| {
                Self::Surfels(Surfels {
                    points: &packet.points,
                    shapes,
                    settings,
                    slack_radii,
                })
            }),
            Primitive::Voxel => packet.voxels.as_ref().map_or(Self::Nothing, |voxels| {
                Self::Cubes(Cubes::new(voxels, settings.lighting))
            }),
        }
    }
}

/// `packet` as it is drawn for depths alone: what is blended in two passes lies on the disks of its first.
fn of_surfaces(packet: &ScenePacket) -> ScenePacket {
    let mut packet = packet.clone();
    let settings = &mut packet.settings;
    match settings.splatting {
        Splatting::Regular | Splatting::NoDepth | Splatting::Visibility => {}
        Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
            settings.splat_scale *= settings.splatting.scales(settings.enlargement)[0];
            settings.splatting = Splatting::Visibility;
        }
    }
    packet
}

/// Some rows of what is made of the pixels of tiles.
enum Rows<'a> {
    /// Of a picture, four bytes a pixel.
    Bytes(&'a mut [u8]),
    /// Distances along the view axis.
    Depths(&'a mut [f32]),
}

/// What [`Rows`] are made of.
trait Output: Copy + Send + Sync {
    /// How many of them a pixel has.
    const PER_PIXEL: usize;

    /// Rows of them.
    fn rows(rows: &mut [Self]) -> Rows<'_>;
}

impl Output for u8 {
    const PER_PIXEL: usize = 4;

    fn rows(rows: &mut [Self]) -> Rows<'_> {
        Rows::Bytes(rows)
    }
}

impl Output for f32 {
    const PER_PIXEL: usize = 1;

    fn rows(rows: &mut [Self]) -> Rows<'_> {
        Rows::Depths(rows)
    }
}

/// Draws a packet; how many records were handed to tiles.
fn draw<T: Output>(
    packet: &ScenePacket,
    blocks: &Blocks,
    slack_radii: f32,
    output: &mut [T],
) -> u64 {
    let view = PixelView::new(packet);
    let tiles = Tiles::of_picture(packet.viewport_px);
    let drawable = Drawable::of(packet, slack_radii);
    let (scale, margin_px) = match &drawable {
        Drawable::Points(points) => (0.0, 0.5 * points.size_px),
        Drawable::Surfels(surfels) => (surfels.largest_scale(), 0.0),
        Drawable::Cubes(_) | Drawable::Nothing => (1.0, 0.0),
    };
    let lists = blocks.by_tile(&view, tiles, scale, margin_px);
    let held = match (&drawable, packet.settings.splatting) {
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
        are_rays_measured: packet.settings.lighting == Lighting::PerFragment
            && matches!(held, Held::Sums | Held::BlendedColors | Held::SolidColors),
    };
    let level = Level::new();
    let width_px = packet.viewport_px[0] as usize;
    output
        .par_chunks_mut(T::PER_PIXEL * width_px * HEIGHT)
        .enumerate()
        .for_each_init(
            || (Tile::new(), Waiting::new()),
            |(tile, waiting), (row, band)| {
                for column in 0..tiles.columns {
                    dispatch!(level, simd => picture.draw_tile(simd, tile, waiting, [column, row], T::rows(band)));
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
        rows: Rows<'_>,
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
        let width_px = self.view.size_px[0] as usize;
        match rows {
            Rows::Bytes(rows) => tile.finish(simd, clip, self.held, &self.gradient, width_px, rows),
            Rows::Depths(rows) => {
                tile.write_depths(clip, self.held, self.view.near, width_px, rows);
            }
        }
    }
}
