//! Loading of all input images of a set, as renderers need them. A problem with one of them affects only that one.

use super::budget::halvings_within;
use super::gains::gains;
use super::photo_image::PhotoImage;
use super::photos::{PosedImage, PosedImages};
use super::prepared::PreparedPhoto;
use super::shared_points::shared_points;
use super::texture::Texture;
use super::undistort::Extent;
use crate::photos::sets::view_set::ViewSet;
use crate::photos::{DepthCamera, DepthFile, DepthKind, Photo, PhotosError};
use crate::progress::Progress;
use crate::rgbd::{Camera, ColorCamera, DepthImage, Distortion, RayTable, on_planes};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Maximum side length of a texture, supported by all GPUs.
const MAX_SIDE_PX: u32 = 8192;

/// Input images whose pixels were loaded, and the problems with others.
#[derive(Debug)]
pub struct LoadedPhotos {
    /// The images that could be loaded.
    pub posed_images: Arc<PosedImages>,
    /// Notes on the images that could not be loaded, one sentence each.
    pub notes: Vec<String>,
}

/// An input image that was read.
struct Read {
    prepared: PreparedPhoto,
    /// True if transparent pixels are the background, and not only those beyond the lens.
    is_masked: bool,
    depth: Option<DepthImage>,
    /// Note on the parts of it that could not be read.
    note: Option<String>,
}

impl LoadedPhotos {
    /// Loads the images of `set`, halved alike until all textures together take at most `budget_bytes`. Reports in
    /// `progress` the number of images read; the result is of no use once `progress` was cancelled.
    pub fn of(set: &ViewSet, budget_bytes: u64, progress: &Progress) -> Self {
        let sizes: Vec<[u32; 2]> = set.photos.iter().map(|photo| photo.camera.size_px()).collect();
        let halvings = halvings_within(&sizes, budget_bytes, MAX_SIDE_PX);
        progress.set(0, set.photos.len());
        let read_one = |photo: &Photo| {
            if progress.is_cancelled() || !photo.has_file() {
                return None;
            }
            let read = read(photo, halvings);
            progress.advance(1);
            Some(read)
        };
        let read: Vec<Option<Result<Read, PhotosError>>> = set.photos.par_iter().map(read_one).collect();
        let (mut notes, mut prepared) = (Vec::new(), Vec::new());
        let (mut are_masked, mut depths) = (Vec::new(), Vec::new());
        for read in read {
            let read = read.and_then(|read| {
                read.map_err(|error| notes.push(format!("{error}; the other images are used")))
                    .ok()
            });
            notes.extend(read.as_ref().and_then(|read| read.note.clone()));
            are_masked.push(read.as_ref().is_some_and(|read| read.is_masked));
            let (photo, depth) = read.map(|read| (read.prepared, read.depth)).unzip();
            prepared.push(photo);
            depths.push(depth.flatten());
        }
        let gains = if set.points.observations().is_empty() {
            gains(&shared_points(&prepared, &depths), &prepared)
        } else {
            gains(&set.points, &prepared)
        };
        let pixels = prepared.into_iter().zip(are_masked);
        let all = set.photos.iter().zip(pixels).zip(depths.into_iter().zip(gains));
        let posed_images = all
            .enumerate()
            .filter_map(|(number, ((photo, (prepared, is_masked)), (depth, gain)))| {
                let PreparedPhoto {
                    camera,
                    camera_from_world,
                    image,
                } = prepared?;
                Some(PosedImage {
                    name: photo.name.clone(),
                    number,
                    pinhole: camera,
                    camera_from_world,
                    texture: Texture::new(image),
                    is_masked,
                    gain: Vec3::from_array(gain),
                    depth,
                })
            });
        let mut posed_images = PosedImages::new(posed_images.collect(), set.median_neighbour_angle());
        if !set.has_points() {
            posed_images = posed_images.by_stereo();
        }
        Self {
            posed_images: Arc::new(posed_images),
            notes,
        }
    }
}

/// Broken depths cost these alone.
fn read(photo: &Photo, halvings: u32) -> Result<Read, PhotosError> {
    let image = PhotoImage::read(photo)?;
    let prepared = PreparedPhoto::of(photo, &image, Extent::Same, halvings);
    let depth = photo
        .depth
        .as_ref()
        .map(|file| depth(file, &photo.camera, &prepared.camera));
    let (depth, note) = match depth.transpose() {
        Ok(depth) => (depth.flatten(), None),
        Err(error) => (None, Some(format!("{error}; the image is used without depths"))),
    };
    Ok(Read {
        is_masked: image.pixels().iter().any(|pixel| pixel[3] == 0),
        prepared,
        depth,
        note,
    })
}

/// Reads the depth map that a file has for an input image, as its pinhole sees it, without the noise of planes. Depth
/// maps of COLMAP are of pinholes already.
fn depth(file: &DepthFile, camera: &Camera, pinhole: &Camera) -> Result<Option<DepthImage>, PhotosError> {
    // Smoothed onto planes: a relit image of Redwood showed the noise of its depths. Exact depths stay unchanged.
    let taken = on_planes(&file.read()?);
    if let Some(taken_by) = &file.taken_by {
        return seen_around(file, &taken, taken_by, pinhole).map(Some);
    }
    if *camera.distortion() == Distortion::None || file.kind == DepthKind::Colmap {
        return Ok(Some(taken));
    }
    let [width, height] = pinhole.size_px();
    let size = DVec2::from_array(taken.size_px().map(f64::from));
    let scale = size / DVec2::from_array(camera.size_px().map(f64::from));
    let distances = (0..width * height).into_par_iter().map(|at| {
        let ray = pinhole.ray(DVec2::new(f64::from(at % width), f64::from(at / width)));
        let place = ray
            .and_then(|ray| camera.pixel(ray))
            .filter(|&place| camera.contains(place));
        // Not interpolated: there is no surface between the depths of two surfaces.
        place.map_or(0.0, |place| {
            let [column, row] = ((place + 0.5) * scale).min(size - 1.0).max(DVec2::ZERO).to_array();
            taken.metres()[taken.width() * row as usize + column as usize]
        })
    });
    Ok(DepthImage::new([width, height], distances.collect()))
}

/// Returns the depth map taken by an adjacent camera, as the pinhole of the input image sees it.
fn seen_around(
    file: &DepthFile,
    taken: &DepthImage,
    taken_by: &DepthCamera,
    pinhole: &Camera,
) -> Result<DepthImage, PhotosError> {
    let (found_px, expected_px) = (taken.size_px(), taken_by.camera.size_px());
    if found_px != expected_px {
        return Err(PhotosError::WrongSize {
            path: file.path.clone(),
            expected_px,
            found_px,
        });
    }
    let photo = ColorCamera {
        camera: pinhole.clone(),
        color_from_depth: taken_by.photo_from_depth,
    };
    Ok(photo.depths(taken, &RayTable::of(&taken_by.camera)))
}
