//! What a view should look like: slow pictures in f64 that those of renderers are measured against.
//!
//! How it works: each pixel is the mean of 8×8 samples, and each sample asks its ray what it meets. Of a cloud that is
//! all of its disks, without levels of detail (`surfels.rs`); of a shape with a formula it is the shape itself
//! (`shapes.rs`). Light is worked out at each sample. Depths are those in the middles of the pixels.
//!
//! When it wins: only here is nothing rounded to a pixel, a byte or an f32 before the end, and nothing left out; it
//! takes seconds where renderers take milliseconds.

mod shapes;
mod surfels;

pub use shapes::RayTraced;
pub use surfels::Disks;

use super::{HEAD_LIGHT_AMBIENT, HEAD_LIGHT_SPECULAR};
use crate::measure::DepthImage;
use crate::scene::{Background, Camera, Lighting};
use glam::{DMat3, DVec3};
use image::RgbaImage;
use rayon::prelude::*;
use std::ops::Range;

/// Samples along each edge of a pixel.
const SAMPLES_PER_EDGE: u32 = 8;

/// Pixels along each edge of the squares that are worked out at a time.
const TILE_PX: u32 = 32;

/// A view in f64, and how its surfaces are lit.
#[derive(Debug, Clone, Copy)]
pub struct TruthView {
    view_from_frame: DMat3,
    /// In the space of the frame.
    eye: DVec3,
    /// Pixels for a slope of 1.
    px_per_slope: f64,
    size_px: [u32; 2],
    lighting: Lighting,
    background: Background,
}

/// The true picture of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Display-referred, opaque.
    pub image: RgbaImage,
    /// What is seen in the middle of each pixel.
    pub depth: DepthImage,
    /// By how much a depth may differ and still be of that surface: a splat's diameter; infinite where nothing is seen.
    /// One for each pixel, scene units.
    pub tolerance: Vec<f32>,
}

/// Everything that a truth depends on, by which it is known again.
#[derive(Debug, Clone, Copy)]
pub struct TruthKey<'a> {
    view: &'a TruthView,
    of: Subject<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Subject<'a> {
    Disks(Disks<'a>),
    Shape(RayTraced, f64),
}

impl<'a> TruthKey<'a> {
    /// That of [`Truth::of_disks`].
    pub fn of_disks(disks: Disks<'a>, view: &'a TruthView) -> Self {
        Self {
            view,
            of: Subject::Disks(disks),
        }
    }

    /// That of [`Truth::of_shape`].
    pub fn of_shape(shape: RayTraced, view: &'a TruthView, tolerance: f64) -> Self {
        Self {
            view,
            of: Subject::Shape(shape, tolerance),
        }
    }

    /// Width and height of the picture.
    pub fn size_px(&self) -> [u32; 2] {
        self.view.size_px
    }

    /// Hands over the bytes of all that it is made of, in pieces.
    pub fn for_each_bytes(&self, take: &mut dyn FnMut(&[u8])) {
        let TruthView {
            view_from_frame,
            eye,
            px_per_slope,
            size_px,
            lighting,
            background,
        } = self.view;
        let numbers = view_from_frame.to_cols_array().into_iter();
        for number in numbers.chain(eye.to_array()).chain([*px_per_slope]) {
            take(&number.to_le_bytes());
        }
        for edge in size_px {
            take(&edge.to_le_bytes());
        }
        take(&[u8::from(*lighting == Lighting::Unlit)]);
        take(&background.top);
        take(&background.bottom);
        match self.of {
            Subject::Disks(disks) => {
                take(&[u8::from(disks.cull_back_faces)]);
                take(bytemuck::cast_slice(disks.points));
                take(bytemuck::cast_slice(disks.shapes));
            }
            Subject::Shape(shape, tolerance) => {
                take(&[u8::from(shape.cull_back_faces)]);
                take(shape.shape.name().as_bytes());
                take(&tolerance.to_le_bytes());
            }
        }
    }
}

/// What a ray meets.
#[derive(Debug, Clone, Copy)]
struct Hit {
    /// Along the view axis.
    depth: f64,
    /// Lit; red, green and blue, 0 to 1.
    color: DVec3,
    /// See [`Truth::tolerance`].
    tolerance: f64,
}

/// What rays may meet.
trait Visible: Sync {
    /// What the rays of `samples` meet, row by row.
    fn meet(&self, view: &TruthView, samples: &Samples) -> Vec<Option<Hit>>;
}

/// The samples of a rectangle of pixels: `per_edge` along each edge of each pixel, in the middles of equal squares.
struct Samples {
    columns_px: Range<u32>,
    rows_px: Range<u32>,
    /// Along each edge of a pixel.
    per_edge: u32,
}

impl TruthView {
    /// What `camera` sees of frames relative to `origin`. Surfaces are lit at each sample unless they are not lit at
    /// all.
    pub fn new(
        camera: &Camera,
        origin: DVec3,
        size_px: [u32; 2],
        lighting: Lighting,
        background: Background,
    ) -> Self {
        Self {
            view_from_frame: camera.view_from_world_rotation(),
            eye: camera.eye_in_world() - origin,
            px_per_slope: 0.5 * f64::from(size_px[1]) * camera.focal(),
            size_px,
            lighting,
            background,
        }
    }

    /// The ray through a place of the picture, in view space: as long as makes its depth 1.
    fn ray(&self, place_px: [f64; 2]) -> DVec3 {
        let [width, height] = self.size_px.map(f64::from);
        DVec3::new(
            (place_px[0] - 0.5 * width) / self.px_per_slope,
            (0.5 * height - place_px[1]) / self.px_per_slope,
            -1.0,
        )
    }

    fn to_view(self, position_in_frame: DVec3) -> DVec3 {
        self.view_from_frame * (position_in_frame - self.eye)
    }

    /// A colour (0 to 1) under the head light of `shaders/common/light.wgsl`. Vectors in view space.
    fn lit(&self, color: DVec3, normal: DVec3, ray: DVec3) -> DVec3 {
        if self.lighting == Lighting::Unlit {
            return color;
        }
        let [ambient, specular] = [HEAD_LIGHT_AMBIENT, HEAD_LIGHT_SPECULAR].map(f64::from);
        let facing = normal.dot(ray.normalize()).abs();
        let lit = color * (ambient + (1.0 - ambient) * facing) + specular * facing.powi(24);
        lit.min(DVec3::ONE)
    }

    fn background_at(&self, y_px: f64) -> DVec3 {
        let share = y_px / f64::from(self.size_px[1]);
        let [top, bottom] = [self.background.top, self.background.bottom].map(unit_color);
        top.lerp(bottom, share)
    }
}

impl Samples {
    fn size(&self) -> [usize; 2] {
        [&self.columns_px, &self.rows_px].map(|range| range.len() * self.per_edge as usize)
    }

    /// The place of a sample in the picture.
    fn place_px(&self, column: usize, row: usize) -> [f64; 2] {
        let place = |first: u32, sample: usize| {
            f64::from(first) + (sample as f64 + 0.5) / f64::from(self.per_edge)
        };
        [
            place(self.columns_px.start, column),
            place(self.rows_px.start, row),
        ]
    }
}

impl Truth {
    /// The true picture of the disks of a cloud.
    pub fn of_disks(disks: &Disks<'_>, view: &TruthView) -> Self {
        Self::of(&disks.seen_from(view), view)
    }

    /// The true picture of a shape, with the tolerance of its depths.
    pub fn of_shape(shape: RayTraced, view: &TruthView, tolerance: f64) -> Self {
        Self::of(&shapes::Traced { shape, tolerance }, view)
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
                    let tile = |per_edge: u32| Samples {
                        columns_px: left..(left + TILE_PX).min(width),
                        rows_px: rows_px.clone(),
                        per_edge,
                    };
                    let pixel =
                        |column: usize, row: usize| row * width as usize + left as usize + column;
                    for ([column, row], color) in
                        mean_colors(visible, view, &tile(SAMPLES_PER_EDGE))
                    {
                        let bytes = (color * 255.0 + 0.5)
                            .to_array()
                            .map(|channel| channel as u8);
                        let place = 4 * pixel(column, row);
                        pixels[place..place + 3].copy_from_slice(&bytes);
                        pixels[place + 3] = 255;
                    }
                    let middles = tile(1);
                    let columns = middles.size()[0];
                    for (index, hit) in visible.meet(view, &middles).into_iter().enumerate() {
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
    samples: &Samples,
) -> impl Iterator<Item = ([usize; 2], DVec3)> {
    let [columns, _] = samples.size();
    let per_edge = samples.per_edge as usize;
    let width = columns / per_edge;
    let mut sums = vec![DVec3::ZERO; width * samples.rows_px.len()];
    for (index, hit) in visible.meet(view, samples).into_iter().enumerate() {
        let [column, row] = [index % columns, index / columns];
        let color = hit.map_or_else(
            || view.background_at(samples.place_px(column, row)[1]),
            |hit| hit.color,
        );
        sums[row / per_edge * width + column / per_edge] += color;
    }
    let share = 1.0 / (per_edge * per_edge) as f64;
    sums.into_iter()
        .enumerate()
        .map(move |(pixel, sum)| ([pixel % width, pixel / width], sum * share))
}

/// A colour of bytes, 0 to 1.
fn unit_color(bytes: [u8; 3]) -> DVec3 {
    DVec3::from_array(bytes.map(|channel| f64::from(channel) / 255.0))
}

#[cfg(test)]
mod tests;
