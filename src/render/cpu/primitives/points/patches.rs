//! Points that are lit or blended: patches that face the screen, drawn by the code for surfels and faces of voxels.

use super::Points;
use crate::cloud::PointRecord;
use crate::render::constants::{DEPTH_SLACK_RADII, SQUARE_REACH_RADII};
use crate::render::cpu::eight::{Pyramid, Vectors, lanes_below, words};
use crate::render::cpu::facet::{Canvas, Facet, Facets, Outline, Patches};
use crate::render::cpu::packed_normals::oct_decode_each;
use crate::render::cpu::raster;
use crate::render::cpu::shading::{Light, Shading, SurfaceNormal, unit_color};
use crate::render::cpu::tile::{LANES, Tile};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Kernel, Lighting, PointShape};
use fearless_simd::{Simd, SimdFloat};
use glam::Vec3;
use std::ops::Range;

/// Eight points as patches in view space.
struct EightPoints<'a, S: Simd> {
    records: &'a [PointRecord],
    patches: Patches<S>,
    /// Zero where they have none.
    normals: Vectors<S>,
}

/// Render pass of patches.
#[derive(Debug, Clone, Copy)]
enum Pass {
    Visibility,
    Attribute,
    Solid,
}

impl Points<'_> {
    /// Draws all passes over a tile but the last, over the image. Points that are blended are computed for each of
    /// both: unlike surfels that are smaller than a pixel, no point is skipped, and all of a cloud may be in one tile.
    #[inline(always)]
    pub(super) fn draw_patches<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: &(impl Iterator<Item = Range<usize>> + Clone),
    ) {
        let pyramid = Pyramid::of(view, clip);
        let canvas = Canvas {
            view,
            clip,
            outline: match self.shape {
                PointShape::Square => Outline::Parallelogram,
                PointShape::Disk | PointShape::Gaussian => Outline::Disk,
            },
            cull_back_faces: false,
            min_reach_px: 0.0,
        };
        let passes: &[Pass] = match self.shape {
            PointShape::Square | PointShape::Disk => &[Pass::Solid],
            PointShape::Gaussian => &[Pass::Visibility, Pass::Attribute],
        };
        for &pass in passes {
            for range in records.clone() {
                let end = range.end;
                for first in range.step_by(LANES) {
                    let eight = first..end.min(first + LANES);
                    self.draw_eight(simd, &canvas, tile, &pyramid, eight, pass);
                }
            }
        }
    }

    /// Squares across the view, whose half edges are along its axes.
    #[inline(always)]
    fn patches<S: Simd>(&self, simd: S, view: &PixelView, eight: Range<usize>) -> Patches<S> {
        let [x, y, z, _] = words(simd, &self.records[eight.clone()]);
        let centers = view.rotate_each(simd, view.offsets_from_eye(simd, [x, y, z]));
        let min = centers.z * (-0.5 * self.size.min_px / view.px_per_slope[0]);
        let half_edges = self.half_edges(simd, eight).max(min);
        let none = Vectors::splat(simd, Vec3::ZERO);
        Patches {
            centers,
            u: Vectors { x: half_edges, ..none },
            v: Vectors { y: half_edges, ..none },
        }
    }

    #[inline(always)]
    fn normals<S: Simd>(&self, simd: S, view: &PixelView, eight: Range<usize>) -> Vectors<S> {
        match self.shapes {
            None => Vectors::splat(simd, Vec3::ZERO),
            Some(shapes) => {
                let [packed, ..] = words(simd, &shapes[eight]);
                view.rotate_each(simd, oct_decode_each(simd, packed))
            }
        }
    }

    #[inline(always)]
    fn draw_eight<S: Simd>(
        &self,
        simd: S,
        canvas: &Canvas<'_>,
        tile: &mut Tile,
        pyramid: &Pyramid,
        eight: Range<usize>,
        pass: Pass,
    ) {
        let view = canvas.view;
        let patches = self.patches(simd, view, eight.clone());
        let half_edges = patches.u.x;
        let may_touch =
            pyramid.may_touch(simd, patches.centers, half_edges * SQUARE_REACH_RADII) & lanes_below(simd, eight.len());
        if !simd.any_true_mask32x8(may_touch) {
            return;
        }
        let facets = Facets::new(simd, canvas, &patches, may_touch);
        // ε-z, as for surfels.
        let distances = patches.centers.dot(patches.centers).sqrt().max(view.near);
        let push_back = 1.0 / (1.0 + half_edges * DEPTH_SLACK_RADII / distances);
        let seen = EightPoints {
            records: &self.records[eight.clone()],
            patches,
            normals: self.normals(simd, view, eight),
        };
        for lane in 0..seen.records.len() {
            let Some(facet) = facets.get(lane) else {
                continue;
            };
            match pass {
                Pass::Visibility => raster::visibility(simd, tile, &facet, push_back[lane], Outline::Disk),
                Pass::Attribute => {
                    let shading = self.shading(view, &seen, lane, &facet);
                    raster::attribute(simd, tile, &facet, &shading, Kernel::Gaussian);
                }
                Pass::Solid => {
                    let shading = self.shading(view, &seen, lane, &facet);
                    raster::solid(simd, tile, &facet, &shading, canvas.outline);
                }
            }
        }
    }

    #[inline(always)]
    fn shading<S: Simd>(&self, view: &PixelView, eight: &EightPoints<'_, S>, lane: usize, facet: &Facet) -> Shading {
        let [red, green, blue, _] = eight.records[lane].color;
        let Patches { centers, u, v } = &eight.patches;
        let [center, u, v] = [centers.lane(lane), u.lane(lane), v.lane(lane)];
        let normal = eight.normals.lane(lane);
        let along_rays = facet.along_rays(view, normal, [center, u, v]);
        Shading {
            color: unit_color([red, green, blue]),
            light: match self.lighting {
                Lighting::PerFragment => Light::OfPixelsOn(along_rays),
                lighting => Light::new(lighting, normal, center, u, v),
            },
            weight: 1.0,
            normal: (self.lighting.is_deferred()).then_some(SurfaceNormal::OfSideSeen { normal, along_rays }),
        }
    }
}
