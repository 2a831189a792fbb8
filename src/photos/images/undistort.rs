//! Undistortion of input images, performed once, so that drawing has pinholes alone.
//!
//! *How it works.* A pixel of the pinhole looks along a ray; the lens shows that ray at a position of the input image,
//! whose colour is interpolated between four pixels. Anything that the input image does not show gets alpha 0. The
//! focal length stays, so that the centre keeps its resolution; towards the corners of a barrel lens the result is
//! softer than the input image.

use super::photo_image::PhotoImage;
use crate::rgbd::{Camera, Distortion};
use glam::DVec2;
use rayon::prelude::*;

/// Extent of an undistorted image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extent {
    /// Same size in pixels as the input image: corners of barrel lenses are cut off.
    #[default]
    Same,
    /// Everything that the input image shows, up to twice its width and height.
    Covering,
}

/// Maximum growth in width and height of the pinhole that covers everything, relative to the input image: images of
/// fisheyes have no end.
const MAX_GROWTH: i64 = 2;

/// Places on a side of the border that are looked at.
const BORDER_STEPS: u32 = 256;

/// Places between the axis and the border.
const WAY_STEPS: u32 = 64;

/// The pinhole with the field of view of `camera`. Its pixels are those of `camera` around the axis.
pub fn pinhole_of(camera: &Camera, extent: Extent) -> Camera {
    let [width, height] = camera.size_px();
    let is_pinhole = *camera.distortion() == Distortion::None;
    let (size_px, shift_px) = match extent {
        Extent::Covering if !is_pinhole => covering(camera),
        Extent::Same | Extent::Covering => ([width, height], DVec2::ZERO),
    };
    let principal_px = camera.principal_px() + shift_px;
    // Without its lens, the camera of an image with pixels is still valid.
    Camera::new(size_px, camera.focal_px(), principal_px, Distortion::None).unwrap_or_else(|_| camera.clone())
}

/// The size of the image of all directions, and how far its pixels are moved.
fn covering(camera: &Camera) -> ([u32; 2], DVec2) {
    let [width, height] = camera.size_px();
    let (right, bottom) = (f64::from(width) - 0.5, f64::from(height) - 0.5);
    let border = (0..=BORDER_STEPS).flat_map(|step| {
        let share = f64::from(step) / f64::from(BORDER_STEPS);
        let (x, y) = (-0.5 + share * f64::from(width), -0.5 + share * f64::from(height));
        [[x, -0.5], [x, bottom], [-0.5, y], [right, y]].map(DVec2::from_array)
    });
    // Where the lens does not image the border, the farthest imaged position on the way there.
    let center = camera.principal_px();
    let straight = border.filter_map(|pixel| {
        let on_the_way = |step: u32| center + (pixel - center) * (f64::from(step) / f64::from(WAY_STEPS));
        let ray = (1..=WAY_STEPS).rev().find_map(|step| camera.ray(on_the_way(step)))?;
        Some(ray.truncate() * camera.focal_px() + center)
    });
    let same = (DVec2::splat(-0.5), DVec2::new(right, bottom));
    let (low, high) = straight
        .map(|at| (at, at))
        .reduce(|(low, high), (at, _)| (low.min(at), high.max(at)))
        .unwrap_or(same);
    // Slightly more than a whole number of pixels does not add another one.
    let low_px = (low + 0.5 + 1e-6).floor();
    let high_px = (high + 0.5 - 1e-6).ceil();
    let side = |axis: usize, side: u32| {
        let (side, from, to) = (i64::from(side), low_px[axis] as i64, high_px[axis] as i64);
        let space = (MAX_GROWTH - 1) * side / 2;
        let (from, to) = (from.clamp(-space, side - 1), to.clamp(1, side + space));
        (from, (to - from).clamp(1, MAX_GROWTH * side) as u32)
    };
    let ((left, columns), (top, rows)) = (side(0, width), side(1, height));
    ([columns, rows], -DVec2::new(left as f64, top as f64))
}

/// Undistorts the image `image` of camera `from` into the view of `to`. Both cameras have the same position and the
/// same viewing direction.
pub fn undistort(image: &PhotoImage, from: &Camera, to: &Camera) -> PhotoImage {
    if from == to && image.size_px() == to.size_px() {
        return image.clone();
    }
    let [width, _] = to.size_px();
    let [columns, rows] = to.size_px().map(|side| side as usize);
    let mut pixels = vec![[0; 4]; columns * rows];
    pixels
        .par_chunks_exact_mut(columns)
        .enumerate()
        .for_each(|(row, line)| {
            for (pixel, column) in line.iter_mut().zip(0..width) {
                let ray = to.ray(DVec2::new(f64::from(column), row as f64));
                let at = ray.and_then(|ray| from.pixel(ray)).filter(|&at| from.contains(at));
                if let Some(at) = at {
                    *pixel = image.bilinear(at).map(|value| (value + 0.5) as u8);
                }
            }
        });
    PhotoImage::new(to.size_px(), pixels).unwrap_or_else(|| image.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(distortion: Distortion) -> Camera {
        Camera::new(
            [200, 150],
            DVec2::new(160.0, 158.0),
            DVec2::new(104.0, 71.0),
            distortion,
        )
        .unwrap()
    }

    fn lenses() -> Vec<Distortion> {
        let p = [1e-3, -2e-3];
        vec![
            Distortion::Brown {
                k: [-0.25, 0.06, 0.0],
                p,
            },
            Distortion::Brown { k: [0.2, 0.0, 0.0], p },
            Distortion::Fisheye {
                k: [-0.01, 0.02, 0.0, 0.0],
            },
        ]
    }

    /// A smooth colour for each direction.
    fn color(at: DVec2) -> [f64; 3] {
        [7.0 * at.x, 6.0 * at.y, 5.0 * (at.x + at.y)].map(|angle| 127.0 + 120.0 * angle.sin())
    }

    fn painted(camera: &Camera) -> PhotoImage {
        let [width, height] = camera.size_px();
        let pixel = |column: u32, row: u32| {
            let ray = camera.ray(DVec2::new(f64::from(column), f64::from(row)));
            ray.map_or([0; 4], |ray| {
                let [r, g, b] = color(ray.truncate()).map(|value| value.round() as u8);
                [r, g, b, 255]
            })
        };
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| pixel(column, row)));
        PhotoImage::new([width, height], pixels.collect()).unwrap()
    }

    #[test]
    fn undistorted_images_show_each_direction_where_a_pinhole_does() {
        for lens in lenses() {
            let curved = camera(lens);
            for extent in [Extent::Same, Extent::Covering] {
                let straight = pinhole_of(&curved, extent);
                let image = undistort(&painted(&curved), &curved, &straight);
                let expected = painted(&straight);
                assert_eq!(image.size_px(), expected.size_px());
                let (mut seen, mut worst) = (0, 0);
                for (at, (found, expected)) in image.pixels().iter().zip(expected.pixels()).enumerate() {
                    let column = at as u32 % image.size_px()[0];
                    let row = at as u32 / image.size_px()[0];
                    let ray = straight.ray(DVec2::new(f64::from(column), f64::from(row))).unwrap();
                    let from = curved.pixel(ray).unwrap_or(DVec2::NAN);
                    // Beyond the centres of the border pixels there is nothing to interpolate.
                    if from.cmpge(DVec2::ZERO).all() && from.cmple(DVec2::new(199.0, 149.0)).all() {
                        seen += 1;
                        worst = (0..4).map(|c| found[c].abs_diff(expected[c])).fold(worst, u8::max);
                    }
                }
                assert!(worst <= 2, "{worst} of {lens:?}");
                assert!(seen > 20_000, "{seen} of {lens:?}");
            }
        }
    }

    #[test]
    fn the_covering_pinhole_loses_nothing() {
        for lens in lenses() {
            let curved = camera(lens);
            let straight = pinhole_of(&curved, Extent::Covering);
            let (mut shown, mut all) = (0, 0);
            for row in 0..150 {
                for column in 0..200 {
                    let ray = curved.ray(DVec2::new(f64::from(column), f64::from(row))).unwrap();
                    all += 1;
                    shown += u32::from(straight.pixel(ray).is_some_and(|pixel| straight.contains(pixel)));
                }
            }
            assert_eq!(shown, all, "{lens:?} in {:?}", straight.size_px());
            // And it is no larger than needed: each side reaches a border of it.
            let image = undistort(&painted(&curved), &curved, &straight);
            let [width, height] = image.size_px().map(|side| side as usize);
            let alpha = |column: usize, row: usize| image.pixels()[row * width + column][3] > 0;
            // Up to the half pixel covered by the first and the last row.
            let on_border = [1, height - 2].map(|row| (0..width).any(|column| alpha(column, row)));
            let outside = [1, width - 2].map(|column| (0..height).any(|row| alpha(column, row)));
            assert_eq!((on_border, outside), ([true; 2], [true; 2]), "{lens:?}");
        }
        let wide = Camera::new(
            [200, 200],
            DVec2::splat(64.0),
            DVec2::splat(99.5),
            Distortion::Fisheye { k: [0.0; 4] },
        );
        assert_eq!(pinhole_of(&wide.unwrap(), Extent::Covering).size_px(), [400, 400]);
    }

    #[test]
    fn pixels_outside_the_image_are_transparent() {
        let pincushion = camera(lenses()[1]);
        let straight = pinhole_of(&pincushion, Extent::Same);
        let image = undistort(&painted(&pincushion), &pincushion, &straight);
        // A pincushion lens moves points outward, so that the corners of the pinhole image are outside its image.
        assert_eq!(image.pixels()[0], [0; 4]);
        assert_eq!(image.pixels()[75 * 200 + 100][3], 255);
    }

    #[test]
    fn a_pinhole_image_is_unchanged() {
        let pinhole = camera(Distortion::None);
        for extent in [Extent::Same, Extent::Covering] {
            let same = pinhole_of(&pinhole, extent);
            assert_eq!(same, pinhole);
            assert_eq!(undistort(&painted(&pinhole), &pinhole, &same), painted(&pinhole));
        }
    }
}
