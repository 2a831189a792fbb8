//! View-dependent texturing: surfaces get their colours from images (Yang et al. 2006 §3.2–3.4); for the definition see
//! `scene/photos/mod.rs`.
//!
//! How it works: when all splats of a tile are summed up, each pixel of the surface is projected into all images, eight
//! of them at a time. The images that see it are then visited, the nearest to the eye's direction first, skipping those
//! from which something hides it, until there are enough. Only these are sampled, and those that disagree with the
//! others count little (`agreement.rs`).
//!
//! Filling holes from around looks beyond a tile. In that case the images are sampled at all pixels first, in a pass of
//! its own ([`Projected::look`]), then holes are filled (`push_pull.rs`), and the frame is drawn from these samples
//! ([`Projected::with_told`]).

mod agreement;
mod candidates;
mod gaps;
mod normals;
mod push_pull;
mod sampling;

pub(super) use push_pull::fill_holes;

use super::tile::{Tile, WIDTH};
use super::view::{PixelRect, PixelView};
use crate::photos::PosedImage;
use crate::render::constants::{
    PHOTO_MIN_COSINE, PHOTO_OPACITY, PHOTO_PER_STEP_ANGLE2, PHOTO_RIM, PHOTO_SAME_ANGLE2, PHOTO_TRUST_NEAR_STEPS,
};
use crate::scene::{DepthMap, DepthRelation, PhotoClipping, PhotoHoles, PhotoRelight, PhotoStyle, PhotoViews};
use agreement::{Shown, agreed};
use candidates::{Candidates, Scores};
use fearless_simd::Simd;
use glam::Vec3;
use normals::normal;
use sampling::{Footprint, sample};
use std::sync::Arc;

/// Posed images projected onto the surface of a rendered frame.
#[derive(Debug)]
pub(super) struct Projected<'a> {
    views: &'a PhotoViews,
    posed_images: &'a [Arc<PosedImage>],
    depths: &'a [DepthMap],
    candidates: Candidates,
    /// Image samples computed earlier for all pixels of the rendered frame.
    told: Option<&'a [PhotoAnswer]>,
}

/// A place of the surface, in view space.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: Vec3,
    /// Unit vector to the eye.
    to_eye: Vec3,
    /// Unit normal towards the eye; zero if it is not known.
    normal: Vec3,
    /// Displacement of the point for a pixel to the right, and for one downwards.
    per_px: [Vec3; 2],
}

/// Image that sees a point.
#[derive(Debug, Clone, Copy, Default)]
struct Seeing {
    view: usize,
    /// Square of the angle between the directions to it and to the eye.
    angle2: f32,
    /// Fraction of the surface that it sees, relative to the eye's.
    share: f32,
    /// Factors on its weight, the share among them.
    trust: f32,
}

/// Result of sampling the images at a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) enum PhotoAnswer {
    /// Colour of the point; and its normal in view space, if that is not to be the points' own: else of length 0.
    Shown { color: [f32; 3], normal: [f32; 3] },
    /// None of them sees it.
    Unseen,
    /// It is not there.
    #[default]
    Clipped,
}

impl<'a> Projected<'a> {
    /// Creates the projection. Precondition: there is a depth map for each image, in their order.
    pub(super) fn new(views: &'a PhotoViews, posed_images: &'a [Arc<PosedImage>], depths: &'a [DepthMap]) -> Self {
        Self {
            views,
            posed_images,
            depths,
            candidates: Candidates::of(&views.views),
            told: None,
        }
    }

    /// Returns true if holes are filled from around: then [`Projected::look`] comes first.
    pub(super) fn fills_holes(&self) -> bool {
        self.views.fills_holes()
    }

    /// Returns true if gaps in the surface are closed.
    pub(super) fn closes_gaps(&self) -> bool {
        self.views.gap_px > 0
    }

    /// Returns the projection with known image samples for each pixel of the rendered frame.
    pub(super) fn with_told(self, told: &'a [PhotoAnswer]) -> Self {
        Self {
            told: Some(told),
            ..self
        }
    }

    /// Writes their results for the surface in a tile, to the tile's rows of the rendered image. Precondition: the tile
    /// holds sums of surfaces.
    #[inline(always)]
    pub(super) fn look<S: Simd>(
        &self,
        simd: S,
        tile: &Tile,
        view: &PixelView,
        clip: PixelRect,
        rows: &mut [PhotoAnswer],
    ) {
        let mut scores = Scores::default();
        for y in clip.start[1]..clip.end[1] {
            let row = (y - tile.origin[1]) as usize;
            for x in clip.start[0]..clip.end[0] {
                let at = WIDTH * row + (x - tile.origin[0]) as usize;
                rows[view.size_px[0] as usize * row + x as usize] = match Place::of_pixel(tile, view, [x, y], at) {
                    Some(place) => self.find(simd, &place, &mut scores),
                    None => PhotoAnswer::Clipped,
                };
            }
        }
    }

    /// Colours the surface in a tile. Precondition: it holds sums of surfaces.
    #[inline(always)]
    pub(super) fn color<S: Simd>(&self, simd: S, tile: &mut Tile, view: &PixelView, clip: PixelRect) {
        let is_white = self.views.relight == PhotoRelight::DepthOnly;
        let mut scores = Scores::default();
        for y in clip.start[1]..clip.end[1] {
            let first = WIDTH * (y - tile.origin[1]) as usize;
            for x in clip.start[0]..clip.end[0] {
                let at = first + (x - tile.origin[0]) as usize;
                let weight = tile.weight[at];
                let Some(place) = Place::of_pixel(tile, view, [x, y], at) else {
                    continue;
                };
                let found = match self.told {
                    Some(told) => told[view.size_px[0] as usize * y as usize + x as usize],
                    None => self.find(simd, &place, &mut scores),
                };
                match found {
                    PhotoAnswer::Shown { color, normal } => {
                        tile.weight[at] *= PHOTO_OPACITY;
                        for sum in &mut tile.surfaces {
                            sum[at] *= PHOTO_OPACITY;
                        }
                        for (sum, value) in tile.colors.iter_mut().zip(color) {
                            sum[at] = value * weight * PHOTO_OPACITY;
                        }
                        if normal != [0.0; 3] {
                            for (sum, value) in tile.surfaces.iter_mut().zip(normal) {
                                sum[at] = value * weight * PHOTO_OPACITY;
                            }
                        }
                    }
                    PhotoAnswer::Unseen if self.views.holes != PhotoHoles::Left => {
                        if is_white {
                            tile.colors.iter_mut().for_each(|sum| sum[at] = weight);
                        }
                    }
                    PhotoAnswer::Unseen | PhotoAnswer::Clipped => {
                        tile.weight[at] = 0.0;
                        tile.depth[at] = 0.0;
                        let sums = tile.colors.iter_mut().chain(&mut tile.surfaces);
                        sums.for_each(|sum| sum[at] = 0.0);
                    }
                }
            }
        }
    }

    /// The colour of a place.
    #[inline(always)]
    fn find<S: Simd>(&self, simd: S, place: &Place, scores: &mut Scores) -> PhotoAnswer {
        self.candidates
            .score(simd, place.position, place.to_eye, place.normal, scores);
        // One more than is blended: weights are relative to the last one's.
        let mut seeing = [Seeing::default(); PhotoStyle::MAX_VIEWS + 1];
        let wanted = self.views.blended + 1;
        let (mut count, mut through, mut nearest) = (0, 0.0, None);
        for _ in 0..PhotoViews::MAX_ASKED {
            let Some(view) = scores.take_best() else {
                break;
            };
            let angle2 = scores.angle2(view);
            let min = *nearest.get_or_insert(angle2);
            let of_view = &self.views.views[view];
            let [column, row] = scores.place(view);
            let share = [column / of_view.size[0], row / of_view.size[1]];
            let (seen, is_near_step) = self.depths[view].seen(share, scores.distance(view));
            if seen == DepthRelation::Hidden {
                continue;
            }
            let share = share_seen(place, scores.facing(view));
            if seen == DepthRelation::Through {
                through += share * self.weight(angle2 - min);
                continue;
            }
            // Also giving less weight to images whose depth is slightly off the point, or that look from another side,
            // changed Redwood by −0.15 to +0.05 dB, and cost sets of few images up to 1.3 dB.
            let trust = share * trust(angle2, is_near_step);
            seeing[count] = Seeing {
                view,
                angle2,
                share,
                trust,
            };
            count += 1;
            if count == wanted {
                break;
            }
        }
        let seeing = &seeing[..count];
        let votes = || -> f32 {
            let min = nearest.unwrap_or_default();
            let of_each = seeing.iter().map(|seen| seen.share * self.weight(seen.angle2 - min));
            of_each.sum()
        };
        // One texel of each depth map votes: bilinear votes of four texels, or votes that count less the farther a
        // position is in front of the depth, clip the same pixels (557 beyond an outline of 54,224), which are within
        // every tolerance.
        let is_clipped = match self.views.clipping {
            PhotoClipping::Off => false,
            PhotoClipping::Paper => through > 0.0,
            PhotoClipping::Vote => through > 0.0 && through > votes(),
        };
        if is_clipped {
            return PhotoAnswer::Clipped;
        }
        self.blend(place, seeing, scores)
    }

    /// The weight of a view whose squared angle is this much larger than the nearest one's (Eq. 2).
    #[inline(always)]
    fn weight(&self, angle2: f32) -> f32 {
        (-angle2 * self.views.per_sigma2).exp()
    }

    /// Blends the colours of the images that see a point, nearest first, with one more than is blended if there are
    /// enough.
    #[inline(always)]
    fn blend(&self, place: &Place, seeing: &[Seeing], scores: &Scores) -> PhotoAnswer {
        let Some(nearest) = seeing.first() else {
            return PhotoAnswer::Unseen;
        };
        let weight = |seen: &Seeing| self.weight(seen.angle2 - nearest.angle2);
        let blended = &seeing[..seeing.len().min(self.views.blended)];
        // Subtracted from all weights, so that no image appears or vanishes abruptly (Buehler et al. 2001).
        let beyond = seeing.get(self.views.blended).map_or(0.0, weight);
        // Where the last is as near as the nearest, all have the same weight.
        let beyond = if beyond < 0.999 { beyond } else { 0.0 };
        let (mut sum, mut object, mut background) = (0.0, 0.0, 0.0);
        let same_angle2 = PHOTO_SAME_ANGLE2 / self.views.per_sigma2;
        let mut shown = [Shown::default(); PhotoStyle::MAX_VIEWS];
        let mut normals = Vec3::ZERO;
        for (shown, seen) in shown.iter_mut().zip(blended) {
            let view = &self.views.views[seen.view];
            let posed_image = &self.posed_images[seen.view];
            let footprint = self.footprint(seen.view, place, scores);
            let [red, green, blue, alpha] = sample(&posed_image.texture, &footprint);
            let weight = (weight(seen) - beyond) * seen.trust * rim(scores.place(seen.view), view.size);
            let color = view.gain * Vec3::new(red, green, blue) / alpha.max(f32::MIN_POSITIVE);
            *shown = Shown {
                color,
                share: weight * alpha,
                nearness: (nearest.angle2 + same_angle2) / (seen.angle2 + same_angle2),
            };
            sum += weight * alpha;
            if self.views.relight != PhotoRelight::Off {
                normals += weight * alpha * normal(&self.depths[seen.view], view, footprint.place);
            }
            if posed_image.is_masked {
                object += weight * alpha;
                background += weight * (1.0 - alpha);
            }
        }
        let is_background = match self.views.clipping {
            PhotoClipping::Off => false,
            PhotoClipping::Vote => background > object,
            PhotoClipping::Paper => background > 0.0,
        };
        if is_background {
            PhotoAnswer::Clipped
        } else if sum > 0.0 {
            let is_white = self.views.relight == PhotoRelight::DepthOnly;
            let color = if is_white {
                Vec3::ONE
            } else {
                agreed(&shown[..blended.len()]).min(Vec3::ONE)
            };
            PhotoAnswer::Shown {
                color: color.to_array(),
                normal: normals.normalize_or_zero().to_array(),
            }
        } else {
            PhotoAnswer::Unseen
        }
    }

    /// Computes the footprint of a pixel in an image: the derivative of its projection.
    #[inline(always)]
    fn footprint(&self, view: usize, place: &Place, scores: &Scores) -> Footprint {
        let of_view = &self.views.views[view];
        let at = scores.place(view);
        let per_distance = 1.0 / scores.distance(view);
        let [x, y, z] = &of_view.camera_from_view;
        let slopes = [
            (at[0] - of_view.principal[0]) / of_view.focal[0],
            (at[1] - of_view.principal[1]) / of_view.focal[1],
        ];
        // Not by `map`, whose closure is not inlined here.
        let moves = |step: Vec3| {
            let deeper = z.truncate().dot(step);
            [
                of_view.focal[0] * per_distance * (x.truncate().dot(step) - slopes[0] * deeper),
                of_view.focal[1] * per_distance * (y.truncate().dot(step) - slopes[1] * deeper),
            ]
        };
        let per_px = [moves(place.per_px[0]), moves(place.per_px[1])];
        Footprint { place: at, per_px }
    }
}

/// Returns the fraction of a surface that an image sees relative to the eye's: less, if it sees it at a more grazing
/// angle.
#[inline(always)]
fn share_seen(place: &Place, facing: f32) -> f32 {
    let facing_eye = place.normal.dot(place.to_eye);
    if facing_eye <= 0.0 {
        return 1.0;
    }
    let share = (facing / facing_eye.max(PHOTO_MIN_COSINE)).min(1.0);
    share * share
}

/// Returns the trust in an image relative to others. The surface is not quite where the points are: near a depth
/// discontinuity seen from another direction than the eye's, an image shows the neighbouring surface.
#[inline(always)]
fn trust(angle2: f32, is_near_step: bool) -> f32 {
    if !is_near_step {
        return 1.0;
    }
    let near = (-angle2 * PHOTO_PER_STEP_ANGLE2).exp();
    PHOTO_TRUST_NEAR_STEPS + (1.0 - PHOTO_TRUST_NEAR_STEPS) * near
}

/// Returns the fade-out factor of an image towards its borders.
#[inline(always)]
fn rim(place: [f32; 2], size: [f32; 2]) -> f32 {
    let inwards = |axis: usize| place[axis].min(size[axis] - place[axis]) / (PHOTO_RIM * size[axis]);
    inwards(0).min(inwards(1)).clamp(1e-3, 1.0)
}

impl Place {
    /// The blended surface at a pixel, which is at this place of the tile; `None` where nothing is.
    #[inline(always)]
    fn of_pixel(tile: &Tile, view: &PixelView, pixel: [i32; 2], at: usize) -> Option<Self> {
        let weight = tile.weight[at];
        if weight <= 0.0 {
            return None;
        }
        // The blended surface, not every fragment of every splat as in the paper: less work, and no seams between
        // splats.
        let sum = |of: usize| tile.surfaces[of][at] / weight;
        let (x, y, z, depth) = (sum(0), sum(1), sum(2), sum(3));
        let distance = view.near / depth.max(f32::MIN_POSITIVE);
        Some(Self::at(view, pixel, distance, Vec3::new(x, y, z)))
    }

    /// The surface at a pixel, `distance` along the view axis.
    #[inline(always)]
    fn at(view: &PixelView, [x, y]: [i32; 2], distance: f32, normal: Vec3) -> Self {
        let right = (x as f32 + 0.5 - view.center_px[0]) / view.px_per_slope[0];
        let down = (y as f32 + 0.5 - view.center_px[1]) / view.px_per_slope[1];
        let ray = Vec3::new(right, down, -1.0);
        let to_eye = -ray.normalize();
        let facing = normal.dot(to_eye);
        let normal = (normal * facing.signum()).normalize_or_zero();
        let per_px = [
            Vec3::X * (distance / view.px_per_slope[0]),
            Vec3::Y * (distance / view.px_per_slope[1]),
        ];
        let cosine = normal.dot(to_eye);
        let per_px = if normal == Vec3::ZERO {
            per_px
        } else {
            // Along the ray, onto the tangent plane.
            let down_to = |step: Vec3| step + to_eye * (-normal.dot(step) / cosine.max(PHOTO_MIN_COSINE));
            [down_to(per_px[0]), down_to(per_px[1])]
        };
        Self {
            // Not moved along the ray to where the depths of four images put it: 35.51 → 35.82 dB with exact depths,
            // but 35.33 with the noise of a depth camera. To where images agree most: 36.63 to 36.84 dB instead of
            // 36.91.
            position: distance * ray,
            to_eye,
            normal,
            per_px,
        }
    }
}
