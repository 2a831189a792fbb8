//! Points: pixels, or squares or disks of pixels, of one colour and one depth; or patches that are lit or blended.

mod patches;

use crate::cloud::{PointRecord, ShapeRecord};
use crate::render::constants::SQUARE_REACH_RADII;
use crate::render::cpu::blocks::{Extent, Placed};
use crate::render::cpu::eight::{lane_numbers, lanes_below, words};
use crate::render::cpu::finish::Held;
use crate::render::cpu::records::DrawnRecords;
use crate::render::cpu::sprites::Sprite;
use crate::render::cpu::tile::{LANES, NOWHERE, Tile, WIDTH};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Lighting, PointShape, PointSize, ScenePacket};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, i32x8};
use std::ops::Range;

/// Points of a packet.
pub(in crate::render::cpu) struct Points<'a> {
    pub(super) records: &'a [PointRecord],
    /// Their radii, if known.
    pub(super) shapes: Option<&'a [ShapeRecord]>,
    /// Edges of the squares, or diameters of the disks.
    pub(super) size: PointSize,
    pub(super) shape: PointShape,
    /// None without shapes.
    pub(super) lighting: Lighting,
}

impl Placed for Points<'_> {
    fn len(&self) -> usize {
        let shapes = self.shapes.map_or(usize::MAX, <[_]>::len);
        self.records.len().min(shapes)
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.records[record].position
    }

    fn reach(&self, record: usize) -> f32 {
        // The same as for surfels: blocks that were built for these are valid for points, too.
        let reach = |shapes: &[ShapeRecord]| SQUARE_REACH_RADII * shapes[record].radius;
        self.shapes.map_or(0.0, reach)
    }
}

impl DrawnRecords for Points<'_> {
    type Scratch = ();

    fn held(&self, packet: &ScenePacket) -> Held {
        match self.shape {
            _ if !self.are_patches() => Held::Keys,
            PointShape::Square | PointShape::Disk => Held::surfaces(packet).unwrap_or(Held::SolidColors),
            PointShape::Gaussian => Held::sums(packet),
        }
    }

    fn extent(&self) -> Extent {
        Extent {
            scale: 0.5 * self.size.edge_per_radius,
            margin: 0.5 * self.size.edge,
            margin_px: 0.5 * self.size.min_px,
        }
    }

    /// Draws the points; of two at the same distance the later one is visible.
    #[inline(always)]
    fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>> + Clone,
        (): &mut (),
    ) {
        if self.are_patches() {
            return self.draw_patches(simd, view, tile, clip, &records);
        }
        let are_pixels = self.size.is_pixel();
        for range in records {
            let end = range.end;
            for first in range.step_by(LANES) {
                let eight = first..end.min(first + LANES);
                let count = eight.len();
                let projected = self.project(simd, view, eight);
                if are_pixels {
                    draw_pixels(simd, tile, clip, count, &projected);
                } else {
                    self.draw_sprites(tile, clip, count, &projected);
                }
            }
        }
    }
}

/// Screen positions of eight points.
struct Projected<S: Simd> {
    x_px: f32x8<S>,
    y_px: f32x8<S>,
    /// Reversed depth; not between 0 and 1 where a point is not in front of the near plane.
    depth: f32x8<S>,
    /// Half the edges of squares, or radii of disks.
    half_px: f32x8<S>,
    /// Its bits are a colour.
    color: f32x8<S>,
}

impl<'a> Points<'a> {
    pub(super) const NONE: Self = Self {
        records: &[],
        shapes: None,
        size: PointSize {
            min_px: 1.0,
            edge: 0.0,
            edge_per_radius: 0.0,
        },
        shape: PointShape::Square,
        lighting: Lighting::Unlit,
    };

    pub(super) fn new(packet: &ScenePacket, records: &'a [PointRecord], shapes: Option<&'a [ShapeRecord]>) -> Self {
        Self {
            records,
            shapes,
            size: PointSize::of(packet),
            shape: packet.style.drawn_points().shape,
            lighting: packet.lighting(),
        }
    }

    /// The surface that they show: without light, and their masks as disks.
    pub(super) fn of_surface(self) -> Self {
        Self {
            shape: match self.shape {
                PointShape::Square => PointShape::Square,
                PointShape::Disk | PointShape::Gaussian => PointShape::Disk,
            },
            lighting: Lighting::Unlit,
            ..self
        }
    }

    /// Returns true if the passes of surfels draw them.
    fn are_patches(&self) -> bool {
        self.shape == PointShape::Gaussian || self.lighting != Lighting::Unlit
    }

    /// Half the edges of points in the scene, though it be less than they are drawn with.
    #[inline(always)]
    fn draw_sprites<S: Simd>(&self, tile: &mut Tile, clip: PixelRect, count: usize, projected: &Projected<S>) {
        for point in 0..count {
            let depth = projected.depth[point];
            if !(depth > 0.0 && depth <= 1.0) {
                continue;
            }
            let key = key(depth.to_bits(), projected.color[point].to_bits());
            let sprite = Sprite {
                place_px: [projected.x_px[point], projected.y_px[point]],
                half_px: projected.half_px[point],
                shape: self.shape,
            };
            let [left, top] = tile.origin;
            sprite.for_each_row(
                clip,
                #[inline(always)]
                |y, columns| {
                    let row = (y - top) as usize * WIDTH;
                    for x in columns {
                        put(&mut tile.keys[row + (x - left) as usize], key);
                    }
                },
            );
        }
    }

    #[inline(always)]
    fn half_edges<S: Simd>(&self, simd: S, eight: Range<usize>) -> f32x8<S> {
        match self.shapes {
            None => f32x8::splat(simd, 0.5 * self.size.edge),
            Some(shapes) => {
                let [_, radii, _, _] = words(simd, &shapes[eight]);
                (radii * self.size.edge_per_radius + self.size.edge) * 0.5
            }
        }
    }

    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, view: &PixelView, eight: Range<usize>) -> Projected<S> {
        let [x, y, z, color] = words(simd, &self.records[eight.clone()]);
        let points = view.rotate_each(simd, view.offsets_from_eye(simd, [x, y, z]));
        let per_distance = -1.0 / points.z;
        let px = |along: f32x8<S>, axis: usize| {
            let px = along * per_distance * view.px_per_slope[axis];
            px + view.center_px[axis]
        };
        Projected {
            x_px: px(points.x, 0),
            y_px: px(points.y, 1),
            depth: per_distance * view.near,
            half_px: (self.half_edges(simd, eight) * per_distance * view.px_per_slope[0]).max(0.5 * self.size.min_px),
            color,
        }
    }
}

/// Draws the first ones of eight points.
#[inline(always)]
fn draw_pixels<S: Simd>(simd: S, tile: &mut Tile, clip: PixelRect, count: usize, projected: &Projected<S>) {
    let splat = |value: f32| f32x8::splat(simd, value);
    let zero = splat(0.0);
    let [left, top] = [clip.start[0] as f32, clip.start[1] as f32];
    let [width, height] = [clip.end[0] as f32 - left, clip.end[1] as f32 - top];
    let (x, y) = ((projected.x_px - left).floor(), (projected.y_px - top).floor());
    let are_seen = x.simd_ge(zero)
        & x.simd_lt(splat(width))
        & y.simd_ge(zero)
        & y.simd_lt(splat(height))
        & projected.depth.simd_gt(zero)
        & projected.depth.simd_le(splat(1.0))
        & lanes_below(simd, count);
    if !simd.any_true_mask32x8(are_seen) {
        return;
    }
    // Each lane has its own dummy location: writing to a shared one would have to wait for the previous write.
    let nowhere = lane_numbers(simd) + NOWHERE as f32;
    let places = simd.select_f32x8(are_seen, y.mul_add(splat(WIDTH as f32), x), nowhere);
    let places: i32x8<S> = simd.cvt_i32_f32x8(places);
    let keys = tile.keys.as_mut_slice();
    for lane in 0..LANES {
        let key = key(projected.depth[lane].to_bits(), projected.color[lane].to_bits());
        put(&mut keys[places[lane] as usize], key);
    }
}

/// Depth above colour.
#[inline(always)]
fn key(depth_bits: u32, color_bits: u32) -> u64 {
    // Positive floats have the same order as their bits.
    u64::from(depth_bits) << 32 | u64::from(color_bits)
}

/// Replaces pixels that are behind, or equally far away.
#[inline(always)]
fn put(there: &mut u64, key: u64) {
    // Always written: which of two points is nearer is unpredictable.
    *there = if key >> 32 >= *there >> 32 { key } else { *there };
}
