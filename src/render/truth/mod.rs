//! Ground-truth rendering: slow reference images of a view in f64 that the renderers' images are measured against.
//!
//! How it works: each pixel is the mean of 8×8 samples, and each sample intersects its ray with the scene. The scene of
//! a shape with a formula is the shape itself (`shapes.rs`), of a file with triangles these (`mesh.rs`), of any other
//! cloud all of its disks, or the ellipses of its file, without levels of detail (`surfels.rs`). Light is computed at
//! each sample (`light.rs`). Depths are taken at the pixel centres.
//!
//! When it wins: only here is nothing rounded to a pixel, a byte or an f32 before the end, and nothing omitted; it
//! takes seconds where renderers take milliseconds.

mod key;
mod light;
mod mesh;
mod rays;
mod shapes;
mod surfels;
mod triangle_tree;

pub use key::TruthKey;
pub use mesh::TracedMesh;
pub use rays::TruthView;
pub use shapes::RayTraced;
pub use surfels::Disks;

use crate::measure::DepthImage;
use glam::DVec3;
use image::RgbaImage;
use rayon::prelude::*;
use rays::{SampleGrid, TILE_PX, Visible};

/// Samples along each edge of a pixel.
const SAMPLES_PER_EDGE: u32 = 8;

/// The true image of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Display-referred, opaque.
    pub image: RgbaImage,
    /// Depth image, sampled at the centre of each pixel.
    pub depth: DepthImage,
    /// Tolerance within which a depth still counts as that surface: a splat's diameter; infinite where nothing is seen.
    /// One for each pixel, scene units.
    pub tolerance: Vec<f32>,
}

impl Truth {
    /// The true image of the disks of a cloud.
    pub fn of_disks(disks: &Disks<'_>, view: &TruthView) -> Self {
        Self::of(&disks.seen_from(view), view)
    }

    /// The true image of a shape, with the tolerance of its depths.
    pub fn of_shape(shape: RayTraced, view: &TruthView, tolerance: f64) -> Self {
        Self::of(&shapes::Traced { shape, tolerance }, view)
    }

    /// The true image of triangles, with the tolerance of their depths.
    pub fn of_mesh(mesh: &TracedMesh, view: &TruthView, tolerance: f64) -> Self {
        Self::of(&mesh::ToleratedMesh { mesh, tolerance }, view)
    }

    fn of(visible: &impl Visible, view: &TruthView) -> Self {
        let [width, height] = view.size_px;
        let mut image = RgbaImage::new(width, height);
        let pixel_count = width as usize * height as usize;
        let mut depth = vec![f32::INFINITY; pixel_count];
        let mut tolerance = vec![f32::INFINITY; pixel_count];
        let per_band = (width * TILE_PX) as usize;
        (0..height.div_ceil(TILE_PX))
            .into_par_iter()
            .zip(image.par_chunks_mut(4 * per_band))
            .zip(depth.par_chunks_mut(per_band))
            .zip(tolerance.par_chunks_mut(per_band))
            .for_each(|(((band, pixels), depths), tolerances)| {
                let rows_px = TILE_PX * band..(TILE_PX * (band + 1)).min(height);
                for left in (0..width).step_by(TILE_PX as usize) {
                    let tile = |per_edge: u32| SampleGrid {
                        columns_px: left..(left + TILE_PX).min(width),
                        rows_px: rows_px.clone(),
                        per_edge,
                    };
                    let pixel = |column: usize, row: usize| row * width as usize + left as usize + column;
                    for ([column, row], color) in mean_colors(visible, view, &tile(SAMPLES_PER_EDGE)) {
                        let bytes = (color * 255.0 + 0.5).to_array().map(|channel| channel as u8);
                        let place = 4 * pixel(column, row);
                        pixels[place..place + 3].copy_from_slice(&bytes);
                        pixels[place + 3] = 255;
                    }
                    let centers = tile(1);
                    let columns = centers.size()[0];
                    for (index, hit) in visible.meet(view, &centers).into_iter().enumerate() {
                        if let Some(hit) = hit {
                            let place = pixel(index % columns, index / columns);
                            depths[place] = hit.depth as f32;
                            tolerances[place] = hit.tolerance as f32;
                        }
                    }
                }
            });
        Self {
            image,
            depth: DepthImage {
                size_px: view.size_px,
                depth,
            },
            tolerance,
        }
    }
}

/// The pixels of `samples` (column and row within them) with the means of their colours.
fn mean_colors(
    visible: &impl Visible,
    view: &TruthView,
    samples: &SampleGrid,
) -> impl Iterator<Item = ([usize; 2], DVec3)> {
    let [columns, _] = samples.size();
    let per_edge = samples.per_edge as usize;
    let width = columns / per_edge;
    let mut sums = vec![DVec3::ZERO; width * samples.rows_px.len()];
    for (index, hit) in visible.meet(view, samples).into_iter().enumerate() {
        let [column, row] = [index % columns, index / columns];
        let color = hit.map_or_else(|| view.background_at(samples.place_px(column, row)[1]), |hit| hit.color);
        sums[row / per_edge * width + column / per_edge] += color;
    }
    let share = 1.0 / (per_edge * per_edge) as f64;
    sums.into_iter()
        .enumerate()
        .map(move |(pixel, sum)| ([pixel % width, pixel / width], sum * share))
}

#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod tests;
