//! Cells as cubes: the three faces of each that can face the eye.

use crate::cloud::{ShapeRecord, VoxelRecord};
use crate::render::constants::CUBE_REACH_HALF_EDGES;
use crate::render::cpu::blocks::{Extent, Placed};
use crate::render::cpu::eight::{Pyramid, Vectors, lanes_below, words};
use crate::render::cpu::facet::{Canvas, Facets, Outline, Patches};
use crate::render::cpu::finish::Held;
use crate::render::cpu::packed_normals::oct_decode_each;
use crate::render::cpu::raster;
use crate::render::cpu::records::DrawnRecords;
use crate::render::cpu::shading::{Light, Shading, SurfaceNormal, unit_color};
use crate::render::cpu::tile::{LANES, Tile};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Lighting, ScenePacket, Voxels};
use fearless_simd::{Bytes, Simd, SimdFloat, f32x8, mask32x8, u32x8};
use std::ops::Range;

/// Cells of a packet, and how they are drawn.
pub(in crate::render::cpu) struct Cubes<'a> {
    records: &'a [VoxelRecord],
    /// Surface normals of the cells, if they are lit.
    normals: Option<&'a [ShapeRecord]>,
    cube_edge: f32,
    lighting: Lighting,
    /// Depth offset by which a shadow map is pushed back, in cell diagonals.
    slack: f32,
}

impl Placed for Cubes<'_> {
    fn len(&self) -> usize {
        self.records.len()
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.records[record].center
    }

    fn reach(&self, record: usize) -> f32 {
        CUBE_REACH_HALF_EDGES * self.half_edge(record)
    }
}

impl DrawnRecords for Cubes<'_> {
    type Scratch = ();

    fn held(&self, packet: &ScenePacket) -> Held {
        Held::surfaces(packet).unwrap_or(Held::SolidColors)
    }

    fn extent(&self) -> Extent {
        Extent {
            scale: 1.0,
            ..Extent::default()
        }
    }

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
        let pyramid = Pyramid::of(view, clip);
        for range in records {
            let end = range.end;
            for first in range.step_by(LANES) {
                let eight = first..end.min(first + LANES);
                self.draw_eight(simd, view, tile, clip, &pyramid, eight);
            }
        }
    }
}

impl<'a> Cubes<'a> {
    pub(super) fn new(voxels: &'a Voxels, lighting: Lighting, slack: f32) -> Self {
        Self {
            records: &voxels.records,
            normals: voxels.normals.as_ref().map(|normals| normals.as_slice()),
            cube_edge: voxels.cube_edge,
            lighting,
            slack,
        }
    }

    fn half_edge(&self, record: usize) -> f32 {
        0.5 * self.cube_edge / (1u32 << self.records[record].level) as f32
    }

    #[inline(always)]
    fn draw_eight<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        pyramid: &Pyramid,
        eight: Range<usize>,
    ) {
        let records = &self.records[eight.clone()];
        let [x, y, z, color_and_level] = words(simd, records);
        let offsets = view.offsets_from_eye(simd, [x, y, z]);
        let centers = view.rotate_each(simd, offsets);
        let half_edges = self.half_edges(color_and_level);
        let may_touch =
            pyramid.may_touch(simd, centers, half_edges * CUBE_REACH_HALF_EDGES) & lanes_below(simd, records.len());
        if !simd.any_true_mask32x8(may_touch) {
            return;
        }
        let cells = EightCells {
            offsets,
            centers,
            half_edges,
            may_touch,
        };
        let canvas = Canvas {
            view,
            clip,
            outline: Outline::Parallelogram,
            cull_back_faces: true,
            min_reach_px: 0.0,
        };
        let faces = [
            cells.faces(simd, &canvas, 0),
            cells.faces(simd, &canvas, 1),
            cells.faces(simd, &canvas, 2),
        ];
        let normals = self.normals.map(|normals| {
            let [packed, ..] = words(simd, &normals[eight]);
            view.rotate_each(simd, oct_decode_each(simd, packed))
        });
        let push_back = cells.push_back(view, self.slack);
        for (lane, record) in records.iter().enumerate() {
            let normal = normals.as_ref().map(|normals| normals.lane(lane));
            for (axis, (patches, facets)) in faces.iter().enumerate() {
                if let Some(mut facet) = facets.get(lane) {
                    facet.depth_per_w *= push_back[lane];
                    let lit_normal = normal.unwrap_or_else(|| view.rotation().col(axis));
                    let light = if self.lighting == Lighting::PerFragment && normal.is_none() {
                        Light::OfPixels
                    } else {
                        let center = patches.centers.lane(lane);
                        let [u, v] = [patches.u.lane(lane), patches.v.lane(lane)];
                        match self.lighting {
                            Lighting::PerFragment => {
                                Light::OfPixelsOn(facet.along_rays(view, lit_normal, [center, u, v]))
                            }
                            lighting => Light::new(lighting, lit_normal, center, u, v),
                        }
                    };
                    let color = unit_color(record.color);
                    let shading = Shading {
                        color,
                        light,
                        weight: 1.0,
                        normal: self.lighting.is_deferred().then_some(SurfaceNormal::Same(lit_normal)),
                    };
                    raster::solid(simd, tile, &facet, &shading, Outline::Parallelogram);
                }
            }
        }
    }

    /// As [`Cubes::half_edge`], from the words of records whose highest byte is a level.
    #[inline(always)]
    fn half_edges<S: Simd>(&self, words: f32x8<S>) -> f32x8<S> {
        let levels: u32x8<S> = words.bitcast::<u32x8<S>>() >> 24;
        // The exponent of an f32.
        let per_level: f32x8<S> = ((127 - levels) << 23).bitcast();
        per_level * (0.5 * self.cube_edge)
    }
}

/// Eight cells.
struct EightCells<S: Simd> {
    /// Offsets of the cell centres from the eye, in the axes of the frame.
    offsets: Vectors<S>,
    /// Cell centres in view space, relative to the eye.
    centers: Vectors<S>,
    half_edges: f32x8<S>,
    may_touch: mask32x8<S>,
}

impl<S: Simd> EightCells<S> {
    /// The factors on depths with which a shadow map leaves a margin for the faces of cells, which are steps of a
    /// surface.
    #[inline(always)]
    fn push_back(&self, view: &PixelView, slack: f32) -> f32x8<S> {
        let distances = self.offsets.dot(self.offsets).sqrt().max(view.near);
        1.0 / (1.0 + self.half_edges * (2.0 * CUBE_REACH_HALF_EDGES * slack) / distances)
    }

    /// The faces towards the eye that an axis of the frame crosses.
    #[inline(always)]
    fn faces(&self, simd: S, canvas: &Canvas<'_>, axis: usize) -> (Patches<S>, Facets) {
        let offset = [self.offsets.x, self.offsets.y, self.offsets.z][axis];
        // For an eye between the planes of two faces, both face away and are culled.
        let towards_eye = self.half_edges.copysign(-offset);
        let rotation = canvas.view.rotation();
        let along = |axis: usize| Vectors::splat(simd, rotation.col(axis));
        let patches = Patches {
            centers: self.centers.plus(along(axis).times(towards_eye)),
            // Ordered so that their cross product points outwards.
            u: along((axis + 1) % 3).times(towards_eye),
            v: along((axis + 2) % 3).times(self.half_edges),
        };
        let facets = Facets::new(simd, canvas, &patches, self.may_touch);
        (patches, facets)
    }
}
