//! Points: pixels, or squares of pixels, of one colour and one depth.

use super::blocks::{BLOCK, Placed};
use super::tile::{NOWHERE, Tile, WIDTH};
use super::view::{PixelRect, PixelView};
use crate::cloud::PointRecord;
use std::ops::Range;

/// Points of a packet.
pub(super) struct Points<'a> {
    pub(super) records: &'a [PointRecord],
    /// Edge of the squares.
    pub(super) size_px: f32,
}

impl Placed for Points<'_> {
    fn len(&self) -> usize {
        self.records.len()
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.records[record].position
    }

    fn reach(&self, _: usize) -> f32 {
        0.0
    }
}

/// Where points are on the screen. Each property in an array of its own, so that registers are filled with neighbours.
struct Projected {
    x_px: [f32; BLOCK],
    y_px: [f32; BLOCK],
    /// Reversed depth; negative behind the eye.
    depth: [f32; BLOCK],
}

impl Points<'_> {
    pub(super) const NONE: Self = Self {
        records: &[],
        size_px: 1.0,
    };

    /// Draws those of some records that touch a tile. Of two as far away the later one is seen.
    #[inline(always)]
    pub(super) fn draw(
        &self,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>>,
    ) {
        for range in records {
            let records = &self.records[range];
            let projected = project(view, records);
            if self.size_px <= 1.0 {
                draw_pixels(tile, clip, records, &projected);
            } else {
                self.draw_squares(tile, clip, records, &projected);
            }
        }
    }

    #[inline(always)]
    fn draw_squares(
        &self,
        tile: &mut Tile,
        clip: PixelRect,
        records: &[PointRecord],
        projected: &Projected,
    ) {
        let half = 0.5 * self.size_px;
        for (point, record) in records.iter().enumerate() {
            let depth = projected.depth[point];
            if !is_in_front(depth) {
                continue;
            }
            let key = key(depth, record);
            // Pixels whose middles are within.
            let range = |middle: f32, axis: usize| {
                let [start, end] =
                    [middle - half, middle + half].map(|end| (end - 0.5).ceil() as i32);
                start.max(clip.start[axis])..end.min(clip.end[axis])
            };
            let columns = range(projected.x_px[point], 0);
            for y in range(projected.y_px[point], 1) {
                let row = (y - tile.origin[1]) as usize * WIDTH;
                for x in columns.clone() {
                    put(&mut tile.keys[row + (x - tile.origin[0]) as usize], key);
                }
            }
        }
    }
}

#[inline(always)]
#[expect(
    clippy::needless_bitwise_bool,
    reason = "without branches many points are worked out at a time"
)]
fn draw_pixels(tile: &mut Tile, clip: PixelRect, records: &[PointRecord], projected: &Projected) {
    let [left, top] = [clip.start[0] as f32, clip.start[1] as f32];
    let [width, height] = [clip.end[0] as f32 - left, clip.end[1] as f32 - top];
    // Worked out for all points before any is drawn: without branches, many at a time.
    let mut places = [0; BLOCK];
    let points = projected
        .x_px
        .iter()
        .zip(&projected.y_px)
        .zip(&projected.depth);
    for (place, ((&x_px, &y_px), &depth)) in places.iter_mut().zip(points) {
        let (x, y) = ((x_px - left).floor(), (y_px - top).floor());
        let is_seen = (x >= 0.0) & (x < width) & (y >= 0.0) & (y < height) & is_in_front(depth);
        let exact = if is_seen {
            y * WIDTH as f32 + x
        } else {
            NOWHERE as f32
        };
        // At 2²³ the last bit of an f32 is worth 1: a conversion in one addition.
        *place = (exact + 8_388_608.0).to_bits() & 0xffff;
    }
    for ((record, &place), &depth) in records.iter().zip(&places).zip(&projected.depth) {
        put(&mut tile.keys[place as usize], key(depth, record));
    }
}

fn is_in_front(depth: f32) -> bool {
    depth > 0.0 && depth <= 1.0
}

/// Depth above colour.
#[inline(always)]
fn key(depth: f32, record: &PointRecord) -> u64 {
    // The bits of positive numbers are in their order.
    u64::from(depth.to_bits()) << 32 | u64::from(u32::from_le_bytes(record.color))
}

/// Replaces what is behind, or as far away.
#[inline(always)]
fn put(there: &mut u64, key: u64) {
    // Written in any case: which of two points is nearer nobody can foresee.
    *there = if key >> 32 >= *there >> 32 {
        key
    } else {
        *there
    };
}

#[inline(always)]
fn project(view: &PixelView, records: &[PointRecord]) -> Projected {
    let mut projected = Projected {
        x_px: [0.0; BLOCK],
        y_px: [0.0; BLOCK],
        depth: [0.0; BLOCK],
    };
    let places = projected.x_px.iter_mut().zip(&mut projected.y_px);
    let places = places.zip(&mut projected.depth);
    for (record, ((x_px, y_px), depth)) in records.iter().zip(places) {
        let point = view.rotate(view.offset_from_eye(record.position));
        let per_distance = -1.0 / point.z;
        *x_px = view.middle_px[0] + point.x * per_distance * view.px_per_slope[0];
        *y_px = view.middle_px[1] + point.y * per_distance * view.px_per_slope[1];
        *depth = view.near * per_distance;
    }
    projected
}
