//! Surface for view-dependent texturing, reconstructed from the input images themselves.
//!
//! Points of a reconstruction are where images have corners: thousands on one poster, none on a wall. Their splats are
//! as large as their gaps, reach across outlines, and leave the rest of the image empty. So if a set has images with
//! cameras and no depths, planes are swept before downscaled copies of them ([`PlaneSweep`]). Depths that three views
//! agree on are retained, unless [others look through them](forget_doubted). Depths that two agree on, those of sparse
//! points and those that [other views have measured](carry_over) are added; the rest is [filled in](Map::complete) from
//! there, and all of it becomes [splats](fuse) of the size of a pixel.
//!
//! It wins on scenes that fill the images: rooms, streets. A ball of thousands of even points has a better surface in
//! these.

mod complete;
mod fuse;
mod map;
mod others;
#[cfg(test)]
mod tests;

use super::all_views::{AROUND_CENTER, depth_range, telling};
use crate::photos::{Observation, PhotoSurface, PosedImage, PosedImages, ViewSet, resized};
use crate::progress::Progress;
use crate::rgbd::{Camera, ColorImage, DepthImage};
use crate::stereo::Consistency;
use crate::stereo::PlaneSweep;
use crate::stereo::StereoError;
use crate::stereo::View;
use crate::stereo::consistent;
use fuse::fuse;
use glam::{DAffine3, DVec3};
use map::Map;
use others::{add_pairs, carry_over, forget_doubted, is_looked_through};
use rayon::prelude::*;

/// Maximum side length in pixels: images are halved until no side is longer. A set of 25 takes some 20 s of one core.
const MAX_SIDE_PX: u32 = 400;

/// Maximum number of images whose depth maps are computed: a larger set is sampled evenly.
const MAX_MAPS: usize = 64;

/// Sets of more points have a surface.
const MAX_POINTS: usize = 1 << 17;

/// Number of neighbouring images that each image is compared with.
const NEIGHBOURS: usize = 4;

/// Maximum reprojection error in pixels of a valid point in an image that sees it.
const MAX_OFF_PX: f64 = 3.0;

/// Minimum angle in radians between two images that determines how far away a point is.
const MIN_ANGLE: f64 = 0.03;

/// Consistency criterion for depths seen by only two views.
const OF_TWO: Consistency = Consistency {
    min_views: 2,
    tolerance: 0.01,
};

/// Downscaled copy of an image.
struct Small {
    number: usize,
    camera: Camera,
    camera_from_world: DAffine3,
    image: ColorImage,
    /// Mask that is true for pixels of the scene.
    is_scene: Vec<bool>,
}

/// The surface that `posed_images` of `set` show, relative to `origin`; `None` if they have depths or a cloud already,
/// or do not yield any depth. Reports to `progress`; its result after cancellation is useless.
pub fn photo_surface(
    set: &ViewSet,
    posed_images: &PosedImages,
    origin: DVec3,
    progress: &Progress,
) -> Option<PhotoSurface> {
    let has_depths = posed_images.all().iter().any(|posed_image| posed_image.depth.is_some());
    let has_cloud = set.points.len() > MAX_POINTS || set.points.is_empty() && set.points_file.is_some();
    if has_depths || has_cloud || posed_images.all().len() < Consistency::default().min_views {
        return None;
    }
    let all = posed_images.all().iter();
    let small: Vec<Small> = all.filter_map(|posed_image| Small::of(posed_image)).collect();
    let views: Vec<View<'_>> = small.iter().map(Small::view).collect();
    let centers = set.centers();
    let looked_at: Vec<usize> = (0..small.len())
        .step_by(small.len().div_ceil(MAX_MAPS).max(1))
        .collect();
    progress.set(0, PlaneSweep::STEPS * looked_at.len());
    let measured: Result<Vec<DepthImage>, StereoError> = looked_at
        .iter()
        .map(|&index| measured(set, &centers, &small, &views, index, progress))
        .collect();
    let looking: Vec<View<'_>> = looked_at.iter().map(|&index| views[index]).collect();
    let measured = measured.ok()?;
    // Specks of fewer than 30 pixels stay: when they were removed, as pairwise stereo does, a room and a temple had
    // 22.47 and 21.14 dB instead of 23.09 and 21.26.
    let retained = consistent(&measured, &looking, Consistency::default()).ok()?;
    let of_two = consistent(&measured, &looking, OF_TWO).ok()?;
    let maps = retained.into_iter().zip(looking).zip(&looked_at);
    let mut maps: Vec<Map<'_>> = maps
        .map(|((retained, view), &index)| Map {
            view,
            number: small[index].number,
            is_measured: retained.metres().iter().map(|&depth| depth > 0.0).collect(),
            depths: retained.metres().to_vec(),
        })
        .collect();
    forget_doubted(&mut maps);
    // With depths of three views only, as for an ordinary cloud: 20.96 dB, 0.67 drawn, instead of 23.09, 0.90 (room).
    // Depths from two views and those carried over are worth 1.2 dB over the whole image.
    add_pairs(&mut maps, &of_two);
    add_points(set, &mut maps);
    carry_over(&mut maps);
    maps.par_iter_mut()
        .zip(&looked_at)
        // Measured depths stay next to depth discontinuities: with those within two pixels filled in again by colours,
        // 23.08 instead of 23.09 dB. Without unconfirmed ones beyond 10 px from known depths: 23.62 dB, 0.89 drawn
        // (room), 20.45, 0.32 (temple), before carrying over.
        .for_each(|(map, &index)| map.complete(&small[index].is_scene));
    let surface = fuse(&maps, origin);
    (!surface.points.is_empty()).then_some(surface)
}

/// Returns the depths of a view measured by the plane sweep.
fn measured(
    set: &ViewSet,
    centers: &[DVec3],
    small: &[Small],
    views: &[View<'_>],
    index: usize,
    progress: &Progress,
) -> Result<DepthImage, StereoError> {
    let of_one = &small[index];
    let nothing = || vec![0.0; of_one.image.pixels().len()];
    let center = centers.get(of_one.number);
    let others = center
        .into_iter()
        .flat_map(|&center| telling(set, center, of_one.number));
    let others: Vec<View<'_>> = others
        .filter_map(|other| Some(views[small.iter().position(|small| small.number == other)?]))
        .take(NEIGHBOURS)
        .collect();
    let range = depth_range(set, of_one.number, center.copied(), AROUND_CENTER);
    let depths = match range {
        Some([near, far]) if !others.is_empty() => {
            let found = PlaneSweep::between(near, far).depths_observed(&views[index], &others, progress)?;
            let pixels = found.metres().iter().zip(&of_one.is_scene);
            pixels
                .map(|(&depth, &is_scene)| if is_scene { depth } else { 0.0 })
                .collect()
        }
        _ => {
            progress.advance(PlaneSweep::STEPS);
            nothing()
        }
    };
    DepthImage::new(of_one.image.size_px(), depths).ok_or(StereoError::Cancelled)
}

/// Adds depths of sparse points where there are none. Points are wrong at times: only those count that three images see
/// at their position, not too much from the same side, and that no view looks through.
fn add_points(set: &ViewSet, maps: &mut [Map<'_>]) {
    let mut added = Vec::new();
    for (point, &position) in set.points.positions().iter().enumerate() {
        let track = set.points.track(point);
        if !is_sound(set, position, track) || is_looked_through(maps, position) {
            continue;
        }
        for seen in track {
            let Ok(index) = maps.binary_search_by_key(&(seen.photo as usize), |map| map.number) else {
                continue;
            };
            let there = maps[index].at_place(position);
            if let Some((at, distance)) = there.filter(|&(at, _)| !maps[index].is_measured[at]) {
                added.push((index, at, distance));
            }
        }
    }
    for (index, at, distance) in added {
        maps[index].depths[at] = distance as f32;
    }
}

/// Returns true if enough images see a point at its position, from directions that determine how far away it is.
fn is_sound(set: &ViewSet, position: DVec3, track: &[Observation]) -> bool {
    let mut directions: Vec<DVec3> = Vec::new();
    for seen in track {
        let Some(photo) = set.photos.get(seen.photo as usize) else {
            continue;
        };
        let found = photo.project(position);
        if found.is_none_or(|found| found.distance(seen.pixel.as_dvec2()) > MAX_OFF_PX) {
            return false;
        }
        directions.push((position - photo.center()).normalize_or_zero());
    }
    let [Some(first), Some(_), Some(_)] = [directions.first(), directions.get(1), directions.get(2)] else {
        return false;
    };
    directions.iter().any(|way| way.dot(*first) < MIN_ANGLE.cos())
}

impl Small {
    fn of(posed_image: &PosedImage) -> Option<Self> {
        let levels = posed_image.texture.levels();
        let is_small = |size: [u32; 2]| size[0].max(size[1]) <= MAX_SIDE_PX;
        let level = levels
            .iter()
            .find(|level| is_small(level.size_px()))
            .or(levels.last())?;
        let pixels = level.pixels();
        let colors = pixels.iter().map(|&[red, green, blue, _]| [red, green, blue]).collect();
        Some(Self {
            number: posed_image.number,
            camera: resized(&posed_image.pinhole, level.size_px()).ok()?,
            camera_from_world: posed_image.camera_from_world,
            image: ColorImage::new(level.size_px(), colors)?,
            is_scene: pixels.iter().map(|pixel| pixel[3] == u8::MAX).collect(),
        })
    }

    fn view(&self) -> View<'_> {
        View {
            image: &self.image,
            camera: &self.camera,
            camera_from_world: self.camera_from_world,
        }
    }
}
