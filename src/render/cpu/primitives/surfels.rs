//! Surfels, round or not, in the six modes of paper 000, Fig. 3, and as hard disks.

use crate::cloud::{PointRecord, ShapeRecord};
use crate::render::constants::{EWA_REACH_PX, SQUARE_REACH_RADII, UPRIGHT_NORMAL_Y};
use crate::render::cpu::blocks::{Extent, Placed};
use crate::render::cpu::eight::{Pyramid, Vectors, lanes_below, words};
use crate::render::cpu::ewa::Splats;
use crate::render::cpu::facet::{Canvas, Facet, Facets, Outline, Patches};
use crate::render::cpu::finish::Held;
use crate::render::cpu::packed_ellipses::decode_each;
use crate::render::cpu::packed_normals::oct_decode_each;
use crate::render::cpu::raster::{self, Middle};
use crate::render::cpu::records::DrawnRecords;
use crate::render::cpu::shading::{BACK_SIDE, Light, Shading, SurfaceNormal, seen_from_behind, unit_color};
use crate::render::cpu::small_splats::{EightSmall, SmallSums, are_small};
use crate::render::cpu::tile::{LANES, Tile};
use crate::render::cpu::view::{PixelRect, PixelView};
use crate::scene::{Lighting, Primitive, ScenePacket, SplatFilter, Splatting, Style};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use std::ops::Range;

/// Surfels of a packet, and how they are drawn.
pub(in crate::render::cpu) struct Surfels<'a> {
    pub(super) points: &'a [PointRecord],
    pub(super) shapes: &'a [ShapeRecord],
    pub(super) style: &'a Style,
    /// How they are filtered to the pixels.
    pub(super) filter: SplatFilter,
    /// How far the visibility pass is pushed back, in splat radii.
    pub(super) slack_radii: f32,
}

/// Splats of the attribute pass that wait for the visibility pass to end.
#[derive(Debug, Default)]
pub(in crate::render::cpu) struct Waiting {
    splats: Vec<(Facet, Shading)>,
    /// As many, where they are clamped.
    middles: Vec<Middle>,
    /// Eights of small ones, or fewer, by their numbers.
    small: Vec<Range<u32>>,
    sums: SmallSums,
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

/// Eight surfels as seen from the eye.
struct EightSurfels<S: Simd> {
    numbers: Range<usize>,
    are_there: mask32x8<S>,
    may_touch: mask32x8<S>,
    centers: Vectors<S>,
    normals: Vectors<S>,
    /// Their half edges where the radius is 1.
    u: Vectors<S>,
    v: Vectors<S>,
    radii: f32x8<S>,
}

impl DrawnRecords for Surfels<'_> {
    type Scratch = Waiting;

    fn held(&self, packet: &ScenePacket) -> Held {
        match self.style.surfels.splatting {
            Splatting::Regular | Splatting::NoDepth => Held::surfaces(packet).unwrap_or(Held::BlendedColors),
            Splatting::Opaque => Held::surfaces(packet).unwrap_or(Held::SolidColors),
            Splatting::Visibility => Held::depths(packet),
            Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => Held::sums(packet),
        }
    }

    fn extent(&self) -> Extent {
        Extent {
            scale: self.largest_scale(),
            margin_px: if self.is_filtered() { EWA_REACH_PX } else { 0.0 },
            ..Extent::default()
        }
    }

    /// All passes over a tile but the last, over the picture.
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
        waiting.middles.clear();
        waiting.small.clear();
        let pyramid = Pyramid::of(view, clip);
        for range in records {
            let end = range.end;
            for first in range.step_by(LANES) {
                if let Some(seen) = self.eight(simd, view, &pyramid, first..end.min(first + LANES)) {
                    self.draw_eight(simd, view, tile, clip, &seen, waiting);
                }
            }
        }
        if self.filter == SplatFilter::Clamp {
            for ((facet, shading), middle) in waiting.splats.iter().zip(&waiting.middles) {
                raster::attribute_clamped(simd, tile, facet, shading, middle);
            }
            return;
        }
        let has_normals = self.lighting().is_deferred();
        if !waiting.small.is_empty() {
            waiting.sums.begin(has_normals);
        }
        for eight in &waiting.small {
            let eight = eight.start as usize..eight.end as usize;
            if let Some(seen) = self.eight(simd, view, &pyramid, eight) {
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

impl Surfels<'_> {
    fn is_filtered(&self) -> bool {
        self.filter != SplatFilter::Off
    }

    /// Factors on the radii of what is drawn at most.
    fn largest_scale(&self) -> f32 {
        let surfels = &self.style.surfels;
        let [visibility, attribute] = surfels.splatting.scales(surfels.enlargement);
        visibility.max(attribute) * surfels.splat_scale
    }

    /// Where whole disks are drawn.
    fn canvas<'a>(&self, view: &'a PixelView, clip: PixelRect) -> Canvas<'a> {
        Canvas {
            view,
            clip,
            outline: Outline::Disk,
            cull_back_faces: self.style.culls_back_faces(),
            least_reach_px: 0.0,
        }
    }

    /// How they are lit: sprites have no vertices on their disks but the middles.
    fn lighting(&self) -> Lighting {
        match self.style.light.lighting {
            Lighting::PerVertex if self.style.draws_sprites() => Lighting::PerSurfel,
            lighting => lighting,
        }
    }

    /// Eight surfels, or fewer at the end of a list; `None` if nothing of them is in the picture.
    #[inline(always)]
    fn eight<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        pyramid: &Pyramid,
        numbers: Range<usize>,
    ) -> Option<EightSurfels<S>> {
        let [x, y, z, _] = words(simd, &self.points[numbers.clone()]);
        let [normals, radii, ellipses, _] = words(simd, &self.shapes[numbers.clone()]);
        let centers = view.rotate_each(simd, view.offsets_from_eye(simd, [x, y, z]));
        let mut reach = radii * (self.largest_scale() * SQUARE_REACH_RADII);
        if self.is_filtered() {
            reach += centers.z * -view.length_of_px(EWA_REACH_PX);
        }
        let are_there = lanes_below(simd, numbers.len());
        let may_touch = pyramid.may_touch(simd, centers, reach) & are_there;
        if !simd.any_true_mask32x8(may_touch) {
            return None;
        }
        let normals = oct_decode_each(simd, normals);
        let (u, half_axes) = if self.style.primitive == Primitive::Ellipse {
            let ellipses = decode_each(simd, normals, ellipses);
            (ellipses.axes, Some(ellipses.half_axes(simd)))
        } else {
            (across(simd, normals), None)
        };
        let (normals, mut u) = (view.rotate_each(simd, normals), view.rotate_each(simd, u));
        let mut v = normals.cross(u);
        if let Some([longer, shorter]) = half_axes {
            (u, v) = (u.times(longer), v.times(shorter));
        }
        Some(EightSurfels {
            numbers,
            are_there,
            may_touch,
            centers,
            normals,
            u,
            v,
            radii,
        })
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
        let [visibility, attribute] = surfels.splatting.scales(surfels.enlargement);
        let scale = surfels.splat_scale;
        let [visibility, attribute] = [scale * visibility, scale * attribute];
        let mut canvas = self.canvas(view, clip);
        match surfels.splatting {
            Splatting::Regular | Splatting::NoDepth => {
                // Only what is on a surface has corners.
                if self.style.primitive != Primitive::Sprite {
                    canvas.outline = Outline::Parallelogram;
                }
                let splats = seen.splats(simd, scale);
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
                let splats = seen.splats(simd, scale);
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        let shading = self.shading(seen, &splats, lane);
                        raster::solid(simd, tile, &facet, &shading, canvas.outline);
                    }
                }
            }
            Splatting::Visibility | Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
                let splats = seen.splats(simd, visibility);
                let push_back = self.push_back(simd, view, seen, visibility);
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        raster::visibility(simd, tile, &facet, push_back[lane]);
                    }
                }
                if surfels.splatting == Splatting::Visibility {
                    return;
                }
                let mut splats = seen.splats(simd, attribute);
                match self.filter {
                    SplatFilter::Off => {}
                    SplatFilter::Ewa => {
                        let on_screen = splats.on_screen(simd, view, seen.centers);
                        if are_small(simd, view, &on_screen, seen.centers, seen.are_there) {
                            waiting.small.push(seen.numbers.start as u32..seen.numbers.end as u32);
                            return;
                        }
                        splats = splats.filtered(&on_screen);
                    }
                    SplatFilter::Clamp => canvas.least_reach_px = SplatFilter::CLAMP_RADIUS_PX,
                }
                let facets = splats.facets(simd, &canvas, seen);
                for lane in 0..LANES {
                    if let Some(facet) = facets.get(lane) {
                        waiting.splats.push((facet, self.shading(seen, &splats, lane)));
                        if self.filter == SplatFilter::Clamp {
                            waiting.middles.push(seen.middle(view, lane));
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
        let surfels = &self.style.surfels;
        let [_, attribute] = surfels.splatting.scales(surfels.enlargement);
        let splats = seen.splats(simd, surfels.splat_scale * attribute);
        let lighting = self.lighting();
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

    /// ε-z: the factors on depths with which the visibility pass leaves room for splats of one surface to blend.
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
        let lighting = self.lighting();
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

/// Unit vectors u across the normals n of disks. Paper 000 §V-A: T(p) · S(r, r, 1) · R(u, v, n) with u = a × n and v =
/// n × u (`shaders/primitives/disk_axes.wgsl`).
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

impl<S: Simd> EightSurfels<S> {
    /// Where the middle of one of them is.
    #[inline(always)]
    fn middle(&self, view: &PixelView, lane: usize) -> Middle {
        let center = self.centers.lane(lane);
        if -center.z < view.near {
            return Middle {
                place_px: [0.0; 2],
                depth: 0.0,
            };
        }
        let slopes = center.truncate() / -center.z;
        Middle {
            place_px: [0, 1].map(|axis| slopes[axis] * view.px_per_slope[axis] + view.middle_px[axis]),
            depth: view.near / -center.z,
        }
    }

    /// Their colours, from 0 to 1.
    #[inline(always)]
    fn colors(&self, simd: S, points: &[PointRecord]) -> [f32x8<S>; 3] {
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
    fn splats(&self, simd: S, scale: f32) -> Splats<S> {
        let radii = self.radii * scale;
        Splats {
            u: self.u.times(radii),
            v: self.v.times(radii),
            weights: f32x8::splat(simd, 1.0),
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
