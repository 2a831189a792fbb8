//! One view of a frame: its truth, and the error of images.

use super::variants::BACKGROUND;
use crate::bench::BenchError;
use crate::measure::{
    Consecutive, DepthImage, DepthTolerance, ErrorMap, PIXELS_PER_DEGREE, Perceived, SurfaceError, TemporalError,
    mean_squared_error, ssim,
};
use crate::render::scaled_to;
use crate::render::truth::Truth;
use crate::scene::{Camera, Lighting};
use image::RgbaImage;

/// A view and its expected image.
pub(super) struct View {
    pub(super) camera: Camera,
    /// The camera of the next image, which has turned a little.
    pub(super) next_camera: Camera,
    /// One for each light of the modes.
    pub(super) truths: Vec<LitTruth>,
}

/// A ground truth in some light.
pub(super) struct LitTruth {
    /// Evaluated at each pixel.
    lighting: Lighting,
    truth: Truth,
    /// Truth of the next image.
    next: RgbaImage,
    perceived: Perceived,
}

/// Error of an image against the ground truth.
pub(super) struct PictureError {
    pub(super) map: ErrorMap,
    /// FLIP over the pixels that show the object in the truth or in the image.
    pub(super) flip_object: f64,
    /// Mean squared error of the channels.
    pub(super) squared: f64,
    pub(super) ssim: f64,
    /// Holes are counted from colours, wrong surfaces from depths.
    pub(super) surface: SurfaceError,
    /// Error of the change to the next image.
    pub(super) temporal: TemporalError,
}

/// Image rendered in one render mode.
pub(super) struct DrawnWay {
    pub(super) image: RgbaImage,
    /// Image of the same view on white, by which the object is separated from the background.
    pub(super) on_white: RgbaImage,
    /// The next image.
    pub(super) next: RgbaImage,
    /// Depth image, at the size at which it was drawn; `None` where the mode shows no particular surface.
    pub(super) depth: Option<DepthImage>,
}

impl View {
    /// The truth in the light that a mode has.
    ///
    /// # Errors
    /// Without a truth in that light.
    pub(super) fn truth_in(&self, lighting: Lighting) -> Result<&LitTruth, BenchError> {
        let truth = self
            .truths
            .iter()
            .find(|truth| truth.lighting == lighting.at_each_pixel());
        truth.ok_or_else(|| BenchError::Nothing(format!("no ground truth in {lighting} light")))
    }
}

impl LitTruth {
    pub(super) fn new(lighting: Lighting, truth: Truth, next: RgbaImage) -> Self {
        Self {
            lighting,
            next,
            perceived: Perceived::of(&truth.image, PIXELS_PER_DEGREE),
            truth,
        }
    }

    /// Returns the error of `drawn` against the ground truth.
    pub(super) fn compare(&self, drawn: DrawnWay) -> Result<(PictureError, RgbaImage), BenchError> {
        let size_px = self.truth.depth.size_px;
        let depth = drawn.depth.map(|depth| enlarged(&depth, size_px));
        let image = scaled_to(drawn.image, size_px);
        let on_white = scaled_to(drawn.on_white, size_px);
        let next = scaled_to(drawn.next, size_px);
        let shows_object: Vec<bool> = image
            .pixels()
            .zip(on_white.pixels())
            .map(|(image, on_white)| opacity(image.0, on_white.0) >= 0.5)
            .collect();
        let is_object = |pixel: usize| shows_object[pixel] || self.truth.depth.depth[pixel].is_finite();
        let map = self.perceived.flip(&Perceived::of(&image, PIXELS_PER_DEGREE))?;
        let surface = SurfaceError::of(
            &self.truth.depth,
            &self.shown_depth(&shows_object, depth.as_ref()),
            DepthTolerance::PerPixel(&self.truth.tolerance),
        )?;
        let temporal = of_change([&image, &next], [Some(&self.truth.image), Some(&self.next)])?;
        let error = PictureError {
            temporal,
            flip_object: map.mean_where(is_object),
            squared: mean_squared_error(&self.truth.image, &image)?,
            ssim: ssim(&self.truth.image, &image)?,
            surface,
            map,
        };
        Ok((error, image))
    }

    /// The depths that count: none where the background shows, the truth's where no depth is known.
    fn shown_depth(&self, shows_object: &[bool], depth: Option<&DepthImage>) -> DepthImage {
        let shown = |pixel: usize| {
            let known = depth.map(|depth| depth.depth[pixel]).filter(|depth| depth.is_finite());
            match (shows_object[pixel], known) {
                (false, _) => f32::INFINITY,
                (true, Some(depth)) => depth,
                // For a pixel covered only by an enlarged splat; 0 where the ground truth shows nothing, too.
                (true, None) if self.truth.depth.depth[pixel].is_finite() => self.truth.depth.depth[pixel],
                (true, None) => 0.0,
            }
        };
        DepthImage {
            size_px: self.truth.depth.size_px,
            depth: (0..shows_object.len()).map(shown).collect(),
        }
    }
}

/// The temporal error of two consecutive images of the same size, over the pixels that show the object in an image or
/// in a truth; without truths, of a scene and a camera at rest.
pub(in crate::bench::suites) fn of_change(
    [before, after]: [&RgbaImage; 2],
    truths: [Option<&RgbaImage>; 2],
) -> Result<TemporalError, BenchError> {
    let images: Vec<&RgbaImage> = [before, after]
        .into_iter()
        .chain(truths.into_iter().flatten())
        .collect();
    let is_object = |pixel: usize| {
        let width = before.width() as usize;
        let at = |image: &RgbaImage| image.get_pixel((pixel % width) as u32, (pixel / width) as u32).0;
        images.iter().any(|image| at(image)[..3] != BACKGROUND)
    };
    let truth = match truths {
        [Some(before), Some(after)] => Some(Consecutive { before, after }),
        _ => None,
    };
    Ok(TemporalError::of(truth, Consecutive { before, after }, is_object)?)
}

/// Returns the object's coverage of a pixel, computed from its colours on the two backgrounds.
fn opacity(on_grey: [u8; 4], on_white: [u8; 4]) -> f32 {
    let through: i32 = (0..3)
        .map(|channel| i32::from(on_white[channel]) - i32::from(on_grey[channel]))
        .sum();
    let max: i32 = BACKGROUND.iter().map(|&grey| 255 - i32::from(grey)).sum();
    1.0 - through as f32 / max as f32
}

/// Upscaled depths: each pixel has the depth of its source pixel.
fn enlarged(depth: &DepthImage, size_px: [u32; 2]) -> DepthImage {
    if depth.size_px == size_px {
        return depth.clone();
    }
    let source = |place: u32, axis: usize| {
        (u64::from(place) * u64::from(depth.size_px[axis]) / u64::from(size_px[axis])) as usize
    };
    let width = depth.size_px[0] as usize;
    let pixels = (0..size_px[1]).flat_map(|y| (0..size_px[0]).map(move |x| (x, y)));
    DepthImage {
        size_px,
        depth: pixels
            .map(|(x, y)| depth.depth[source(y, 1) * width + source(x, 0)])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_is_computed_from_images_on_two_backgrounds() {
        assert_eq!(opacity([119, 119, 119, 255], [255; 4]), 0.0);
        assert_eq!(opacity([10, 20, 30, 255], [10, 20, 30, 255]), 1.0);
        assert_eq!(opacity([119; 4], [187; 4]), 0.5);
    }

    #[test]
    fn depths_are_upscaled_by_repetition() {
        let depth = DepthImage {
            size_px: [2, 1],
            depth: vec![1.0, f32::INFINITY],
        };
        let large = enlarged(&depth, [4, 2]);
        let row = [1.0, 1.0, f32::INFINITY, f32::INFINITY];
        assert_eq!(large.depth, [row, row].concat());
        assert_eq!(enlarged(&depth, [2, 1]), depth);
    }
}
