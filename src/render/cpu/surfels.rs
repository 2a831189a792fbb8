//! Surfels in the six modes of paper 000, Fig. 3.

use super::blocks::Placed;
use super::eight::{Pyramid, Vectors, lanes_below, words};
use super::facet::{Facet, Facets, Outline, Patches};
use super::raster;
use super::shading::{Light, Shading, unit_color};
use super::tile::{LANES, Tile};
use super::view::{PixelRect, PixelView};
use crate::cloud::{PointRecord, ShapeRecord};
use crate::render::DEPTH_SLACK_RADII;
use crate::scene::{Lighting, Settings, Splatting};
use fearless_simd::{Bytes, Simd, SimdBase, SimdFloat, f32x8, i32x8, mask32x8};
use std::f32::consts::SQRT_2;
use std::ops::Range;

/// Surfels of a packet, and how they are drawn.
pub(super) struct Surfels<'a> {
    pub(super) points: &'a [PointRecord],
    pub(super) shapes: &'a [ShapeRecord],
    pub(super) settings: &'a Settings,
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
        SQRT_2 * self.shapes[record].radius
    }
}

/// Eight surfels as seen from the eye.
struct Seen<S: Simd> {
    centers: Vectors<S>,
    normals: Vectors<S>,
    /// Directions of their edges.
    u: Vectors<S>,
    v: Vectors<S>,
    radii: f32x8<S>,
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
        waiting.clear();
        let pyramid = Pyramid::of(view, clip);
        for range in records {
            let end = range.end;
            for first in range.step_by(LANES) {
                let eight = first..end.min(first + LANES);
                let [x, y, z, _] = words(simd, &self.points[eight.clone()]);
                let [normals, radii, ..] = words(simd, &self.shapes[eight.clone()]);
                let centers = view.rotate_each(simd, view.offsets_from_eye(simd, [x, y, z]));
                let reach = radii * (self.largest_scale() * SQRT_2);
                let may_touch =
                    pyramid.may_touch(simd, centers, reach) & lanes_below(simd, eight.len());
                if simd.any_true_mask32x8(may_touch) {
                    let seen = seen(simd, view, centers, normals, radii);
                    self.draw_eight(simd, view, tile, clip, first, &seen, may_touch, waiting);
                }
            }
        }
        for (facet, shading) in waiting {
            raster::attribute(simd, tile, facet, shading);
        }
    }

    /// Draws those of eight surfels, the first of which has a number, that may touch a tile.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "all of what a tile is drawn from"
    )]
    fn draw_eight<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        first: usize,
        seen: &Seen<S>,
        may_touch: mask32x8<S>,
        waiting: &mut Waiting,
    ) {
        let Settings {
            splatting,
            splat_scale,
            enlargement,
            cull_back_faces,
            ..
        } = *self.settings;
        let [visibility, attribute] = splatting.scales(enlargement);
        let [visibility, attribute] = [splat_scale * visibility, splat_scale * attribute];
        match splatting {
            Splatting::Regular | Splatting::NoDepth => {
                let facets = seen.facets(
                    simd,
                    view,
                    clip,
                    splat_scale,
                    Outline::Parallelogram,
                    cull_back_faces,
                    may_touch,
                );
                let with_depth = splatting == Splatting::Regular;
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        let shading = self.shading(first + lane, seen, lane, splat_scale);
                        raster::over(simd, tile, &facet, &shading, with_depth);
                    }
                }
            }
            Splatting::Visibility
            | Splatting::TwoPass
            | Splatting::Enlarged
            | Splatting::TwoPassEnlarged => {
                let push_back = seen.push_back(view, visibility);
                let smaller = seen.facets(
                    simd,
                    view,
                    clip,
                    visibility,
                    Outline::Disk,
                    cull_back_faces,
                    may_touch,
                );
                for lane in 0..LANES {
                    if let Some(facet) = smaller.get(lane) {
                        raster::visibility(simd, tile, &facet, push_back[lane]);
                    }
                }
                if splatting == Splatting::Visibility {
                    return;
                }
                let larger = seen.facets(
                    simd,
                    view,
                    clip,
                    attribute,
                    Outline::Disk,
                    cull_back_faces,
                    may_touch,
                );
                for lane in 0..LANES {
                    if let Some(facet) = larger.get(lane) {
                        waiting.push((facet, self.shading(first + lane, seen, lane, attribute)));
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn shading<S: Simd>(&self, record: usize, seen: &Seen<S>, lane: usize, scale: f32) -> Shading {
        let [red, green, blue, _] = self.points[record].color;
        let lighting = self.settings.lighting;
        let light = if lighting == Lighting::PerFragment {
            Light::OfPixels
        } else {
            let scale = scale * seen.radii[lane];
            let [u, v] = [seen.u.lane(lane) * scale, seen.v.lane(lane) * scale];
            Light::new(
                lighting,
                seen.normals.lane(lane),
                seen.centers.lane(lane),
                u,
                v,
            )
        };
        Shading {
            color: unit_color([red, green, blue]),
            light,
        }
    }
}

/// Paper 000 §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n and v = n × u (`shaders/common/splat.wgsl`).
#[inline(always)]
fn seen<S: Simd>(
    simd: S,
    view: &PixelView,
    centers: Vectors<S>,
    packed_normals: f32x8<S>,
    radii: f32x8<S>,
) -> Seen<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let normals = oct_decode_each(simd, packed_normals);
    // Of the vectors a, z below is -1 where n is almost upright, and y is 1 elsewhere.
    let is_upright = normals.y.abs().simd_gt(splat(0.99));
    let u = Vectors {
        x: simd.select_f32x8(is_upright, normals.y, normals.z),
        y: simd.select_f32x8(is_upright, -normals.x, splat(0.0)),
        z: simd.select_f32x8(is_upright, splat(0.0), -normals.x),
    };
    let u = u.times(1.0 / u.dot(u).sqrt());
    let (normals, u) = (view.rotate_each(simd, normals), view.rotate_each(simd, u));
    Seen {
        centers,
        normals,
        u,
        v: normals.cross(u),
        radii,
    }
}

/// As [`oct_decode`](crate::cloud::oct_decode).
#[inline(always)]
fn oct_decode_each<S: Simd>(simd: S, packed: f32x8<S>) -> Vectors<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let packed: i32x8<S> = packed.bitcast();
    let unit = |halves: i32x8<S>| simd.cvt_f32_i32x8(halves >> 16) * (1.0 / f32::from(i16::MAX));
    let (x, y) = (unit(packed << 16), unit(packed));
    let z = 1.0 - x.abs() - y.abs();
    let is_folded = z.simd_lt(splat(0.0));
    let one_like =
        |value: f32x8<S>| simd.select_f32x8(value.simd_ge(splat(0.0)), splat(1.0), splat(-1.0));
    let folded = Vectors {
        x: simd.select_f32x8(is_folded, (1.0 - y.abs()) * one_like(x), x),
        y: simd.select_f32x8(is_folded, (1.0 - x.abs()) * one_like(y), y),
        z,
    };
    folded.times(1.0 / folded.dot(folded).sqrt())
}

impl<S: Simd> Seen<S> {
    #[inline(always)]
    fn facets(
        &self,
        simd: S,
        view: &PixelView,
        clip: PixelRect,
        scale: f32,
        outline: Outline,
        cull_back_faces: bool,
        are_asked: mask32x8<S>,
    ) -> Facets {
        let lengths = self.radii * scale;
        let patches = Patches {
            centers: self.centers,
            u: self.u.times(lengths),
            v: self.v.times(lengths),
        };
        Facets::new(
            simd,
            view,
            clip,
            &patches,
            outline,
            cull_back_faces,
            are_asked,
        )
    }

    /// ε-z: the factors on depths with which the visibility pass leaves room for splats of one surface to blend.
    #[inline(always)]
    fn push_back(&self, view: &PixelView, scale: f32) -> f32x8<S> {
        let near = f32x8::splat(self.radii.witness(), view.near);
        let distances = self.centers.dot(self.centers).sqrt().max(near);
        1.0 / (1.0 + self.radii * (DEPTH_SLACK_RADII * scale) / distances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{oct_decode, oct_encode};
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn normals_are_unpacked_as_those_of_the_cloud(
            normal in prop::array::uniform3(-1.0f32..1.0),
            lane in 0..LANES,
        ) {
            let packed = oct_encode(glam::Vec3::from_array(normal).normalize_or(glam::Vec3::NEG_Z));
            let mut words = [0.0; LANES];
            words[lane] = bytemuck::cast(packed);
            let decoded = dispatch!(Level::new(), simd => {
                oct_decode_each(simd, f32x8::from_slice(simd, &words)).lane(lane)
            });
            prop_assert!((decoded - oct_decode(packed)).length() < 1e-6);
        }
    }
}
