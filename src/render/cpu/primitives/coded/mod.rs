//! Surfels drawn straight from the byte code of an octree (paper 001).
//!
//! How it works: the tree is gone through once for blocks (`blocks.rs`); then each tile decodes the blocks that may
//! touch it, level by level, adding the image of a vector for each node (`transform.rs`), looks up the normal as it is
//! seen, its light and its class (`normals.rs`), drops what faces away before any division, moves it along its normal
//! by its offset, and lays the mask of its shape, size and place (`footprints.rs`, `masks.rs`) on the pixels
//! (`splat.rs`). ε-z accumulation and normalisation are those of the exact disks: depths pushed back by a radius, then
//! weighted sums of what is not behind them.
//!
//! Splats too large for masks are drawn as exact disks: there the lookup saves nothing, as the pixels are what costs.
//!
//! When it wins: many splats of a few pixels. What it costs: quantised normals (13 bits and 9 for shapes), places
//! within a pixel, sizes and light for one direction; `benches/coded_render.rs` says how much of both.

mod blocks;
mod decode;
mod footprints;
#[cfg(test)]
mod light_tests;
mod masks;
mod normals;
mod splat;
#[cfg(test)]
mod tests;
mod transform;

use crate::cloud::{largest_normal_error, quantised_normals};
use crate::levels::octree::CodedCloud;
use crate::levels::octree::coded::{NodeAttributes, offset_of_code, radius_of_code};
use crate::render::DEPTH_SLACK_RADII;
use crate::render::cpu::Rows;
use crate::render::cpu::facet::{Facet, Outline};
use crate::render::cpu::finish::{Gradient, Held};
use crate::render::cpu::raster;
use crate::render::cpu::shading::{
    Light, Shading, head_light_of_cosine, seen_from_behind, unit_color,
};
use crate::render::cpu::tile::{HEIGHT, NOWHERE, Tile, Tiles, WIDTH};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Footprint, Lighting, ScenePacket, Splatting};
use blocks::{Block, Traversal};
use decode::Decoder;
use fearless_simd::{Level, Simd, dispatch};
use footprints::Footprints;
use glam::{Vec3, Vec4};
use masks::{MASKS, Masks};
use normals::SeenNormal;
use rayon::prelude::*;
use splat::{Place, WaitingMask};
use transform::{Transform, in_view};

/// What masks may be larger than the splats they stand for: sizes are rounded, and so is where they are seen.
const MASK_SLACK: f32 = 1.2;

/// A byte code, and how it is drawn.
#[derive(Debug, Clone, Copy)]
struct Coded<'a> {
    cloud: &'a CodedCloud,
    lod_px: f32,
    deepest_level: u32,
    cull_back_faces: bool,
    darkens_back_faces: bool,
    /// Whether each node is a pixel, not a mask.
    are_pixels: bool,
    normal_bits: u32,
    offset_bits: u32,
    /// Factors on radii in the visibility and in the attribute pass.
    scales: [f32; 2],
}

impl<'a> Coded<'a> {
    /// The code of a packet, if it is to be drawn.
    fn of(packet: &'a ScenePacket) -> Option<Self> {
        let settings = &packet.settings;
        let coded = packet.content.coded()?;
        let scales = settings
            .surfels
            .splatting
            .scales(settings.surfels.enlargement);
        Some(Self {
            cloud: &coded.cloud,
            lod_px: coded.lod_px,
            deepest_level: coded.deepest_level,
            cull_back_faces: settings.culls_back_faces(),
            darkens_back_faces: settings.darkens_back_faces(),
            are_pixels: settings.codes.footprint == Footprint::Pixels,
            normal_bits: settings.codes.normal_bits.bits(),
            offset_bits: settings.codes.offset_bits.bits(),
            scales: scales.map(|scale| scale * settings.surfels.splat_scale),
        })
    }

    /// How far splats reach, in their radii.
    fn largest_scale(&self) -> f32 {
        if self.are_pixels {
            return 0.0;
        }
        MASK_SLACK * self.scales[0].max(self.scales[1])
    }

    /// How far what is drawn reaches from its cell on every level and those below it, in scene units.
    fn reaches(&self) -> Vec<f32> {
        let mut farthest = 0f32;
        let mut reaches: Vec<f32> = (0..=self.cloud.depth())
            .rev()
            .map(|level| {
                let radius = self.largest_scale() * self.cloud.largest_radius(level);
                farthest = farthest.max(radius + self.cloud.cube().cell_edge(level));
                farthest
            })
            .collect();
        reaches.reverse();
        reaches
    }
}

/// Draws the byte code of a packet, if it is to be drawn; how many nodes were drawn, in blocks that may be seen.
pub(in crate::render::cpu) fn draw(packet: &ScenePacket, bands: Vec<Rows<'_>>) -> u64 {
    let Some(coded) = Coded::of(packet) else {
        return 0;
    };
    let view = PixelView::new(packet);
    let tiles = Tiles::of_picture(packet.viewport_px);
    let transform = Transform::new(&view, &coded.cloud.cube());
    let normal_error = largest_normal_error(coded.normal_bits);
    let reaches = coded.reaches();
    let traversal = Traversal::new(&coded, &view, &transform, &reaches, normal_error);
    let blocks = traversal.blocks();
    let lists = traversal.by_tile(&blocks, tiles);
    let held = match packet.settings.surfels.splatting {
        _ if coded.are_pixels => Held::Keys,
        Splatting::Visibility => Held::depths(packet),
        _ => Held::Sums,
    };
    let picture = Picture {
        is_depth_only: packet.settings.surfels.splatting == Splatting::Visibility,
        lighting: packet.settings.light.lighting,
        normals: normals::seen(packet, &view, coded.normal_bits),
        directions: quantised_normals(coded.normal_bits),
        footprints: Footprints::new(&view),
        masks: &MASKS,
        offsets: std::array::from_fn(|code| offset_of_code(code, coded.offset_bits)),
        blocks,
        lists,
        held,
        gradient: Gradient::of(packet),
        coded,
        view,
        tiles,
        transform,
    };
    let level = Level::new();
    bands.into_par_iter().enumerate().for_each_init(
        || (Canvas::new(), Decoder::default()),
        |(canvas, decoder), (row, mut band)| {
            for column in 0..tiles.columns {
                dispatch!(level, simd => picture.draw_tile(simd, canvas, decoder, [column, row], &mut band));
            }
        },
    );
    let nodes = |block: &Block| block.nodes(picture.coded.cloud).len() as u64;
    picture.blocks.iter().map(nodes).sum()
}

/// What a thread draws with.
struct Canvas {
    tile: Tile,
    /// What the attribute pass will draw.
    masks: Vec<WaitingMask>,
    disks: Vec<(Facet, Shading)>,
}

impl Canvas {
    fn new() -> Self {
        Self {
            tile: Tile::new(),
            masks: Vec::new(),
            disks: Vec::new(),
        }
    }
}

/// Everything that a tile is drawn from.
struct Picture<'a> {
    coded: Coded<'a>,
    view: PixelView,
    tiles: Tiles,
    transform: Transform,
    blocks: Vec<Block>,
    lists: blocks::BlockLists,
    normals: Vec<SeenNormal>,
    /// The normals in the frame.
    directions: &'static [Vec3],
    footprints: Footprints,
    masks: &'static Masks,
    /// Offsets in cell edges, by their codes.
    offsets: [f32; 8],
    held: Held,
    is_depth_only: bool,
    lighting: Lighting,
    gradient: Gradient,
}

/// A node that faces the eye.
struct SeenNode<'a> {
    attributes: &'a NodeAttributes,
    normal: &'a SeenNormal,
    /// Pixels times distance of where its splat is.
    at: Vec4,
    x_px: f32,
    y_px: f32,
    per_distance: f32,
    /// The product of its normal and the vector from the eye to it.
    facing: f32,
    /// In scene units.
    radius: f32,
}

impl Picture<'_> {
    /// Draws a tile, and writes it to its place in a band of the picture.
    #[inline(always)]
    fn draw_tile<S: Simd>(
        &self,
        simd: S,
        canvas: &mut Canvas,
        decoder: &mut Decoder,
        [column, row]: [usize; 2],
        rows: &mut Rows<'_>,
    ) {
        let origin = [(WIDTH * column) as i32, (HEIGHT * row) as i32];
        canvas.tile.begin(origin, self.held, &self.gradient);
        canvas.masks.clear();
        canvas.disks.clear();
        let picture = PixelRect::of_picture(self.view.size_px);
        let clip = canvas.tile.rect().intersection(picture);
        for &block in &self.lists.lists[self.tiles.columns * row + column] {
            let block = &self.blocks[block as usize];
            let (nodes, centers) = decoder.decode(self.coded.cloud, &self.transform, block);
            let edge = self.coded.cloud.cube().cell_edge(block.drawn_level);
            let offsets = self.offsets.map(|offset| offset * edge);
            let attributes = &self.coded.cloud.attributes()[nodes];
            for (attributes, &center) in attributes.iter().zip(centers) {
                let Some(node) = self.seen(attributes, center, edge, &offsets) else {
                    continue;
                };
                if self.coded.are_pixels {
                    self.put_pixel(&mut canvas.tile, &node);
                } else {
                    self.begin_splat(simd, canvas, clip, &node);
                }
            }
        }
        for splat in &canvas.masks {
            splat::attribute(self.masks, &mut canvas.tile, splat);
        }
        if self.lighting == Lighting::PerFragment && !canvas.disks.is_empty() {
            raster::measure_rays(simd, &self.view, &mut canvas.tile);
        }
        for (facet, shading) in &canvas.disks {
            raster::attribute(simd, &mut canvas.tile, facet, shading);
        }
        canvas
            .tile
            .write(simd, &self.view, self.held, &self.gradient, rows);
    }

    /// A node at its place, unless it faces away or is not beyond the near plane.
    #[inline(always)]
    fn seen<'b>(
        &'b self,
        attributes: &'b NodeAttributes,
        center: Vec4,
        edge: f32,
        offsets: &[f32; 8],
    ) -> Option<SeenNode<'b>> {
        let normal = normals::entry(&self.normals, attributes.normal(), self.coded.normal_bits);
        let facing = normal.facing.dot(center);
        if facing >= 0.0 && self.coded.cull_back_faces {
            return None;
        }
        let offset = offsets[attributes.offset_code()];
        let at = center + normal.image * offset;
        if at.z <= self.view.near || at.z.is_nan() {
            return None;
        }
        let per_distance = 1.0 / at.z;
        Some(SeenNode {
            attributes,
            normal,
            at,
            x_px: at.x * per_distance,
            y_px: at.y * per_distance,
            per_distance,
            facing: facing + offset,
            radius: radius_of_code(attributes.radius_code()) * edge,
        })
    }

    /// The visibility pass over a splat, which is then noted for the attribute pass.
    #[inline(always)]
    fn begin_splat<S: Simd>(
        &self,
        simd: S,
        canvas: &mut Canvas,
        clip: PixelRect,
        node: &SeenNode<'_>,
    ) {
        let tile = &mut canvas.tile;
        let footprint = self.footprints.at(node.normal.class, node.x_px, node.y_px);
        let radius_px =
            node.radius * node.per_distance * self.view.px_per_slope[0] * footprint.stretch;
        let [visibility, attribute] = self.coded.scales.map(|scale| scale * radius_px);
        // With what filtering and rounding may add.
        let reach = MASK_SLACK * visibility.max(attribute) + 2.0;
        let rect = tile.rect();
        let is_beside = |px: f32, axis: usize| {
            px + reach < rect.start[axis] as f32 || px - reach > rect.end[axis] as f32
        };
        if is_beside(node.x_px, 0) || is_beside(node.y_px, 1) {
            return;
        }
        let (Some(visibility_size), Some(attribute_size)) =
            (masks::size_of(visibility), masks::size_of(attribute))
        else {
            self.begin_disk(simd, tile, clip, node, &mut canvas.disks);
            return;
        };
        let (x, y) = (node.x_px.floor(), node.y_px.floor());
        let fraction = [node.x_px - x, node.y_px - y];
        let place = self.place(node, [x, y], self.coded.scales[0]);
        let mask = self.masks.get(footprint.shape, visibility_size, fraction);
        splat::visibility(self.masks, tile, mask, &place, self.push_back(node));
        if self.is_depth_only {
            return;
        }
        let mask = self.masks.get(footprint.shape, attribute_size, fraction);
        canvas.masks.push(WaitingMask {
            place: self.place(node, [x, y], self.coded.scales[1]),
            mask: *mask,
            color: self.lit_color(node),
        });
    }

    /// Depth in the plane of a splat around the pixel in whose upper left corner `pixel` is.
    #[inline(always)]
    fn place(&self, node: &SeenNode<'_>, [x, y]: [f32; 2], scale: f32) -> Place {
        let depth = self.view.near * node.per_distance;
        let reach = (scale * node.radius * node.per_distance).min(1.0);
        // Seen edge on, the depth of the middle has to do.
        let is_steep = node.facing.abs() < 1e-3 * node.at.z;
        let per_facing = if is_steep {
            0.0
        } else {
            self.view.near / node.facing
        };
        let per_column = node.normal.facing.x * per_facing;
        let per_row = node.normal.facing.y * per_facing;
        let (right, down) = (x + 0.5 - node.x_px, y + 0.5 - node.y_px);
        Place {
            pixel: [x as i32, y as i32],
            depth: depth + per_column * right + per_row * down,
            depth_per_px: [per_column, per_row],
            depths: [depth / (1.0 + reach), depth * (1.0 + reach)],
        }
    }

    /// ε-z, as for exact disks: the factor on depths that leaves room for splats of one surface to blend.
    #[inline(always)]
    fn push_back(&self, node: &SeenNode<'_>) -> f32 {
        let radius = DEPTH_SLACK_RADII * self.coded.scales[0] * node.radius;
        1.0 / (1.0 + radius * node.per_distance)
    }

    /// The visibility pass over a splat as an exact disk.
    #[inline(always)]
    fn begin_disk<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        clip: PixelRect,
        node: &SeenNode<'_>,
        waiting: &mut Vec<(Facet, Shading)>,
    ) {
        let index = crate::cloud::coarser_normal(node.attributes.normal(), self.coded.normal_bits);
        let normal = self.view.rotate(self.directions[index as usize]);
        let (u, v) = normal.any_orthonormal_pair();
        let center = in_view(&self.view, node.at);
        let light = match self.lighting {
            Lighting::Unlit | Lighting::PerSurfel => Light::Same(node.normal.light),
            Lighting::PerVertex => Light::Same(self.light_at(node)),
            Lighting::PerFragment => Light::OfPixels,
        };
        let facet = |scale: f32| {
            let (u, v) = (u * (scale * node.radius), v * (scale * node.radius));
            let disk = crate::render::cpu::facet::Canvas {
                view: &self.view,
                clip,
                outline: Outline::Disk,
                cull_back_faces: false,
            };
            Facet::of_patch(simd, &disk, [center, u, v])
        };
        let [visibility, attribute] = self.coded.scales;
        if let Some(facet) = facet(visibility) {
            raster::visibility(simd, tile, &facet, self.push_back(node));
        }
        if !self.is_depth_only
            && let Some(facet) = facet(attribute)
        {
            let shading = Shading {
                color: self.color_of(node),
                light,
            };
            waiting.push((facet, shading));
        }
    }

    /// The head light at a node. Where it is asked for at surfels, it is that of the normal, from infinity; else of the
    /// ray as well.
    #[inline(always)]
    fn light_at(&self, node: &SeenNode<'_>) -> [f32; 2] {
        if matches!(self.lighting, Lighting::Unlit | Lighting::PerSurfel) {
            return node.normal.light;
        }
        let right = (node.x_px - self.view.middle_px[0]) / self.view.px_per_slope[0];
        let down = (node.y_px - self.view.middle_px[1]) / self.view.px_per_slope[1];
        let ray = (1.0 + right * right + down * down).sqrt();
        head_light_of_cosine(node.facing.abs() * node.per_distance / ray)
    }

    /// The colour of a node without light, 0 to 1.
    #[inline(always)]
    fn color_of(&self, node: &SeenNode<'_>) -> [f32; 3] {
        let color = unit_color(node.attributes.color);
        if node.facing >= 0.0 && self.coded.darkens_back_faces {
            seen_from_behind(color)
        } else {
            color
        }
    }

    /// The colour of a node with its light, 0 to 1.
    #[inline(always)]
    fn lit_color(&self, node: &SeenNode<'_>) -> [f32; 3] {
        let [factor, white] = self.light_at(node);
        let [red, green, blue] = self.color_of(node);
        let lit = |channel: f32| (channel * factor + white).min(1.0);
        [lit(red), lit(green), lit(blue)]
    }

    /// Draws a node as the pixel that it is in, unless something nearer is there.
    #[inline(always)]
    fn put_pixel(&self, tile: &mut Tile, node: &SeenNode<'_>) {
        let x = node.x_px - tile.origin[0] as f32;
        let y = node.y_px - tile.origin[1] as f32;
        let is_inside = x >= 0.0 && x < WIDTH as f32 && y >= 0.0 && y < HEIGHT as f32;
        if !is_inside {
            return;
        }
        let place = (y as usize * WIDTH + x as usize).min(NOWHERE);
        let byte = |channel: f32| (channel * 255.0 + 0.5) as u32;
        let [red, green, blue] = self.lit_color(node);
        let color = byte(red) | byte(green) << 8 | byte(blue) << 16;
        // The bits of positive numbers are in their order.
        let depth = self.view.near * node.per_distance;
        let key = u64::from(depth.to_bits()) << 32 | u64::from(color);
        let there = &mut tile.keys[place];
        *there = (*there).max(key);
    }
}
