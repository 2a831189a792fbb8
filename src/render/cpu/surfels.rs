//! Surfels in the six modes of paper 000, Fig. 3.

use super::blocks::Placed;
use super::facet::{Facet, Outline, Patch};
use super::raster;
use super::shading::{Light, Shading, unit_color};
use super::tile::Tile;
use super::view::{PixelRect, PixelView};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode};
use crate::scene::{Lighting, Settings, Splatting};
use fearless_simd::Simd;
use glam::Vec3;
use std::ops::Range;

/// Surfels of a packet, and how they are drawn.
pub(super) struct Surfels<'a> {
    pub(super) points: &'a [PointRecord],
    pub(super) shapes: &'a [ShapeRecord],
    pub(super) settings: &'a Settings,
    /// How far the visibility pass is pushed back, in splat radii.
    pub(super) slack_radii: f32,
}

/// A splat of the attribute pass that waits for the visibility pass to end.
pub(super) type Waiting = Vec<(Facet, Shading)>;

impl Placed for Surfels<'_> {
    fn len(&self) -> usize {
        self.points.len().min(self.shapes.len())
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.points[record].position
    }

    fn reach(&self, record: usize) -> f32 {
        // The corner of the square.
        std::f32::consts::SQRT_2 * self.shapes[record].radius
    }
}

/// A surfel as seen from the eye.
struct Seen {
    center: Vec3,
    normal: Vec3,
    /// Directions of its edges.
    u: Vec3,
    v: Vec3,
    radius: f32,
}

impl Surfels<'_> {
    /// Factors on the radii of what is drawn at most.
    pub(super) fn largest_scale(&self) -> f32 {
        let [visibility, attribute] = self.settings.splatting.scales(self.settings.enlargement);
        visibility.max(attribute) * self.settings.splat_scale
    }

    /// Draws those of some records that touch a tile: all passes over them but the last, over the picture.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>>,
        waiting: &mut Waiting,
    ) {
        let [visibility, attribute] = self.settings.splatting.scales(self.settings.enlargement);
        let scale = self.settings.splat_scale;
        let facet = |seen: &Seen, scale: f32, outline| {
            let cull_back_faces = self.settings.cull_back_faces;
            Facet::new(view, clip, seen.patch(scale), outline, cull_back_faces)
        };
        waiting.clear();
        let largest_scale = self.largest_scale();
        for record in records.flatten() {
            let offset = view.offset_from_eye(self.points[record].position);
            let center = view.rotate(offset);
            if !view.may_touch(clip, center, largest_scale * self.reach(record)) {
                continue;
            }
            let seen = self.seen(view, record, center);
            match self.settings.splatting {
                Splatting::Regular | Splatting::NoDepth => {
                    if let Some(facet) = facet(&seen, scale, Outline::Parallelogram) {
                        let shading = self.shading(record, &seen, scale);
                        let with_depth = self.settings.splatting == Splatting::Regular;
                        raster::over(simd, view, tile, &facet, &shading, with_depth);
                    }
                }
                Splatting::Visibility
                | Splatting::TwoPass
                | Splatting::Enlarged
                | Splatting::TwoPassEnlarged => {
                    if let Some(facet) = facet(&seen, scale * visibility, Outline::Disk) {
                        let push_back = seen.push_back(view, self.slack_radii, scale * visibility);
                        raster::visibility(simd, tile, &facet, push_back);
                    }
                    if self.settings.splatting != Splatting::Visibility
                        && let Some(facet) = facet(&seen, scale * attribute, Outline::Disk)
                    {
                        let shading = self.shading(record, &seen, scale * attribute);
                        waiting.push((facet, shading));
                    }
                }
            }
        }
        for (facet, shading) in waiting {
            raster::attribute(simd, view, tile, facet, shading);
        }
    }

    /// Paper 000 §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n and v = n × u (`shaders/common/splat.wgsl`).
    #[inline(always)]
    fn seen(&self, view: &PixelView, record: usize, center: Vec3) -> Seen {
        let shape = &self.shapes[record];
        let normal = oct_decode(shape.normal);
        let a = if normal.y.abs() > 0.99 {
            Vec3::NEG_Z
        } else {
            Vec3::Y
        };
        let u = a.cross(normal).normalize();
        let (normal, u) = (view.rotate(normal), view.rotate(u));
        Seen {
            center,
            normal,
            u,
            v: normal.cross(u),
            radius: shape.radius,
        }
    }

    #[inline(always)]
    fn shading(&self, record: usize, seen: &Seen, scale: f32) -> Shading {
        let [red, green, blue, _] = self.points[record].color;
        let lighting = self.settings.lighting;
        let light = if lighting == Lighting::PerFragment {
            Light::OfPixels
        } else {
            let Patch { u, v, .. } = seen.patch(scale);
            Light::new(lighting, seen.normal, seen.center, u, v)
        };
        Shading {
            color: unit_color([red, green, blue]),
            light,
        }
    }
}

impl Seen {
    #[inline(always)]
    fn patch(&self, scale: f32) -> Patch {
        Patch {
            center: self.center,
            u: self.u * (scale * self.radius),
            v: self.v * (scale * self.radius),
        }
    }

    /// ε-z: the factor on depths with which the visibility pass leaves room for splats of one surface to blend.
    #[inline(always)]
    fn push_back(&self, view: &PixelView, slack_radii: f32, scale: f32) -> f32 {
        let distance = self.center.length().max(view.near);
        1.0 / (1.0 + slack_radii * scale * self.radius / distance)
    }
}
