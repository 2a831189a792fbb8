//! Surfels, round or not, in the six modes of the 4D media paper, Fig. 3, and as hard disks.

mod eight;

use crate::cloud::{PointRecord, ShapeRecord};
use crate::render::constants::{EWA_REACH_PX, SQUARE_REACH_RADII};
use crate::render::cpu::blocks::{Extent, Placed};
use crate::render::cpu::eight::Pyramid;
use crate::render::cpu::ewa::Splats;
use crate::render::cpu::facet::{Canvas, Facet, Facets, Outline, Patches};
use crate::render::cpu::finish::Held;
use crate::render::cpu::footprints::Footprints;
use crate::render::cpu::raster::{self, Center};
use crate::render::cpu::records::DrawnRecords;
use crate::render::cpu::shading::{BACK_SIDE, Light, Shading, SurfaceNormal, seen_from_behind, unit_color};
use crate::render::cpu::small_splats::{EightSmall, MAX_REACH_OF_SMALL_PX, SmallSums, are_small};
use crate::render::cpu::tile::{LANES, Tile};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{
    DrawSettings, Lighting, Primitive, ScenePacket, SplatFilter, Splatting, Surfels as SurfelRecords, VisibilityShape,
};
use eight::{EightCenters, EightSurfels};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use std::ops::Range;

/// Surfels of a packet, and how they are drawn.
pub(in crate::render::cpu) struct Surfels<'a> {
    points: &'a [PointRecord],
    shapes: &'a [ShapeRecord],
    style: &'a DrawSettings,
    /// Screen-space filter of the splats.
    filter: SplatFilter,
    lighting: Lighting,
    /// Factors on the radii in the visibility and the attribute pass.
    scales: [f32; 2],
    /// Depth offset by which the visibility pass is pushed back, in splat radii.
    slack_radii: f32,
}

/// Splats of the attribute pass that wait for the visibility pass to end.
#[derive(Debug, Default)]
pub(in crate::render::cpu) struct Waiting {
    splats: Vec<(Facet, Shading)>,
    /// One per splat, if they are clamped.
    midpoints: Vec<Center>,
    /// Eights of small ones, or fewer, by their numbers.
    small: Vec<Range<u32>>,
    sums: SmallSums,
}

/// Culling result for a group of eight surfels.
enum Fate {
    /// They may cover pixel centres.
    Drawn,
    /// They do not, but those that they are filtered to may: they wait for the visibility pass to end.
    Small,
    /// Nothing is to be seen of them.
    Unseen,
}

impl Waiting {
    #[inline(always)]
    fn add_small(&mut self, numbers: Range<usize>) {
        self.small.push(numbers.start as u32..numbers.end as u32);
    }
}

impl Placed for Surfels<'_> {
    fn len(&self) -> usize {
        self.points.len().min(self.shapes.len())
    }

    fn position(&self, record: usize) -> [f32; 3] {
        self.points[record].position
    }

    fn reach(&self, record: usize) -> f32 {
        SQUARE_REACH_RADII * self.shapes[record].radius
    }
}

impl DrawnRecords for Surfels<'_> {
    type Scratch = Waiting;

    fn held(&self, packet: &ScenePacket) -> Held {
        match self.style.surfels.splatting {
            Splatting::Regular | Splatting::NoDepth | Splatting::Sorted => {
                Held::surfaces(packet).unwrap_or(Held::BlendedColors)
            }
            Splatting::Opaque => Held::surfaces(packet).unwrap_or(Held::SolidColors),
            Splatting::Visibility => Held::depths(packet),
            Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => Held::sums(packet),
        }
    }

    #[inline(always)]
    fn extent(&self) -> Extent {
        Extent {
            scale: self.largest_scale(),
            margin_px: self.margin_px(),
            ..Extent::default()
        }
    }

    /// All passes over a tile but the last, over the image.
    #[inline(always)]
    fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>> + Clone,
        waiting: &mut Waiting,
    ) {
        waiting.splats.clear();
        waiting.midpoints.clear();
        waiting.small.clear();
        let pyramid = Pyramid::of(view, clip);
        for range in records {
            let end = range.end;
            // Eight at a time took 100,000 surfels from 68 to 45 ms, and voxels from 52 to 25 ms: before, patches were
            // set up one by one, and each bounding sphere was projected with divisions (1920×1080, two threads).
            for first in range.step_by(LANES) {
                let Some(midpoints) = self.midpoints(simd, view, &pyramid, first..end.min(first + LANES)) else {
                    continue;
                };
                // Before axes are unpacked: from afar, most disks of a large cloud lie between pixel centres.
                match self.fate(simd, view, &midpoints) {
                    Fate::Drawn => {
                        if let Some(seen) = self.turned(simd, view, midpoints) {
                            self.draw_eight(simd, view, tile, clip, &seen, waiting);
                        }
                    }
                    Fate::Small => waiting.add_small(midpoints.numbers),
                    Fate::Unseen => {}
                }
            }
        }
        if self.filter == SplatFilter::Clamp {
            for ((facet, shading), midpoint) in waiting.splats.iter().zip(&waiting.midpoints) {
                raster::attribute_clamped(simd, tile, facet, shading, midpoint);
            }
            return;
        }
        let has_normals = self.lighting.is_deferred();
        if !waiting.small.is_empty() {
            waiting.sums.begin(has_normals);
        }
        for eight in &waiting.small {
            let eight = eight.start as usize..eight.end as usize;
            let Some(midpoints) = self.midpoints(simd, view, &pyramid, eight) else {
                continue;
            };
            if let Some(seen) = self.turned(simd, view, midpoints) {
                self.attribute_small(simd, view, tile, clip, &seen, &mut waiting.sums);
            }
        }
        waiting.sums.finish(tile, has_normals);
        let kernel = self.style.kernel();
        for (facet, shading) in &waiting.splats {
            raster::attribute(simd, tile, facet, shading, kernel);
        }
    }
}

impl<'a> Surfels<'a> {
    pub(super) fn new(style: &'a DrawSettings, records: &'a SurfelRecords, slack_radii: f32) -> Self {
        let surfels = &style.surfels;
        let scales = surfels.splatting.scales(surfels.enlargement);
        Self {
            points: &records.points,
            shapes: &records.shapes,
            style,
            filter: style.splat_filter(),
            lighting: match style.light.lighting {
                // The centres are the only vertices that sprites have on their disks.
                Lighting::PerVertex if style.draws_sprites() => Lighting::PerSurfel,
                lighting => lighting,
            },
            scales: scales.map(|scale| scale * surfels.splat_scale),
            slack_radii,
        }
    }

    fn is_filtered(&self) -> bool {
        self.filter != SplatFilter::Off
    }

    /// Maximum factors on the radii of drawn splats.
    fn largest_scale(&self) -> f32 {
        let [visibility, attribute] = self.scales;
        visibility.max(attribute)
    }

    /// Returns the margin by which filtering enlarges the extent of the splats.
    fn margin_px(&self) -> f32 {
        if self.is_filtered() { EWA_REACH_PX } else { 0.0 }
    }

    /// Outline of splats in the visibility pass.
    fn visibility_outline(&self) -> Outline {
        match self.style.visibility_shape() {
            VisibilityShape::Disk => Outline::Disk,
            VisibilityShape::Square => Outline::Parallelogram,
        }
    }

    /// Returns the canvas for drawing whole disks.
    fn canvas<'v>(&self, view: &'v PixelView, clip: PixelRect) -> Canvas<'v> {
        Canvas {
            view,
            clip,
            outline: Outline::Disk,
            cull_back_faces: self.style.culls_back_faces(),
            min_reach_px: 0.0,
        }
    }

    /// Computes the centres of eight splats, if any of them is in the image.
    #[inline(always)]
    fn midpoints<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        pyramid: &Pyramid,
        numbers: Range<usize>,
    ) -> Option<EightCenters<S>> {
        EightCenters::of(simd, view, pyramid, self.points, self.shapes, numbers, self.extent())
    }

    /// Computes the orientations of eight splats, if any of them is visible.
    #[inline(always)]
    fn turned<S: Simd>(&self, simd: S, view: &PixelView, midpoints: EightCenters<S>) -> Option<EightSurfels<S>> {
        let normals = midpoints.normals(simd, view, self.style.culls_back_faces())?;
        Some(midpoints.turned(simd, view, normals, self.style.primitive == Primitive::Ellipse))
    }

    /// Returns the culling result for eight splats with only their centres known.
    #[inline(always)]
    fn fate<S: Simd>(&self, simd: S, view: &PixelView, midpoints: &EightCenters<S>) -> Fate {
        if self.filter == SplatFilter::Clamp {
            return Fate::Drawn;
        }
        // Corners of squares are equally far away, whether disks or ellipses touch their edges.
        let are_squares = self.visibility_outline() == Outline::Parallelogram
            || matches!(
                self.style.surfels.splatting,
                Splatting::Regular | Splatting::NoDepth | Splatting::Sorted
            );
        let reach = if are_squares {
            f32x8::splat(simd, SQUARE_REACH_RADII)
        } else {
            midpoints.reach_radii(simd, self.style.primitive == Primitive::Ellipse)
        };
        let reach = midpoints.radii * self.largest_scale() * reach;
        let footprints = Footprints::of(simd, view, midpoints.centers, reach);
        let may_cover = footprints.may_cover_centers(simd) & midpoints.may_touch;
        if simd.any_true_mask32x8(may_cover) {
            return Fate::Drawn;
        }
        if self.filter == SplatFilter::Off {
            return Fate::Unseen;
        }
        let are_large = !footprints.are_within(simd, MAX_REACH_OF_SMALL_PX) & midpoints.are_there;
        if simd.any_true_mask32x8(are_large) {
            Fate::Drawn
        } else {
            Fate::Small
        }
    }

    /// Draws eight surfels, or lets them wait.
    #[inline(always)]
    fn draw_eight<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        seen: &EightSurfels<S>,
        waiting: &mut Waiting,
    ) {
        let surfels = &self.style.surfels;
        let [visibility, attribute] = self.scales;
        let mut canvas = self.canvas(view, clip);
        match surfels.splatting {
            Splatting::Regular | Splatting::NoDepth | Splatting::Sorted => {
                // Only quads on the surface have corners.
                if self.style.primitive != Primitive::Sprite {
                    canvas.outline = Outline::Parallelogram;
                }
                let splats = seen.splats(simd, attribute);
                let facets = splats.facets(simd, &canvas, seen);
                let with_depth = (surfels.splatting == Splatting::Regular).then_some(canvas.outline);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        let shading = self.shading(seen, &splats, lane);
                        raster::over(simd, tile, &facet, &shading, self.style.kernel(), with_depth);
                    }
                }
            }
            Splatting::Opaque => {
                let splats = seen.splats(simd, attribute);
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        let shading = self.shading(seen, &splats, lane);
                        raster::solid(simd, tile, &facet, &shading, canvas.outline);
                    }
                }
            }
            Splatting::Visibility | Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
                // Not filtered: the union of unfiltered splats is the surface. Filtered ones that are seen almost
                // edge-on extend far beyond it, towards the eye as well, and occluded splats they should blend with.
                let splats = seen.splats(simd, visibility);
                let push_back = self.push_back(simd, view, seen, visibility);
                canvas.outline = self.visibility_outline();
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        raster::visibility(simd, tile, &facet, push_back[lane], canvas.outline);
                    }
                }
                if surfels.splatting == Splatting::Visibility {
                    return;
                }
                canvas.outline = Outline::Disk;
                let mut splats = seen.splats(simd, attribute);
                match self.filter {
                    SplatFilter::Off => {}
                    SplatFilter::Ewa => {
                        let on_screen = splats.on_screen(simd, view, seen.centers);
                        if are_small(simd, view, &on_screen, seen.centers, seen.are_there) {
                            waiting.add_small(seen.numbers.clone());
                            return;
                        }
                        splats = splats.filtered(&on_screen);
                    }
                    SplatFilter::Clamp => canvas.min_reach_px = SplatFilter::CLAMP_RADIUS_PX,
                }
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        waiting.splats.push((facet, self.shading(seen, &splats, lane)));
                        if self.filter == SplatFilter::Clamp {
                            waiting.midpoints.push(seen.center(view, lane));
                        }
                    }
                }
            }
        }
    }

    /// Adds eight filtered surfels that are small where they are not behind the depths that are known.
    #[inline(always)]
    fn attribute_small<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &Tile,
        clip: PixelRect,
        seen: &EightSurfels<S>,
        sums: &mut SmallSums,
    ) {
        let [_, attribute] = self.scales;
        let splats = seen.splats(simd, attribute);
        let lighting = self.lighting;
        let eight = EightSmall {
            canvas: &self.canvas(view, clip),
            on_screen: &splats.on_screen(simd, view, seen.centers),
            centers: seen.centers,
            normals: seen.normals,
            colors: seen.colors(simd, self.points),
            back_side: if self.style.darkens_back_faces() {
                BACK_SIDE
            } else {
                1.0
            },
            may_touch: seen.may_touch,
            is_lit: matches!(
                lighting,
                Lighting::PerSurfel | Lighting::PerVertex | Lighting::PerFragment
            ),
        };
        sums.add(simd, tile, &eight, lighting.is_deferred());
    }

    /// ε-z: the factors on depths with which the visibility pass lets splats of one surface blend.
    #[inline(always)]
    fn push_back<S: Simd>(&self, simd: S, view: &PixelView, seen: &EightSurfels<S>, scale: f32) -> f32x8<S> {
        let near = f32x8::splat(simd, view.near);
        let distances = seen.centers.dot(seen.centers).sqrt().max(near);
        let mut slack = seen.radii * (self.slack_radii * scale);
        if self.is_filtered() {
            slack -= seen.centers.z * (self.slack_radii * view.length_of_px(self.filter.radius_px()));
        }
        1.0 / (1.0 + slack / distances)
    }

    #[inline(always)]
    fn shading<S: Simd>(&self, seen: &EightSurfels<S>, splats: &Splats<S>, lane: usize) -> Shading {
        let [red, green, blue, _] = self.points[seen.numbers.start + lane].color;
        let lighting = self.lighting;
        let light = if lighting == Lighting::PerFragment {
            Light::OfPixels
        } else {
            let [u, v] = [splats.u.lane(lane), splats.v.lane(lane)];
            Light::new(lighting, seen.normals.lane(lane), seen.centers.lane(lane), u, v)
        };
        let color = unit_color([red, green, blue]);
        let normal = seen.normals.lane(lane);
        let faces_away = normal.dot(seen.centers.lane(lane)) > 0.0;
        Shading {
            color: if faces_away && self.style.darkens_back_faces() {
                seen_from_behind(color)
            } else {
                color
            },
            light,
            weight: splats.weights[lane],
            normal: lighting
                .is_deferred()
                .then_some(SurfaceNormal::Same(if faces_away { -normal } else { normal })),
        }
    }
}

impl<S: Simd> Splats<S> {
    #[inline(always)]
    fn facets(&self, simd: S, canvas: &Canvas<'_>, seen: &EightSurfels<S>) -> Facets {
        let patches = Patches {
            centers: seen.centers,
            u: self.u,
            v: self.v,
        };
        Facets::new(simd, canvas, &patches, seen.may_touch)
    }
}
