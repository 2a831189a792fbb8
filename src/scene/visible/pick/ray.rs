//! A ray through a pixel, and its hits of a packet.

use crate::scene::ScenePacket;
use glam::{DMat3, DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of records of a block.
// With boxes, 1,000,000 points take 2.0 to 2.7 ms, surfels 3.5 to 5.0 ms; one read of all positions takes 1.7 ms
// (development build, two busy cores).
const BLOCK: usize = 64;

/// Blocks that are worth handing to another thread.
const BLOCKS_PER_TASK: usize = 256;

/// Ray from the eye through the centre of a pixel, `t · (slope, −1)` in view space.
pub(super) struct Ray {
    view_from_frame: DMat3,
    frame_from_view: DMat3,
    /// In the space of the frame.
    eye: DVec3,
    slope: DVec2,
    /// Pixels to the right and upwards for a slope of 1.
    px_per_slope: DVec2,
    near: f64,
}

/// A record that the ray meets, or comes near to.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayHit {
    pub(super) record: usize,
    /// Hit position, or the record's centre if it is not hit, in the space of the frame.
    pub(super) place: DVec3,
    /// Depth of that position from the eye along the view, scene units.
    depth: f64,
    /// Blending slack: records farther away by at most this are blended with it.
    slack: f64,
    /// From its outline to the pixel; `None` where it covers it.
    miss_px: Option<f64>,
    /// Offset of the ray from its centre, in a measure of its own.
    aside: f64,
}

/// Records of one kind.
pub(super) trait Drawn: Sync {
    fn len(&self) -> usize;
    fn position(&self, record: usize) -> Vec3;
    /// Returns the reach of a record: how far it extends from its position, scene units.
    fn reach(&self, record: usize) -> f64;
    /// Returns the additional reach in pixels.
    fn reach_px(&self) -> f64;
    /// Returns true if the record faces the eye: it can be seen from there, at an offset from it.
    fn faces_eye(&self, record: usize, offset: DVec3) -> bool;
    /// Returns the intersection of the ray with a record at an offset from the eye.
    fn meet(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Met>;
    /// Returns the distance from the pixel of a record that the ray does not hit; `None` if that is not in the image.
    fn miss(&self, ray: &Ray, record: usize, offset: DVec3) -> Option<Miss> {
        let (depth, aside_px) = ray.project(offset)?;
        let aside_px = aside_px.length();
        let reach_px = self.reach_px() + ray.length_px(self.reach(record), depth);
        Some(Miss {
            depth,
            aside_px,
            outline_px: (aside_px - reach_px).max(0.0),
        })
    }
}

/// Distance of a record from a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Miss {
    /// Depth of its centre from the eye along the view, scene units.
    pub(super) depth: f64,
    /// Distance from its centre.
    pub(super) aside_px: f64,
    /// From its outline.
    pub(super) outline_px: f64,
}

/// Intersection of a ray with a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Met {
    /// As the ray's `t`.
    pub(super) depth: f64,
    /// As [`RayHit::slack`].
    pub(super) slack: f64,
    /// As [`RayHit::aside`].
    pub(super) aside: f64,
}

impl Ray {
    pub(super) fn new(packet: &ScenePacket, place_px: [f64; 2]) -> Self {
        let view = &packet.view;
        let [width, height] = packet.viewport_px.map(f64::from);
        let half_size = 0.5 * DVec2::new(width, height);
        let [focal, center] = [view.focal, view.center_ndc].map(|pair| DVec2::from_array(pair.map(f64::from)));
        let px_per_slope = half_size * focal;
        let center_px = |place_px: f64| place_px.floor() + 0.5;
        let view_from_frame = view.view_from_frame_rotation.as_dmat3();
        Self {
            view_from_frame,
            frame_from_view: view_from_frame.inverse(),
            eye: view.eye_high.as_dvec3() + view.eye_low.as_dvec3(),
            slope: (DVec2::new(
                center_px(place_px[0]) - half_size.x,
                half_size.y - center_px(place_px[1]),
            ) - center * half_size)
                / px_per_slope,
            px_per_slope,
            near: f64::from(view.near),
        }
    }

    /// In the axes of the frame, as long as it takes for a depth of 1.
    pub(super) fn direction(&self) -> DVec3 {
        self.frame_from_view * self.slope.extend(-1.0)
    }

    /// Returns the depth of a position in the space of the frame, from the eye along the view, scene units.
    pub(super) fn depth_of(&self, place: DVec3) -> f64 {
        -(self.view_from_frame * (place - self.eye)).z
    }

    /// The record whose colour the pixel mostly has; if it has none, the nearest one in the image.
    pub(super) fn choose(&self, records: &impl Drawn, radius_px: f64) -> Option<RayHit> {
        let seen: Vec<RayHit> = (0..records.len().div_ceil(BLOCK))
            .into_par_iter()
            .with_min_len(BLOCKS_PER_TASK)
            .flat_map_iter(|block| self.look_at_block(records, block, radius_px))
            .collect();
        let met = seen.iter().filter(|seen| seen.miss_px.is_none());
        let backmost = met.clone().map(|seen| seen.depth + seen.slack).reduce(f64::min);
        // Of equals the last: later records are drawn over equally near ones.
        match backmost {
            Some(backmost) => met
                .rev()
                .filter(|seen| seen.depth <= backmost)
                .min_by(|a, b| {
                    let apart = a.aside.total_cmp(&b.aside);
                    apart.then(a.depth.total_cmp(&b.depth))
                })
                .copied(),
            None => seen.into_iter().rev().min_by(|a, b| {
                let [miss_a, miss_b] = [a, b].map(|seen| seen.miss_px.unwrap_or(0.0));
                let apart = miss_a.total_cmp(&miss_b);
                let apart = apart.then(a.aside.total_cmp(&b.aside));
                apart.then(a.depth.total_cmp(&b.depth))
            }),
        }
    }

    fn look_at_block(&self, records: &impl Drawn, block: usize, radius_px: f64) -> Vec<RayHit> {
        let range = BLOCK * block..records.len().min(BLOCK * (block + 1));
        if !self.may_meet_block(records, range.clone(), radius_px) {
            return Vec::new();
        }
        range
            .filter_map(|record| self.look_at(records, record, radius_px))
            .collect()
    }

    /// [`Ray::may_meet`] for the box around the records of a block.
    fn may_meet_block(&self, records: &impl Drawn, range: Range<usize>, radius_px: f64) -> bool {
        let (mut low, mut high, mut reach) = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0f64);
        for record in range {
            let position = records.position(record);
            low = low.min(position);
            high = high.max(position);
            reach = reach.max(records.reach(record));
        }
        self.may_meet(low, high, reach, radius_px + records.reach_px())
    }

    /// Returns the number of pixels that a length across the view covers at a depth.
    pub(super) fn length_px(&self, length: f64, depth: f64) -> f64 {
        length / depth * self.px_per_slope.y
    }

    /// Returns the number of pixels that a length covers at the depth of the nearest point that is as far from `center`
    /// as half of it; infinite if that is behind the near plane.
    pub(super) fn size_px(&self, center: Vec3, length: f32) -> f64 {
        let place = self.view_from_frame * (center.as_dvec3() - self.eye);
        let half = self.view_from_frame.abs() * DVec3::splat(0.5 * f64::from(length));
        let nearest = -place.z - half.z;
        if nearest <= self.near {
            return f64::INFINITY;
        }
        self.length_px(f64::from(length), nearest)
    }

    /// False if nothing that is in a box, or reaches beyond it, comes nearer to the pixel than a radius.
    pub(super) fn may_meet(&self, low: Vec3, high: Vec3, reach: f64, radius_px: f64) -> bool {
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let midpoint = self.view_from_frame * (0.5 * (low + high) - self.eye);
        let half = self.view_from_frame.abs() * (0.5 * (high - low));
        let farthest = half.z - midpoint.z;
        // Allows for rounding.
        let slack = 1e-9 * (midpoint.length() + half.length() + reach);
        let widening = radius_px / self.px_per_slope.min_element() * farthest;
        let is_near = |axis: usize| {
            let slope = self.slope[axis];
            let aside = (midpoint[axis] + slope * midpoint.z).abs();
            let space = half[axis] + slope.abs() * half.z;
            aside <= space + widening + reach * slope.hypot(1.0) + slack
        };
        farthest + reach >= self.near && is_near(0) && is_near(1)
    }

    fn look_at(&self, records: &impl Drawn, record: usize, radius_px: f64) -> Option<RayHit> {
        let offset = records.position(record).as_dvec3() - self.eye;
        if !records.faces_eye(record, offset) {
            return None;
        }
        let met = records.meet(self, record, offset);
        if let Some(met) = met.filter(|met| met.depth >= self.near) {
            return Some(RayHit {
                record,
                place: self.eye + met.depth * self.direction(),
                depth: met.depth,
                slack: met.slack,
                miss_px: None,
                aside: met.aside,
            });
        }
        let miss = records.miss(self, record, offset)?;
        (miss.outline_px < radius_px).then(|| RayHit {
            record,
            place: self.eye + offset,
            depth: miss.depth,
            slack: 0.0,
            miss_px: Some(miss.outline_px),
            aside: miss.aside_px,
        })
    }

    /// The depth of an offset from the eye, and how far it is from the pixel; `None` behind the near plane.
    pub(super) fn project(&self, offset: DVec3) -> Option<(f64, DVec2)> {
        let place = self.view_from_frame * offset;
        let depth = -place.z;
        (depth >= self.near).then(|| {
            let aside = place.truncate() / depth - self.slope;
            (depth, aside * self.px_per_slope)
        })
    }
}
