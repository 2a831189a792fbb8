//! Images of one view, cut down to the part that shows the object.
//!
//! How it works: everything is drawn on two backgrounds, and a pixel shows the object unless it shows both of them. The
//! compared part is the smallest rectangle around the object in all images of a view, with a margin that no filter
//! reaches across: beyond it all are equal.
//!
//! When it wins: an upright object fills a tenth of its image, and comparing takes longer than drawing.

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::bench::subject::Subject;
use crate::measure::{PIXELS_PER_DEGREE, Perceived, mean_squared_error};
use crate::render::RenderError;
use crate::scene::{Background, Camera, Scene, Style};
use crate::sequence::PreparedFrame;
use image::RgbaImage;
use std::ops::Range;

/// Images are compared on the first, a grey of medium lightness; the second distinguishes the object from it.
const BACKGROUNDS: [[u8; 3]; 2] = [[119; 3], [255; 3]];

/// One view of a frame by some settings.
pub(super) struct DrawnView {
    image: RgbaImage,
    /// Mask of the pixels that show the object, row by row.
    shows_object: Vec<bool>,
}

/// The part of a [`DrawnView`] that is compared.
pub(super) struct ObjectPart {
    /// Pixels of the whole drawing.
    whole_count: usize,
    image: RgbaImage,
    perceived: Perceived,
    shows_object: Vec<bool>,
}

/// Pixels around the object that are compared too. FLIP's widest filter reaches ten pixels at [`PIXELS_PER_DEGREE`].
const MARGIN_PX: u32 = 16;

/// Error of an image against the ground truth.
pub(super) struct PictureError {
    /// Mean squared error of the channels over all pixels.
    pub(super) squared: f64,
    /// FLIP over all pixels.
    pub(super) flip_mean: f64,
    /// FLIP over the pixels that show the object in the image or in the truth.
    pub(super) flip_object_mean: f64,
    /// FLIP of the worst.
    pub(super) flip_max: f64,
}

/// Draws `frame` on both backgrounds.
pub(super) fn draw(
    run: &mut Run<'_>,
    subject: &Subject<'_>,
    frame: &PreparedFrame,
    camera: &Camera,
    style: Style,
) -> Result<DrawnView, BenchError> {
    run.check_cancelled()?;
    // One traversal for both backgrounds.
    let mut scene = Scene::default();
    let mut on_background = |background| -> Result<RgbaImage, RenderError> {
        let style = style.with(|style| style.backdrop.background = Background::solid(background));
        let packet = subject.packet(&mut scene, frame, camera, &style, run.options.viewport_px);
        run.runner.image(&packet)
    };
    let [first, second] = BACKGROUNDS;
    let [image, on_second] = [on_background(first)?, on_background(second)?];
    let shows_object = image
        .pixels()
        .zip(on_second.pixels())
        .map(|(on_first, on_second)| on_first.0[..3] != first || on_second.0[..3] != second)
        .collect();
    Ok(DrawnView { image, shows_object })
}

/// The parts of `drawings` (of one view) that are compared.
pub(super) fn parts(drawings: &[DrawnView]) -> impl Iterator<Item = ObjectPart> {
    let part = object_rectangle(drawings);
    drawings.iter().map(move |drawing| drawing.part(&part))
}

/// The smallest rectangle (first and end in x, then in y) around the object in all of `drawings`, which are of one
/// size, and [`MARGIN_PX`] more as far as they go; one pixel where nothing shows.
fn object_rectangle(drawings: &[DrawnView]) -> [Range<u32>; 2] {
    let mut ends = [[u32::MAX, 0]; 2];
    let mut size_px = [1, 1];
    for DrawnView { image, shows_object } in drawings {
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

impl DrawnView {
    fn part(&self, [x, y]: &[Range<u32>; 2]) -> ObjectPart {
        let width = self.image.width();
        let pixels = y.clone().flat_map(|row| {
            let row = (row * width) as usize;
            row + x.start as usize..row + x.end as usize
        });
        let shows_object = pixels.map(|pixel| self.shows_object[pixel]).collect();
        let image =
            image::imageops::crop_imm(&self.image, x.start, y.start, x.end - x.start, y.end - y.start).to_image();
        ObjectPart {
            whole_count: self.shows_object.len(),
            perceived: Perceived::of(&image, PIXELS_PER_DEGREE),
            image,
            shows_object,
        }
    }
}

impl ObjectPart {
    /// Converts a mean over this part to the mean over the whole, if the value is 0 elsewhere.
    fn over_whole(&self, mean: f64) -> f64 {
        mean * self.shows_object.len() as f64 / self.whole_count.max(1) as f64
    }

    /// The image.
    pub(super) fn image(&self) -> &RgbaImage {
        &self.image
    }

    /// Part of the whole drawing that shows the object, 0 to 1.
    pub(super) fn object_share(&self) -> f64 {
        let covered = self.shows_object.iter().filter(|&&shows| shows).count();
        covered as f64 / self.whole_count.max(1) as f64
    }

    /// Returns two fractions of the number of pixels that show the object in `other`, which is of the same view: the
    /// ones that show it here as well, and the pixels that show it only here.
    pub(super) fn shares_of(&self, other: &Self) -> [f64; 2] {
        let count = |is_counted: fn(bool, bool) -> bool| {
            let pixels = self.shows_object.iter().zip(&other.shows_object);
            pixels.filter(|&(&here, &there)| is_counted(here, there)).count() as f64
        };
        let there = count(|_, there| there).max(1.0);
        [count(|here, there| here && there), count(|here, there| here && !there)].map(|pixels| pixels / there)
    }

    /// The errors of this image compared with `truth`, of the same view.
    pub(super) fn compare(&self, truth: &Self) -> Result<PictureError, BenchError> {
        let map = truth.perceived.flip(&self.perceived)?;
        let is_object = |pixel: usize| truth.shows_object[pixel] || self.shows_object[pixel];
        Ok(PictureError {
            squared: self.over_whole(mean_squared_error(&truth.image, &self.image)?),
            flip_mean: self.over_whole(map.mean()),
            flip_object_mean: map.mean_where(is_object),
            flip_max: f64::from(map.max()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    /// A drawing of 120×80 with a block of one colour on grey.
    fn block(x: Range<u32>, y: Range<u32>, color: [u8; 3]) -> DrawnView {
        let is_object = |column, row| x.contains(&column) && y.contains(&row);
        let image = RgbaImage::from_fn(120, 80, |column, row| {
            let [red, green, blue] = if is_object(column, row) { color } else { BACKGROUNDS[0] };
            Rgba([red, green, blue, 255])
        });
        let shows_object = image
            .enumerate_pixels()
            .map(|(column, row, _)| is_object(column, row))
            .collect();
        DrawnView { image, shows_object }
    }

    #[test]
    fn the_compared_region_contains_all_objects_and_a_margin() {
        let drawings = [block(40..50, 30..31, [255, 0, 0]), block(47..60, 5..20, [0, 255, 0])];
        assert_eq!(object_rectangle(&drawings), [24..76, 0..47]);
        let nothing = [block(0..0, 0..0, [0; 3])];
        assert_eq!(object_rectangle(&nothing), [0..1, 0..1]);
    }

    #[test]
    fn errors_of_the_region_match_those_of_the_full_image() {
        let drawings = [block(50..70, 30..50, [255, 0, 0]), block(52..75, 30..48, [200, 30, 90])];
        let whole = [0..120, 0..80];
        let part = object_rectangle(&drawings);
        assert_eq!(part, [34..91, 14..66]);
        let [of_part, of_whole] = [part, whole].map(|rectangle| {
            let [truth, picture] = [0, 1].map(|index: usize| drawings[index].part(&rectangle));
            let error = picture.compare(&truth).unwrap();
            [
                picture.object_share(),
                error.squared,
                error.flip_mean,
                error.flip_object_mean,
                error.flip_max,
            ]
        });
        for (part, whole) in of_part.into_iter().zip(of_whole) {
            // Filtered identically, but summed in a different order.
            assert!((part - whole).abs() <= 1e-9 * whole, "{part} for {whole}");
        }
        assert_eq!(of_part[0], 23.0 * 18.0 / 9600.0);
    }
}
