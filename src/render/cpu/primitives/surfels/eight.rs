//! Eight surfels at a time: first where they are, which is often enough, then how they are turned.

use crate::cloud::{PointRecord, ShapeRecord};
use crate::render::constants::{SQUARE_REACH_RADII, UPRIGHT_NORMAL_Y};
use crate::render::cpu::blocks::Extent;
use crate::render::cpu::eight::{Pyramid, Vectors, lanes_below, words};
use crate::render::cpu::ewa::Splats;
use crate::render::cpu::packed_ellipses::{decode_each, reach_each};
use crate::render::cpu::packed_normals::oct_decode_each;
use crate::render::cpu::raster::Center;
use crate::render::cpu::shading::unit_color;
use crate::render::cpu::tile::LANES;
use crate::render::cpu::view::PixelView;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use std::ops::Range;

/// Cosine tolerance for back faces: surfels turned away by less than this count as facing the eye, because of rounding.
const EDGE_ON_COSINE: f32 = 1e-4;

/// Eight surfels, or fewer at the end of a list, in view space; their directions are still packed.
pub(super) struct EightCenters<S: Simd> {
    pub(super) numbers: Range<usize>,
    pub(super) are_there: mask32x8<S>,
    pub(super) may_touch: mask32x8<S>,
    pub(super) centers: Vectors<S>,
    pub(super) radii: f32x8<S>,
    normals: f32x8<S>,
    ellipses: f32x8<S>,
}

/// Unit normals.
#[derive(Clone, Copy)]
pub(super) struct EightNormals<S: Simd> {
    in_frame: Vectors<S>,
    in_view: Vectors<S>,
}

/// Eight surfels as seen from the eye.
pub(super) struct EightSurfels<S: Simd> {
    pub(super) numbers: Range<usize>,
    pub(super) are_there: mask32x8<S>,
    pub(super) may_touch: mask32x8<S>,
    pub(super) centers: Vectors<S>,
    pub(super) normals: Vectors<S>,
    /// Their half edges where the radius is 1.
    u: Vectors<S>,
    v: Vectors<S>,
    pub(super) radii: f32x8<S>,
}

impl<S: Simd> EightCenters<S> {
    /// Computes the centres of the surfels with these numbers; `None` if nothing of them is in the image, drawn to this
    /// extent.
    #[inline(always)]
    pub(super) fn of(
        simd: S,
        view: &PixelView,
        pyramid: &Pyramid,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
        numbers: Range<usize>,
        extent: Extent,
    ) -> Option<Self> {
        let [x, y, z, _] = words(simd, &points[numbers.clone()]);
        let [normals, radii, ellipses, _] = words(simd, &shapes[numbers.clone()]);
        let centers = view.rotate_each(simd, view.offsets_from_eye(simd, [x, y, z]));
        let margin = centers.z * -view.length_of_px(extent.margin_px);
        let reach = radii * (extent.scale * SQUARE_REACH_RADII) + margin;
        let are_there = lanes_below(simd, numbers.len());
        let may_touch = pyramid.may_touch(simd, centers, reach) & are_there;
        simd.any_true_mask32x8(may_touch).then_some(Self {
            numbers,
            are_there,
            may_touch,
            centers,
            radii,
            normals,
            ellipses,
        })
    }

    /// Bounding radii of the splats for a radius of 1, as disks or as ellipses.
    #[inline(always)]
    pub(super) fn reach_radii(&self, simd: S, are_ellipses: bool) -> f32x8<S> {
        if are_ellipses {
            reach_each(simd, self.ellipses)
        } else {
            f32x8::splat(simd, 1.0)
        }
    }

    /// Their normals; `None` if those that face away are not seen, and all of them do.
    #[inline(always)]
    pub(super) fn normals(&self, simd: S, view: &PixelView, cull_back_faces: bool) -> Option<EightNormals<S>> {
        let in_frame = oct_decode_each(simd, self.normals);
        let in_view = view.rotate_each(simd, in_frame);
        // Slightly more, for those seen edge-on.
        let slack = self.centers.largest() * EDGE_ON_COSINE;
        let may_face = in_view.dot(self.centers).simd_le(slack) & self.may_touch;
        let are_seen = !cull_back_faces || simd.any_true_mask32x8(may_face);
        are_seen.then_some(EightNormals { in_frame, in_view })
    }

    /// Computes the orientations of the splats.
    #[inline(always)]
    pub(super) fn turned(
        self,
        simd: S,
        view: &PixelView,
        normals: EightNormals<S>,
        are_ellipses: bool,
    ) -> EightSurfels<S> {
        let EightNormals { in_frame, in_view } = normals;
        let (u, half_axes) = if are_ellipses {
            let ellipses = decode_each(simd, in_frame, self.ellipses);
            (ellipses.axes, Some(ellipses.half_axes(simd)))
        } else {
            (across(simd, in_frame), None)
        };
        let mut u = view.rotate_each(simd, u);
        let mut v = in_view.cross(u);
        if let Some([longer, shorter]) = half_axes {
            (u, v) = (u.times(longer), v.times(shorter));
        }
        EightSurfels {
            numbers: self.numbers,
            are_there: self.are_there,
            may_touch: self.may_touch,
            centers: self.centers,
            normals: in_view,
            u,
            v,
            radii: self.radii,
        }
    }
}

impl<S: Simd> EightSurfels<S> {
    /// Returns the centre of the splat in a lane.
    #[inline(always)]
    pub(super) fn center(&self, view: &PixelView, lane: usize) -> Center {
        let center = self.centers.lane(lane);
        if -center.z < view.near {
            return Center {
                place_px: [0.0; 2],
                depth: 0.0,
            };
        }
        let slopes = center.truncate() / -center.z;
        Center {
            place_px: [0, 1].map(|axis| slopes[axis] * view.px_per_slope[axis] + view.center_px[axis]),
            depth: view.near / -center.z,
        }
    }

    /// Their colours, from 0 to 1.
    #[inline(always)]
    pub(super) fn colors(&self, simd: S, points: &[PointRecord]) -> [f32x8<S>; 3] {
        let [mut red, mut green, mut blue] = [[0.0; LANES]; 3];
        for (lane, point) in points[self.numbers.clone()].iter().enumerate() {
            let [r, g, b, _] = point.color;
            [red[lane], green[lane], blue[lane]] = unit_color([r, g, b]);
        }
        // Not by `map`: see `raster.rs`.
        [
            f32x8::from_slice(simd, &red),
            f32x8::from_slice(simd, &green),
            f32x8::from_slice(simd, &blue),
        ]
    }

    /// Their splats where radii are `scale` times as large.
    #[inline(always)]
    pub(super) fn splats(&self, simd: S, scale: f32) -> Splats<S> {
        let radii = self.radii * scale;
        Splats {
            u: self.u.times(radii),
            v: self.v.times(radii),
            weights: f32x8::splat(simd, 1.0),
        }
    }
}

/// Unit vectors u across the normals n of disks. The 4D media paper §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n
/// and v = n × u (`shaders/primitives/disk_axes.wgsl`).
#[inline(always)]
fn across<S: Simd>(simd: S, normals: Vectors<S>) -> Vectors<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    // a is −z where n is almost upright, and y elsewhere.
    let is_upright = normals.y.abs().simd_gt(splat(UPRIGHT_NORMAL_Y));
    let u = Vectors {
        x: simd.select_f32x8(is_upright, normals.y, normals.z),
        y: simd.select_f32x8(is_upright, -normals.x, splat(0.0)),
        z: simd.select_f32x8(is_upright, splat(0.0), -normals.x),
    };
    u.times(1.0 / u.dot(u).sqrt())
}
