//! Points shared by several images, created from their depth maps: they determine gains if a set has no tracks, as is
//! the case for depth images.

use super::prepared::PreparedPhoto;
use crate::photos::sets::points::{Observation, SparsePoints};
use crate::rgbd::DepthImage;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Sampling grid: the number of pixels of each image that are sampled, across and down, if there are few images.
const GRID: [u32; 2] = [32, 24];

/// Maximum number of images in which each of them is looked for. If there are more, different ones for each pixel,
/// spread evenly.
// Without a limit, 300 merged depth images took 165 s and 5.4 GB instead of 67 s and 1.8 GB (two cores, Intel Xeon).
const MAX_OTHERS: usize = 48;

/// Approximate maximum number of lookups in total: gains take hundreds of rounds over the results. If it would be
/// exceeded, fewer pixels are sampled.
const MAX_LOOKS: usize = 1 << 21;

/// Two depths are of one place if they differ by less, as a part.
const TOLERANCE: f64 = 0.02;

/// Finds the points of a grid of pixels of each image that are seen by all others according to their depth maps: of
/// some images if there are hundreds. Images without depth maps see nothing.
pub(in crate::photos) fn shared_points(
    photos: &[Option<PreparedPhoto>],
    depths: &[Option<DepthImage>],
) -> SparsePoints {
    let count = photos.len();
    let grid = grid_for(count);
    let with_depths = |at: usize| photos[at].as_ref().zip(depths[at].as_ref());
    let of_photo = |at: usize| -> Vec<(DVec3, Vec<Observation>)> {
        let Some((photo, depth)) = with_depths(at) else {
            return Vec::new();
        };
        let world_from_camera = photo.camera_from_world.inverse();
        let size = DVec2::from_array(photo.camera.size_px().map(f64::from));
        let pixels = (0..grid[0] * grid[1]).map(|cell| {
            let share = DVec2::new(
                (f64::from(cell % grid[0]) + 0.5) / f64::from(grid[0]),
                (f64::from(cell / grid[0]) + 0.5) / f64::from(grid[1]),
            );
            (cell as usize, share, share * size - 0.5)
        });
        let points = pixels.filter_map(|(cell, share, pixel)| {
            let distance = distance_at(depth, share).filter(|&distance| distance > 0.0)?;
            let place = world_from_camera.transform_point3(distance * photo.camera.ray(pixel)?);
            let own = Observation {
                photo: at as u32,
                pixel: pixel.as_vec2(),
            };
            let seen = others(at, cell, count).filter_map(|other| {
                let (photo, depth) = with_depths(other)?;
                Some(Observation {
                    photo: other as u32,
                    pixel: sees(photo, depth, place)?.as_vec2(),
                })
            });
            Some((place, std::iter::once(own).chain(seen).collect()))
        });
        points.collect()
    };
    let mut shared = SparsePoints::default();
    let by_photo: Vec<Vec<(DVec3, Vec<Observation>)>> = (0..photos.len()).into_par_iter().map(of_photo).collect();
    for (place, track) in by_photo.into_iter().flatten() {
        shared.push(place, [0; 3], track);
    }
    shared
}

/// Returns the sampling grid, i.e. pixels across and down, of each of `count` images.
fn grid_for(count: usize) -> [u32; 2] {
    let looks = count * count.min(MAX_OTHERS) * (GRID[0] * GRID[1]) as usize;
    let share = (MAX_LOOKS as f64 / looks.max(1) as f64).min(1.0).sqrt();
    GRID.map(|pixels| ((share * f64::from(pixels)).round() as u32).max(1))
}

/// Returns the images in which pixel `cell` of image `at` is looked for.
fn others(at: usize, cell: usize, count: usize) -> impl Iterator<Item = usize> {
    let max = count.min(MAX_OTHERS);
    let spread = (0..max).map(move |place| (at + cell + place * count / max) % count);
    spread.filter(move |&other| other != at)
}

/// The pixel that shows a place, if the depth there matches the place.
fn sees(photo: &PreparedPhoto, depth: &DepthImage, place: DVec3) -> Option<DVec2> {
    let in_camera = photo.camera_from_world.transform_point3(place);
    let pixel = photo
        .camera
        .pixel(in_camera)
        .filter(|&pixel| photo.camera.contains(pixel))?;
    let size = DVec2::from_array(photo.camera.size_px().map(f64::from));
    let there = distance_at(depth, (pixel + 0.5) / size)?;
    ((there - in_camera.z).abs() <= TOLERANCE * in_camera.z).then_some(pixel)
}

/// The distance at a share of width and height.
fn distance_at(depth: &DepthImage, share: DVec2) -> Option<f64> {
    let size = DVec2::from_array(depth.size_px().map(f64::from));
    let [column, row] = (share * size).clamp(DVec2::ZERO, size - 1.0).to_array();
    depth
        .metres()
        .get(depth.width() * row as usize + column as usize)
        .map(|&metres| f64::from(metres))
}

#[cfg(test)]
mod tests {
    use super::super::gains::gains;
    use super::super::photo_image::PhotoImage;
    use super::*;
    use crate::rgbd::{Camera, Distortion};
    use glam::DAffine3;

    /// A wall at a depth of 2, seen from `x`, `gain` times as bright; depths of another wall where `wrong`.
    fn photo(x: f64, gain: f32, wrong: bool) -> (Option<PreparedPhoto>, Option<DepthImage>) {
        let camera = Camera::new(
            [160, 120],
            DVec2::splat(150.0),
            DVec2::new(79.5, 59.5),
            Distortion::None,
        );
        let pixels = (0..160 * 120).map(|at| {
            let across = (f64::from(at % 160) - 79.5) / 150.0 * 2.0 + x;
            let color = gain * (100.0 + 50.0 * (3.0 * across).sin() as f32);
            [color as u8, color as u8, color as u8, 255]
        });
        let photo = PreparedPhoto {
            camera: camera.unwrap(),
            camera_from_world: DAffine3::from_translation(DVec3::new(-x, 0.0, 0.0)),
            image: PhotoImage::new([160, 120], pixels.collect()).unwrap(),
        };
        // Half as large as the image.
        let depth = DepthImage::new([80, 60], vec![if wrong { 1.5 } else { 2.0 }; 80 * 60]);
        (Some(photo), depth)
    }

    #[test]
    fn exposures_are_estimated_from_depths_and_wrong_depths_share_no_points() {
        let (photos, depths): (Vec<_>, Vec<_>) =
            [photo(0.0, 1.0, false), photo(0.2, 0.7, false), photo(0.1, 1.0, true)]
                .into_iter()
                .unzip();
        let shared = shared_points(&photos, &depths);
        assert_eq!(shared.len(), 3 * 32 * 24);
        let gains = gains(&shared, &photos);
        assert!((gains[1][0] / gains[0][0] - 1.0 / 0.7).abs() < 0.05, "{gains:?}");
        assert_eq!(gains[2], [1.0; 3]);
    }

    #[test]
    fn few_images_are_matched_with_all_others_and_many_with_some() {
        assert_eq!(grid_for(3), GRID);
        for cell in [0, 7] {
            let mut all: Vec<usize> = others(2, cell, 5).collect();
            all.sort_unstable();
            assert_eq!(all, [0, 1, 3, 4]);
        }
        for count in [48, 49, 300, 1000, 100_000] {
            let [across, down] = grid_for(count);
            let looks = count * count.min(MAX_OTHERS) * (across * down) as usize;
            assert!(looks < 2 * MAX_LOOKS || [across, down] == [1, 1], "{looks} of {count}");
        }
        // Among a thousand, an image shares some pixel with most of the others.
        let [across, down] = grid_for(1000);
        let mut met: Vec<usize> = (0..(across * down) as usize)
            .flat_map(|cell| others(500, cell, 1000))
            .collect();
        met.sort_unstable();
        met.dedup();
        assert!(met.len() > 900, "{}", met.len());
    }

    #[test]
    fn images_without_depths_share_no_points() {
        let (photos, _): (Vec<_>, Vec<_>) = [photo(0.0, 1.0, false), photo(0.2, 0.7, false)].into_iter().unzip();
        assert!(shared_points(&photos, &[None, None]).is_empty());
        assert!(shared_points(&[None], &[None]).is_empty());
    }
}
