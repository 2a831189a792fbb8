//! One tile of a byte code: its blocks are decoded, and their nodes laid on its pixels.

use super::blocks::{Block, BlockLists};
use super::code::{Coded, MASK_SLACK};
use super::decode::Decoder;
use super::footprints::Footprints;
use super::masks::{self, Masks};
use super::normals::{self, SeenNormal};
use super::splat::{self, SplatPlacement, WaitingMask};
use super::transform::{Transform, in_view};
use crate::levels::octree::coded::{NodeAttributes, radius_of_code};
use crate::render::cpu::facet::{Canvas, Facet, Outline};
use crate::render::cpu::painter::InTiles;
use crate::render::cpu::raster;
use crate::render::cpu::shading::{Light, Shading, headlight_of_cosine, seen_from_behind, unit_color};
use crate::render::cpu::tile::{HEIGHT, NOWHERE, Tile, WIDTH};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Kernel, Lighting};
use fearless_simd::Simd;
use glam::{Vec3, Vec4};

/// Scratch state that a thread keeps from tile to tile.
#[derive(Default)]
pub(super) struct Waiting {
    decoder: Decoder,
    splats: WaitingSplats,
}

/// Splats that the attribute pass will draw.
#[derive(Default)]
struct WaitingSplats {
    masks: Vec<WaitingMask>,
    disks: Vec<(Facet, Shading)>,
}

/// Everything that tiles are drawn from.
pub(super) struct CodedTiles<'a> {
    pub(super) coded: &'a Coded<'a>,
    pub(super) view: &'a PixelView,
    pub(super) transform: &'a Transform,
    pub(super) blocks: &'a [Block],
    pub(super) lists: &'a BlockLists,
    pub(super) normals: Vec<SeenNormal>,
    /// The normals in the frame.
    pub(super) directions: &'static [Vec3],
    pub(super) footprints: Footprints,
    pub(super) masks: &'static Masks,
    /// Offsets in cell edges, by their codes.
    pub(super) offsets: [f32; 8],
    pub(super) is_depth_only: bool,
    pub(super) lighting: Lighting,
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

impl InTiles for CodedTiles<'_> {
    type Scratch = Waiting;

    #[inline(always)]
    fn draw<S: Simd>(&self, simd: S, tile: &mut Tile, clip: PixelRect, number: usize, waiting: &mut Waiting) {
        let Waiting { decoder, splats } = waiting;
        splats.masks.clear();
        splats.disks.clear();
        for &block in &self.lists.lists[number] {
            let block = &self.blocks[block as usize];
            let (nodes, centers) = decoder.decode(self.coded.cloud, self.transform, block);
            let edge = self.coded.cloud.cube().cell_edge(block.drawn_level);
            let offsets = self.offsets.map(|offset| offset * edge);
            let attributes = &self.coded.cloud.attributes()[nodes];
            for (attributes, &center) in attributes.iter().zip(centers) {
                let Some(node) = self.seen(attributes, center, edge, &offsets) else {
                    continue;
                };
                if self.coded.are_pixels {
                    self.put_pixel(tile, &node);
                } else {
                    self.begin_splat(simd, tile, clip, &node, splats);
                }
            }
        }
        for splat in &splats.masks {
            splat::attribute(self.masks, tile, splat);
        }
        if self.lighting == Lighting::PerFragment && !splats.disks.is_empty() {
            raster::measure_rays(simd, self.view, tile);
        }
        for (facet, shading) in &splats.disks {
            raster::attribute(simd, tile, facet, shading, Kernel::Gaussian);
        }
    }
}

impl CodedTiles<'_> {
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
        tile: &mut Tile,
        clip: PixelRect,
        node: &SeenNode<'_>,
        waiting: &mut WaitingSplats,
    ) {
        let footprint = self.footprints.at(node.normal.class, node.x_px, node.y_px);
        let radius_px = node.radius * node.per_distance * self.view.px_per_slope[0] * footprint.stretch;
        let [visibility, attribute] = self.coded.scales.map(|scale| scale * radius_px);
        // Including the margins of filtering and rounding.
        let reach = MASK_SLACK * visibility.max(attribute) + 2.0;
        let rect = tile.rect();
        let is_outside =
            |px: f32, axis: usize| px + reach < rect.start[axis] as f32 || px - reach > rect.end[axis] as f32;
        if is_outside(node.x_px, 0) || is_outside(node.y_px, 1) {
            return;
        }
        let (Some(visibility_size), Some(attribute_size)) = (masks::size_of(visibility), masks::size_of(attribute))
        else {
            self.begin_disk(simd, tile, clip, node, &mut waiting.disks);
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
        waiting.masks.push(WaitingMask {
            place: self.place(node, [x, y], self.coded.scales[1]),
            mask: *mask,
            color: self.lit_color(node),
        });
    }

    /// Depth in the plane of a splat around the pixel in whose upper left corner `pixel` is.
    #[inline(always)]
    fn place(&self, node: &SeenNode<'_>, [x, y]: [f32; 2], scale: f32) -> SplatPlacement {
        let depth = self.view.near * node.per_distance;
        let reach = (scale * node.radius * node.per_distance).min(1.0);
        // Seen edge-on, the depth of the centre has to do.
        let is_steep = node.facing.abs() < 1e-3 * node.at.z;
        let per_facing = if is_steep { 0.0 } else { self.view.near / node.facing };
        let per_column = node.normal.facing.x * per_facing;
        let per_row = node.normal.facing.y * per_facing;
        let (right, down) = (x + 0.5 - node.x_px, y + 0.5 - node.y_px);
        SplatPlacement {
            pixel: [x as i32, y as i32],
            depth: depth + per_column * right + per_row * down,
            depth_per_px: [per_column, per_row],
            depths: [depth / (1.0 + reach), depth * (1.0 + reach)],
        }
    }

    /// ε-z, as for exact disks: the factor on depths that lets splats of one surface blend.
    #[inline(always)]
    fn push_back(&self, node: &SeenNode<'_>) -> f32 {
        let radius = self.coded.slack_radii * self.coded.scales[0] * node.radius;
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
        let center = in_view(self.view, node.at);
        let light = match self.lighting {
            Lighting::Unlit | Lighting::PerSurfel => Light::Same(node.normal.light),
            // Codes are not drawn with deferred shading.
            Lighting::PerVertex | Lighting::Lambert | Lighting::BlinnPhong | Lighting::Physical => {
                Light::Same(self.light_at(node))
            }
            Lighting::PerFragment => Light::OfPixels,
        };
        let facet = |scale: f32| {
            let (u, v) = (u * (scale * node.radius), v * (scale * node.radius));
            let disk = Canvas {
                view: self.view,
                clip,
                outline: Outline::Disk,
                cull_back_faces: false,
                min_reach_px: 0.0,
            };
            Facet::of_patch(simd, &disk, [center, u, v])
        };
        let [visibility, attribute] = self.coded.scales;
        if let Some(facet) = facet(visibility) {
            raster::visibility(simd, tile, &facet, self.push_back(node), Outline::Disk);
        }
        if !self.is_depth_only
            && let Some(facet) = facet(attribute)
        {
            let shading = Shading {
                color: self.color_of(node),
                light,
                weight: 1.0,
                normal: None,
            };
            waiting.push((facet, shading));
        }
    }

    /// Computes the headlight at a node. If it is requested per surfel, it depends on the normal alone, from infinity;
    /// else on the ray as well.
    #[inline(always)]
    fn light_at(&self, node: &SeenNode<'_>) -> [f32; 2] {
        if matches!(self.lighting, Lighting::Unlit | Lighting::PerSurfel) {
            return node.normal.light;
        }
        let right = (node.x_px - self.view.center_px[0]) / self.view.px_per_slope[0];
        let down = (node.y_px - self.view.center_px[1]) / self.view.px_per_slope[1];
        let ray = (1.0 + right * right + down * down).sqrt();
        headlight_of_cosine(node.facing.abs() * node.per_distance / ray)
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
        // Positive floats have the same order as their bits.
        let depth = self.view.near * node.per_distance;
        let key = u64::from(depth.to_bits()) << 32 | u64::from(color);
        let there = &mut tile.keys[place];
        *there = (*there).max(key);
    }
}
