//! Levels of detail by projected size: what a LOD threshold τ saves, and what it does to the picture.
//!
//! How it works: each frame is drawn as voxels from around it, as a whole and from farther away, once with all its leaves
//! (τ = 0, the truth) and once for each τ. PSNR is that of the mean squared error over all pictures. Most of a picture is
//! background, which is always right, so FLIP is given over the picture and over the pixels of the object: those that show it
//! in either picture, found by drawing on two backgrounds, so that no colour passes for background. Only the part of the
//! pictures that shows the object is compared, with a margin that no filter reaches across: beyond it all are equal.
//!
//! All leaves are the truth about what the threshold leaves out, not about the surface: at a small δ nearly every point has a
//! leaf of its own, smaller than its share of the surface, and coarser cells close the gaps. So each picture is also compared
//! with that of surfels, which close the surface; part of that error is that cubes are shaded as cubes.

use super::{LOD, row, voxel_settings};
use crate::bench::report::{Cell, Row};
use crate::bench::runner::milliseconds_since;
use crate::bench::scenario;
use crate::bench::suites::{Run, Subject, mean, surfel_settings};
use crate::bench::{BenchError, Quantiles};
use crate::measure::{PIXELS_PER_DEGREE, Perceived, mean_squared_error, psnr_db};
use crate::octree::SelectView;
use crate::render::RenderError;
use crate::scene::{Background, Camera, Scene, Settings, UpAxis};
use crate::sequence::PreparedFrame;
use image::RgbaImage;
use std::hint::black_box;
use std::ops::Range;
use std::time::Instant;

/// LOD thresholds, pixels; the first is the truth.
const LOD_PX: [f32; 5] = [0.0, 1.0, 2.0, 4.0, 8.0];

/// Pictures are compared on the first, a grey of medium lightness; the second tells the object from it.
const BACKGROUNDS: [[u8; 3]; 2] = [[119; 3], [255; 3]];

/// How far the eye is, in distances from which the picture just holds the object.
pub(super) const DISTANCES: [f64; 2] = [1.0, 4.0];

/// What was measured of one sequence from one distance, for each of [`LOD_PX`].
#[derive(Default)]
pub(super) struct Samples([ThresholdSamples; LOD_PX.len()]);

/// One number for each picture, or for each traversal.
#[derive(Default)]
struct ThresholdSamples {
    drawn_voxels: Vec<f64>,
    visited_nodes: Vec<f64>,
    traverse_ms: Vec<f64>,
    object_share: Vec<f64>,
    squared_error: Vec<f64>,
    flip: Vec<f64>,
    flip_object: Vec<f64>,
    flip_max: f64,
    flip_surfels: Vec<f64>,
}

/// One view of a frame.
struct Drawing {
    image: RgbaImage,
    /// Which pixels show the object, row by row.
    shows_object: Vec<bool>,
}

/// The part of a [`Drawing`] that is compared.
struct Picture {
    /// Pixels of the whole drawing.
    whole_count: usize,
    image: RgbaImage,
    perceived: Perceived,
    shows_object: Vec<bool>,
}

/// Pixels around the object that are compared too. FLIP's widest filter reaches ten pixels at [`PIXELS_PER_DEGREE`].
const MARGIN_PX: u32 = 16;

impl Samples {
    pub(super) fn measure(
        &mut self,
        run: &mut Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        distance: f64,
    ) -> Result<(), BenchError> {
        let origin = subject.sequence.origin();
        let framing = Camera::framing(&frame.frame.bounds(), origin, UpAxis::guess(&frame.frame));
        let cameras: Vec<Camera> = scenario::directions(run.options.viewpoints)
            .map(|(azimuth_deg, elevation_deg)| Camera {
                azimuth_deg,
                elevation_deg,
                distance: distance * framing.distance,
                ..framing
            })
            .collect();
        for camera in &cameras {
            let mut draw = |settings| draw(run, subject, frame, camera, settings);
            let settings = LOD_PX.map(voxel_settings);
            let drawings: Vec<Drawing> = std::iter::once(surfel_settings())
                .chain(settings)
                .map(&mut draw)
                .collect::<Result<_, _>>()?;
            let part = object_rectangle(&drawings);
            let mut pictures = drawings.iter().map(|drawing| drawing.part(&part));
            let (Some(surfels), Some(truth)) = (pictures.next(), pictures.next()) else {
                continue;
            };
            self.0[0].add(&truth, &surfels)?;
            for (picture, samples) in pictures.zip(&mut self.0[1..]) {
                samples.add(&picture, &surfels)?;
                samples.compare(&picture, &truth)?;
            }
        }
        for (lod_px, samples) in LOD_PX.into_iter().zip(&mut self.0) {
            samples.time_traversals(run, subject, frame, &cameras, lod_px)?;
        }
        Ok(())
    }

    pub(super) fn rows(&self, sequence: &str, distance: f64) -> impl Iterator<Item = Row> {
        let rows = LOD_PX.into_iter().zip(&self.0);
        rows.map(move |(lod_px, samples)| samples.row(sequence, distance, lod_px))
    }
}

fn draw(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    camera: &Camera,
    settings: Settings,
) -> Result<Drawing, BenchError> {
    run.check_cancelled()?;
    // One traversal for both backgrounds.
    let mut scene = Scene::default();
    let mut on_background = |background| -> Result<RgbaImage, RenderError> {
        let settings = Settings {
            background: Background::solid(background),
            ..settings
        };
        let origin = subject.sequence.origin();
        let packet = scene.packet(frame, origin, camera, &settings, run.options.viewport_px);
        run.runner.image(&packet)
    };
    let [first, second] = BACKGROUNDS;
    let [image, on_second] = [on_background(first)?, on_background(second)?];
    let shows_object = image
        .pixels()
        .zip(on_second.pixels())
        .map(|(on_first, on_second)| on_first.0[..3] != first || on_second.0[..3] != second)
        .collect();
    Ok(Drawing {
        image,
        shows_object,
    })
}

/// The smallest rectangle (first and end in x, then in y) around the object in all of `drawings`, which are of one size,
/// and [`MARGIN_PX`] more as far as they go; one pixel where nothing shows.
fn object_rectangle(drawings: &[Drawing]) -> [Range<u32>; 2] {
    let mut ends = [[u32::MAX, 0]; 2];
    let mut size_px = [1, 1];
    for Drawing {
        image,
        shows_object,
    } in drawings
    {
        size_px = [image.width(), image.height()];
        let shown = image.enumerate_pixels().zip(shows_object);
        for ((x, y, _), _) in shown.filter(|&(_, &shows)| shows) {
            for ([first, end], place) in ends.iter_mut().zip([x, y]) {
                *first = place.min(*first);
                *end = (place + 1).max(*end);
            }
        }
    }
    [0, 1].map(|axis| match ends[axis] {
        [u32::MAX, _] => 0..1,
        [first, end] => first.saturating_sub(MARGIN_PX)..(end + MARGIN_PX).min(size_px[axis]),
    })
}

impl Drawing {
    fn part(&self, [x, y]: &[Range<u32>; 2]) -> Picture {
        let width = self.image.width();
        let pixels = y.clone().flat_map(|row| {
            let row = (row * width) as usize;
            row + x.start as usize..row + x.end as usize
        });
        let shows_object = pixels.map(|pixel| self.shows_object[pixel]).collect();
        let image = image::imageops::crop_imm(
            &self.image,
            x.start,
            y.start,
            x.end - x.start,
            y.end - y.start,
        )
        .to_image();
        Picture {
            whole_count: self.shows_object.len(),
            perceived: Perceived::of(&image, PIXELS_PER_DEGREE),
            image,
            shows_object,
        }
    }
}

impl Picture {
    /// What the mean of something over this part is over the whole, if it is 0 elsewhere.
    fn over_whole(&self, mean: f64) -> f64 {
        mean * self.shows_object.len() as f64 / self.whole_count.max(1) as f64
    }

    /// FLIP of this picture where `truth` is right: over all pixels, over those that show the object in either, and the
    /// largest.
    fn flip(&self, truth: &Self) -> Result<[f64; 3], BenchError> {
        let map = truth.perceived.flip(&self.perceived)?;
        let is_object = |pixel: usize| truth.shows_object[pixel] || self.shows_object[pixel];
        Ok([
            self.over_whole(map.mean()),
            map.mean_where(is_object),
            f64::from(map.max()),
        ])
    }
}

impl ThresholdSamples {
    fn add(&mut self, picture: &Picture, surfels: &Picture) -> Result<(), BenchError> {
        let shows_object = &picture.shows_object;
        let covered = shows_object.iter().filter(|&&shows| shows).count();
        self.object_share
            .push(covered as f64 / picture.whole_count.max(1) as f64);
        let [_, object, _] = picture.flip(surfels)?;
        self.flip_surfels.push(object);
        Ok(())
    }

    fn compare(&mut self, picture: &Picture, truth: &Picture) -> Result<(), BenchError> {
        let squared_error = mean_squared_error(&truth.image, &picture.image)?;
        self.squared_error.push(picture.over_whole(squared_error));
        let [whole, object, largest] = picture.flip(truth)?;
        self.flip.push(whole);
        self.flip_object.push(object);
        self.flip_max = self.flip_max.max(largest);
        Ok(())
    }

    /// Each traversal fills memory that the one before it left, as playing does.
    fn time_traversals(
        &mut self,
        run: &Run<'_>,
        subject: &Subject<'_>,
        frame: &PreparedFrame,
        cameras: &[Camera],
        lod_px: f32,
    ) -> Result<(), BenchError> {
        let Some(octree) = &frame.octree else {
            return Ok(());
        };
        let mut voxels = Vec::new();
        for round in 0..run.options.warmup + run.options.repeat {
            for camera in cameras {
                run.check_cancelled()?;
                let view = camera.transform(subject.sequence.origin(), run.options.viewport_px);
                let start = Instant::now();
                let select_view = SelectView {
                    frustum: view.frustum_in_frame(),
                    eye: view.eye_high,
                    pixels_per_unit_at_1: view.pixels_per_unit_at_1,
                    lod_px,
                };
                let selected = octree.select(&select_view, black_box(&mut voxels));
                let traverse_ms = milliseconds_since(start);
                if round >= run.options.warmup {
                    self.traverse_ms.push(traverse_ms);
                    self.visited_nodes.push(selected.visited_nodes as f64);
                    self.drawn_voxels.push(selected.emitted as f64);
                }
            }
        }
        Ok(())
    }

    fn row(&self, sequence: &str, distance: f64, lod_px: f32) -> Row {
        let traverse = Quantiles::of(&self.traverse_ms);
        let is_compared = !self.flip.is_empty();
        let if_compared = |error: f64| Cell::maybe(is_compared.then_some(error));
        // Of equal pictures it is infinite, which JSON cannot say.
        let ratio_db = Some(psnr_db(mean(&self.squared_error))).filter(|ratio| ratio.is_finite());
        row(
            LOD,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("lod_px", Cell::Number(f64::from(lod_px))),
                ("distance", Cell::Number(distance)),
                ("drawn_voxels", Cell::Number(mean(&self.drawn_voxels))),
                ("visited_nodes", Cell::Number(mean(&self.visited_nodes))),
                (
                    "traverse_ms_median",
                    Cell::maybe(traverse.map(|q| q.median)),
                ),
                ("traverse_ms_q1", Cell::maybe(traverse.map(|q| q.q1))),
                ("traverse_ms_q3", Cell::maybe(traverse.map(|q| q.q3))),
                ("object_share", Cell::Number(mean(&self.object_share))),
                ("psnr_db", Cell::maybe(ratio_db)),
                ("flip_mean", if_compared(mean(&self.flip))),
                ("flip_object_mean", if_compared(mean(&self.flip_object))),
                ("flip_max", if_compared(self.flip_max)),
                ("flip_surfels_mean", Cell::Number(mean(&self.flip_surfels))),
                ("pictures", Cell::Number(self.object_share.len() as f64)),
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    /// A drawing of 120×80 with a block of one colour on grey.
    fn block(x: Range<u32>, y: Range<u32>, color: [u8; 3]) -> Drawing {
        let is_object = |column, row| x.contains(&column) && y.contains(&row);
        let image = RgbaImage::from_fn(120, 80, |column, row| {
            let [red, green, blue] = if is_object(column, row) {
                color
            } else {
                BACKGROUNDS[0]
            };
            Rgba([red, green, blue, 255])
        });
        let shows_object = image
            .enumerate_pixels()
            .map(|(column, row, _)| is_object(column, row))
            .collect();
        Drawing {
            image,
            shows_object,
        }
    }

    #[test]
    fn the_part_that_is_compared_holds_all_objects_and_a_margin() {
        let drawings = [
            block(40..50, 30..31, [255, 0, 0]),
            block(47..60, 5..20, [0, 255, 0]),
        ];
        assert_eq!(object_rectangle(&drawings), [24..76, 0..47]);
        let nothing = [block(0..0, 0..0, [0; 3])];
        assert_eq!(object_rectangle(&nothing), [0..1, 0..1]);
    }

    #[test]
    fn errors_of_the_part_are_those_of_the_whole() {
        let drawings = [
            block(50..70, 30..50, [255, 0, 0]),
            block(52..75, 30..48, [200, 30, 90]),
        ];
        let whole = [0..120, 0..80];
        let part = object_rectangle(&drawings);
        assert_eq!(part, [34..91, 14..66]);
        let [of_part, of_whole] = [part, whole].map(|rectangle| {
            let [truth, picture] = [0, 1].map(|index: usize| drawings[index].part(&rectangle));
            let mut samples = ThresholdSamples::default();
            samples.add(&picture, &truth).unwrap();
            samples.compare(&picture, &truth).unwrap();
            [
                samples.object_share[0],
                samples.squared_error[0],
                samples.flip[0],
                samples.flip_object[0],
                samples.flip_max,
            ]
        });
        for (part, whole) in of_part.into_iter().zip(of_whole) {
            // Filtered the same; added up in another order.
            assert!((part - whole).abs() <= 1e-9 * whole, "{part} for {whole}");
        }
        assert_eq!(of_part[0], 23.0 * 18.0 / 9600.0);
    }
}
