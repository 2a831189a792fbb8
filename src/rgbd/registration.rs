//! Registration of depth and colour images: colours for the pixels of a depth image, out of an image that another
//! camera took, and depths for that image.
//!
//! *How it works.* The point of a depth pixel is moved into the frame of the colour camera and projected there. The
//! nearest point at a place of that view hides those behind it, so a depth buffer of the points themselves is drawn
//! first. Its cells are as wide as the steps between neighbours of the depth image, and a point is drawn into the four
//! cells around it: surfaces have no gaps through which points behind them would take their colour.

use super::camera::Camera;
use super::images::{ColorImage, DepthImage};
use super::rays::RayTable;
use glam::{DAffine3, DVec2, DVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// The colour of points that the colour camera does not see.
pub const UNSEEN_COLOR: [u8; 4] = [128, 128, 128, 255];

/// Distance behind the nearest point from which a point is hidden, in metres.
const HIDDEN_BY_M: f64 = 0.02;

/// Occlusion threshold as a fraction of the point's distance: depth is less exact the further away.
const HIDDEN_BY_SHARE: f64 = 0.02;

/// Colour camera alongside the depth camera.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorCamera {
    /// Its image.
    pub camera: Camera,
    /// From the frame of the depth camera to its own: `X_c = R·X_d + t`.
    pub color_from_depth: DAffine3,
}

/// A point in the view of the colour camera.
#[derive(Debug, Clone, Copy)]
struct ProjectedPoint {
    pixel: DVec2,
    z: f64,
}

impl ColorCamera {
    /// The colour of each pixel of `depth`, opaque; [`UNSEEN_COLOR`] where there is no depth, and where the camera does
    /// not see the point because it is outside of the image or behind another one.
    ///
    /// Preconditions: `rays` are of an image of the same size as `depth`, `image` is of the size of the camera's.
    pub fn colors(&self, depth: &DepthImage, rays: &RayTable, image: &ColorImage) -> Vec<[u8; 4]> {
        debug_assert_eq!(image.size_px(), self.camera.size_px());
        let seen = self.see_all(depth, rays);
        let nearest = NearestDepth::of(&seen, depth.width(), &self.camera);
        let color = |seen: &Option<ProjectedPoint>| match seen {
            Some(seen) if nearest.shows(*seen) => {
                let [r, g, b] = image.bilinear(seen.pixel.as_vec2().to_array());
                [r, g, b, 255]
            }
            _ => UNSEEN_COLOR,
        };
        seen.par_iter().map(color).collect()
    }

    /// The depths of this camera's own image, as far as `depth` has them; 0 elsewhere. Where several places fall on one
    /// pixel, the nearest counts. The image has the shape of the camera's, and fewer pixels if neighbours of `depth`
    /// are farther apart than those: so it has no holes between them.
    ///
    /// Precondition: `rays` are of an image of the same size as `depth`.
    pub fn depths(&self, depth: &DepthImage, rays: &RayTable) -> DepthImage {
        let seen = self.see_all(depth, rays);
        let of_camera = DVec2::from_array(self.camera.size_px().map(f64::from));
        let size_px = (of_camera / step_px(&seen, depth.width())).round().max(DVec2::ONE);
        let (scale, last) = (size_px / of_camera, size_px - 1.0);
        let (width, height) = (size_px.x as usize, size_px.y as usize);
        let mut nearest = vec![f32::INFINITY; width * height];
        for &ProjectedPoint { pixel, z } in seen.iter().flatten() {
            // The four around it, as neighbours are about a pixel apart.
            let before = ((pixel + 0.5) * scale - 0.5).floor();
            for aside in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
                let place = (before + aside).clamp(DVec2::ZERO, last);
                let there = &mut nearest[place.y as usize * width + place.x as usize];
                *there = there.min(z as f32);
            }
        }
        DepthImage::new([width as u32, height as u32], nearest).expect("one depth per pixel of the image")
    }

    fn see_all(&self, depth: &DepthImage, rays: &RayTable) -> Vec<Option<ProjectedPoint>> {
        let pixels = depth.metres().par_iter().zip(rays.rays());
        pixels.map(|(&z, &ray)| self.see(z, ray)).collect()
    }

    fn see(&self, z: f32, [x, y]: [f32; 2]) -> Option<ProjectedPoint> {
        if !(z > 0.0 && x.is_finite()) {
            return None;
        }
        // The lens model in double precision dominates the time: 24 ms for 640 × 480 pixels (one thread, AMD EPYC),
        // where range, median, bilateral filter and flying pixels together take 10.1 ms.
        let point = f64::from(z) * DVec3::new(f64::from(x), f64::from(y), 1.0);
        let point = self.color_from_depth.transform_point3(point);
        let pixel = self.camera.pixel(point)?;
        self.camera
            .contains(pixel)
            .then_some(ProjectedPoint { pixel, z: point.z })
    }
}

/// The depth buffer of the points in the view of the colour camera.
struct NearestDepth {
    /// Bits of depths above 0, which are in the order of the depths.
    cells: Vec<AtomicU32>,
    columns: usize,
    rows: usize,
    cell_px: f64,
}

impl NearestDepth {
    fn of(seen: &[Option<ProjectedPoint>], width: usize, camera: &Camera) -> Self {
        // Finer cells would leave gaps, and surfaces behind a gap would take the colour of those in front of them.
        let cell_px = step_px(seen, width);
        let cells_along = |pixels: u32| (f64::from(pixels) / cell_px).ceil() as usize + 2;
        let [columns, rows] = camera.size_px().map(cells_along);
        let far = || AtomicU32::new(f32::INFINITY.to_bits());
        let buffer = Self {
            cells: std::iter::repeat_with(far).take(columns * rows).collect(),
            columns,
            rows,
            cell_px,
        };
        seen.par_iter().flatten().for_each(|&seen| buffer.draw(seen));
        buffer
    }

    /// The cell whose centre is nearest before a place, along both axes.
    fn corner(&self, pixel: DVec2) -> DVec2 {
        ((pixel + 0.5) / self.cell_px).max(DVec2::ZERO)
    }

    fn draw(&self, ProjectedPoint { pixel, z }: ProjectedPoint) {
        let corner = self.corner(pixel).floor();
        let bits = (z as f32).to_bits();
        for (right, down) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let column = (corner.x as usize + right).min(self.columns - 1);
            let row = (corner.y as usize + down).min(self.rows - 1);
            self.cells[row * self.columns + column].fetch_min(bits, Ordering::Relaxed);
        }
    }

    /// Returns true if the point is not occluded at its position.
    fn shows(&self, ProjectedPoint { pixel, z }: ProjectedPoint) -> bool {
        let cell = self.corner(pixel).round();
        let column = (cell.x as usize).min(self.columns - 1);
        let row = (cell.y as usize).min(self.rows - 1);
        let nearest = f32::from_bits(self.cells[row * self.columns + column].load(Ordering::Relaxed));
        z <= f64::from(nearest) + HIDDEN_BY_M.max(HIDDEN_BY_SHARE * z)
    }
}

/// Returns the spacing in the colour image of neighbours in a line of the depth image: the median, at least a pixel.
fn step_px(seen: &[Option<ProjectedPoint>], width: usize) -> f64 {
    /// This many lines give the same result as all.
    const LINES: usize = 16;
    let lines = seen.len() / width.max(1);
    let steps = seen.chunks_exact(width.max(1)).step_by(lines.div_ceil(LINES).max(1));
    let mut steps: Vec<f64> = steps
        .flat_map(|line| line.windows(2))
        .filter_map(|pair| Some(pair[0]?.pixel.distance(pair[1]?.pixel)))
        .collect();
    if steps.is_empty() {
        return 1.0;
    }
    let midpoint = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(midpoint, f64::total_cmp);
    median.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Distortion;

    fn camera(size: [u32; 2], focal: f64) -> Camera {
        let center = DVec2::new(f64::from(size[0]) - 1.0, f64::from(size[1]) - 1.0) / 2.0;
        Camera::new(size, DVec2::splat(focal), center, Distortion::None).unwrap()
    }

    /// Red and green encode column and row.
    fn places([width, height]: [u32; 2]) -> ColorImage {
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| [column as u8, row as u8, 0]));
        ColorImage::new([width, height], pixels.collect()).unwrap()
    }

    #[test]
    fn the_same_camera_gives_every_pixel_its_own_color() {
        let depth_camera = camera([64, 48], 50.0);
        let rays = RayTable::of(&depth_camera);
        let metres = (0..64 * 48).map(|at| {
            if at % 7 == 3 {
                0.0
            } else {
                1.0 + (at % 64) as f32 / 640.0
            }
        });
        let depth = DepthImage::new([64, 48], metres.collect()).unwrap();
        let color = ColorCamera {
            camera: depth_camera,
            color_from_depth: DAffine3::IDENTITY,
        };
        let colors = color.colors(&depth, &rays, &places([64, 48]));
        for (at, (color, &z)) in colors.iter().zip(depth.metres()).enumerate() {
            let expected = if z > 0.0 {
                [(at % 64) as u8, (at / 64) as u8, 0, 255]
            } else {
                UNSEEN_COLOR
            };
            assert_eq!(*color, expected, "pixel {at}");
        }
    }

    /// A wall with a bar before it, seen from the side: behind the bar the wall has no colour, and nowhere the bar's.
    #[test]
    fn hidden_points_have_no_color() {
        let depth_camera = camera([64, 48], 50.0);
        let rays = RayTable::of(&depth_camera);
        let is_bar = |at: usize| (24..32).contains(&(at % 64));
        let metres = (0..64 * 48).map(|at| if is_bar(at) { 1.0 } else { 2.0 }).collect();
        let depth = DepthImage::new([64, 48], metres).unwrap();
        // Three times the resolution of the depth image, 10 cm to the right.
        let size = [192, 144];
        let baseline = DVec3::new(-0.1, 0.0, 0.0);
        let color = ColorCamera {
            camera: camera(size, 150.0),
            color_from_depth: DAffine3::from_translation(baseline),
        };
        // The view of the colour camera: the bar is red, the wall blue.
        let bar_at = |column: f64| {
            let [low, high] = [23.5, 31.5].map(|u| 150.0 * ((u - 31.5) / 50.0 + baseline.x) + 95.5);
            (low..high).contains(&column)
        };
        let pixel = |column: u32| {
            if bar_at(f64::from(column)) {
                [200, 0, 0]
            } else {
                [0, 0, 200]
            }
        };
        let image = (0..144).flat_map(|_| (0..192).map(pixel)).collect();
        let colors = color.colors(&depth, &rays, &ColorImage::new(size, image).unwrap());
        let row = &colors[20 * 64..21 * 64];
        for (column, color) in row.iter().enumerate() {
            let [r, _, b, _] = *color;
            match column {
                24 | 31 => {}
                25..31 => assert!(r > 190 && b < 10, "bar at {column}: {color:?}"),
                // Compared with the wall behind it, the bar is shifted by 2.5 pixels to the left.
                _ if *color == UNSEEN_COLOR => {
                    assert!((20..24).contains(&column) || column < 3, "no colour at {column}");
                }
                _ => assert!(r < 80, "wall at {column}: {color:?}"),
            }
        }
        let hidden = (18..24).filter(|&column| row[column] == UNSEEN_COLOR).count();
        assert!((2..=4).contains(&hidden), "{hidden} pixels are hidden: {row:?}");
    }

    /// A slanted wall with a post before it, seen from the side by a camera with a wider lens.
    #[test]
    fn depths_match_those_the_other_camera_would_measure() {
        let depth_camera = camera([128, 96], 117.0);
        let rays = RayTable::of(&depth_camera);
        // The wall is z = 2 + x / 5, hence z = 2 / (1 - rx / 5); the post is at a distance of one.
        let wall = |[x, _]: [f32; 2]| 2.0 / (1.0 - 0.2 * x);
        let metres = rays
            .rays()
            .iter()
            .map(|&ray| if ray[0].abs() < 0.05 { 1.0 } else { wall(ray) });
        let depth = DepthImage::new([128, 96], metres.collect()).unwrap();
        let baseline = DVec3::new(-0.05, 0.0, 0.0);
        for (size, focal) in [([128, 96], 105.0), ([512, 384], 420.0)] {
            let color = ColorCamera {
                camera: camera(size, focal),
                color_from_depth: DAffine3::from_translation(baseline),
            };
            let found = color.depths(&depth, &rays);
            // The number of pixels of the wall is the depth camera's, not the colour camera's.
            assert!((100..=150).contains(&found.size_px()[0]), "{:?}", found.size_px());
            let step = 128.0 / found.width() as f32;
            let row = &found.metres()[found.width() * (found.size_px()[1] as usize / 2)..][..found.width()];
            let (mut on_wall, mut on_post) = (0, 0);
            for (column, &z) in row.iter().enumerate() {
                let ray = (step * (column as f32 + 0.5) - 64.0) / 105.0;
                // In the frame of the colour camera the wall is z = 2 + (x + 0.05) / 5.
                let expected = 2.01 / (1.0 - 0.2 * ray);
                let at_post = (ray + 0.05).abs();
                if at_post < 0.04 {
                    assert!((z - 1.0).abs() < 1e-4, "post at {column}: {z}");
                    on_post += 1;
                } else if at_post > 0.09 && column > 12 && column + 12 < row.len() {
                    // The nearest of the surrounding ones, which differ by the slope.
                    assert!((z - expected).abs() < 0.02, "wall at {column}: {z} for {expected}");
                    on_wall += 1;
                }
            }
            assert!(on_wall > 60 && on_post >= 6, "{on_wall} {on_post}");
        }
    }
}
