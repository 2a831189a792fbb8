//! The pixels of calibrated photographs: decoded, without distortion, scaled to a budget.
//!
//! *How it works.* Photographs are decoded one on each thread, and their lens is undone and their size changed in one
//! step: each pixel of the pinhole that is wanted asks its own ray which place of the photograph shows it, and takes
//! the mean of what it covers there. So nothing is interpolated twice. A photograph without distortion that keeps its
//! size is taken as it is.
//!
//! What is wrong with one photograph costs that one, and a sentence says so.

use super::photo::{Photo, resized};
use super::photographs::{Photograph, Photographs};
use super::texture::{Texel, Texture};
use super::view_set::ViewSet;
use super::{DepthKind, PhotosError, colmap_depth};
use crate::progress::Progress;
use crate::rgbd::{Camera, DepthImage, Distortion};
use glam::{DVec2, Vec3};
use image::{ImageReader, RgbaImage};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// What mip levels add to a picture: a quarter, a sixteenth and so on.
const WITH_LEVELS: f64 = 4.0 / 3.0;

/// Photographs whose pixels were loaded, and what was wrong with others.
#[derive(Debug)]
pub struct LoadedPhotographs {
    /// Those that could be loaded.
    pub photographs: Arc<Photographs>,
    /// What could not be, a sentence each.
    pub notes: Vec<String>,
}

impl LoadedPhotographs {
    /// Those of `set`, scaled alike so that all texels together take at most `budget_bytes`. Says in `progress` how
    /// many are loaded; what it returns after that was cancelled is of no use.
    pub fn of(set: &ViewSet, budget_bytes: usize, progress: &Progress) -> Self {
        let scale = scale_within(set, budget_bytes);
        progress.set(0, set.photos.len());
        let results: Vec<Option<Result<Photograph, PhotosError>>> = set
            .photos
            .par_iter()
            .enumerate()
            .map(|(number, photo)| {
                if progress.is_cancelled() {
                    return None;
                }
                let loaded = load(photo, number, scale);
                progress.advance(1);
                Some(loaded)
            })
            .collect();
        let (mut photographs, mut notes) = (Vec::new(), Vec::new());
        for result in results.into_iter().flatten() {
            match result {
                Ok(photograph) => photographs.push(photograph),
                Err(error) => notes.push(format!("{error}; the other photographs are used")),
            }
        }
        Self {
            photographs: Arc::new(Photographs::new(photographs, set.median_neighbour_angle())),
            notes,
        }
    }
}

/// The factor on the edges of all photographs, 1 at most.
fn scale_within(set: &ViewSet, budget_bytes: usize) -> f64 {
    let bytes = set.photos.iter().map(|photo| {
        let [width, height] = photo.camera.size_px().map(f64::from);
        WITH_LEVELS * width * height * size_of::<Texel>() as f64
    });
    (budget_bytes as f64 / bytes.sum::<f64>()).sqrt().min(1.0)
}

fn load(photo: &Photo, number: usize, scale: f64) -> Result<Photograph, PhotosError> {
    let mut picture = decode(&photo.path)?;
    let expected_px = photo.camera.size_px();
    if picture.dimensions() != expected_px.into() {
        return Err(PhotosError::WrongSize {
            path: photo.path.clone(),
            expected_px,
            found_px: picture.dimensions().into(),
        });
    }
    let mut is_masked = picture.pixels().any(|pixel| pixel[3] == 0);
    if let Some(mask) = &photo.mask {
        cut_out(&mut picture, &decode(mask)?);
        is_masked = true;
    }
    let texels: Vec<Texel> = picture.into_raw().as_chunks().0.to_vec();
    let no_pixels = || PhotosError::invalid(&photo.path, "its header", "expected some pixels, found none");
    let taken = Texture::new(expected_px, texels).ok_or_else(no_pixels)?;
    let size_px = expected_px.map(|edge| ((f64::from(edge) * scale).round() as u32).max(1));
    let pinhole = pinhole_of(&photo.camera, size_px).ok_or_else(no_pixels)?;
    let is_as_taken = size_px == expected_px && *photo.camera.distortion() == Distortion::None;
    let texture = if is_as_taken {
        taken
    } else {
        let texels = undistorted(&photo.camera, &taken, &pinhole);
        Texture::new(size_px, texels).ok_or_else(no_pixels)?
    };
    Ok(Photograph {
        name: photo.name.clone(),
        number,
        pinhole,
        camera_from_world: photo.camera_from_world,
        texture,
        is_masked,
        gain: Vec3::ONE,
        depth: depth_of(photo)?,
    })
}

fn decode(path: &Path) -> Result<RgbaImage, PhotosError> {
    let io = |source| PhotosError::Io {
        path: path.into(),
        source,
    };
    let reader = ImageReader::open(path).map_err(io)?.with_guessed_format().map_err(io)?;
    let picture = reader.decode().map_err(|source| PhotosError::Picture {
        path: path.into(),
        source,
    })?;
    Ok(picture.into_rgba8())
}

/// Makes transparent what is dark in a mask, which may have another size.
fn cut_out(picture: &mut RgbaImage, mask: &RgbaImage) {
    let [width, height] = [picture.width(), picture.height()];
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let at = |place: u32, edge: u32, of_mask: u32| (u64::from(place) * u64::from(of_mask) / u64::from(edge)) as u32;
        let of_mask = mask.get_pixel(at(x, width, mask.width()), at(y, height, mask.height()));
        let bright = of_mask.0[..3].iter().copied().max().unwrap_or_default();
        pixel[3] = bright.min(of_mask[3]).min(pixel[3]);
    }
}

/// The same camera without distortion, for pictures of `size_px`.
fn pinhole_of(camera: &Camera, size_px: [u32; 2]) -> Option<Camera> {
    let straight = Camera::new(
        camera.size_px(),
        camera.focal_px(),
        camera.principal_px(),
        Distortion::None,
    );
    resized(&straight.ok()?, size_px).ok()
}

/// What `pinhole` sees of a photograph that `camera` took; transparent where that shows nothing.
fn undistorted(camera: &Camera, taken: &Texture, pinhole: &Camera) -> Vec<Texel> {
    let [width, height] = pinhole.size_px().map(|edge| edge as usize);
    // How many pixels of the photograph one of these covers, in the middle of the picture.
    let shrunk = camera.focal_px() / pinhole.focal_px();
    let level = shrunk.max_element().max(1.0).log2();
    let mut texels = vec![[0; 4]; width * height];
    texels.par_chunks_mut(width).enumerate().for_each(|(row, texels)| {
        for (column, texel) in texels.iter_mut().enumerate() {
            let ray = pinhole.ray(DVec2::new(column as f64, row as f64));
            let place = ray
                .and_then(|ray| camera.pixel(ray))
                .filter(|&place| camera.contains(place));
            if let Some(place) = place {
                let [red, green, blue, alpha] = taken.between_texels((place.as_vec2() + 0.5).to_array(), level as f32);
                let byte = |value: f32| (255.0 * value + 0.5) as u8;
                let per_alpha = 1.0 / alpha.max(f32::MIN_POSITIVE);
                *texel = [red * per_alpha, green * per_alpha, blue * per_alpha, alpha].map(byte);
            }
        }
    });
    texels
}

/// The depths that a file says.
fn depth_of(photo: &Photo) -> Result<Option<DepthImage>, PhotosError> {
    let Some(file) = &photo.depth else {
        return Ok(None);
    };
    match file.kind {
        DepthKind::Colmap => colmap_depth(&file.path).map(Some),
        DepthKind::Scaled(unit) => {
            let picture = ImageReader::open(&file.path).map_err(|source| PhotosError::Io {
                path: file.path.clone(),
                source,
            })?;
            let picture = picture.decode().map_err(|source| PhotosError::Picture {
                path: file.path.clone(),
                source,
            })?;
            let values = picture.to_luma16();
            let distances = values.pixels().map(|value| (f64::from(value[0]) * unit) as f32);
            Ok(DepthImage::new(values.dimensions().into(), distances.collect()))
        }
    }
}
