//! An image next to its reference: errors, and if it meets the expectation.

use crate::bench::BenchError;
use crate::measure::{flip, mean_squared_error, psnr_db};
use crate::render::truth::Truth;
use image::{Rgba, RgbaImage};

/// A colour that no case has.
pub(super) const BACKGROUND: [u8; 3] = [18, 22, 31];

/// Decibels from which on two images are of the same scene: below, a difference is seen.
const MIN_DB: f64 = 40.0;

/// Decibels of equal images in reports: their ratio is infinite.
const EQUAL_DB: f64 = 99.0;

/// Largest share of the inner pixels of a surface that splats may leave open: one ball of eight is more than twice as
/// much.
const MAX_HOLE_SHARE: f64 = 0.05;

/// Number of pixels that may round to nothing.
const FEW_PX: usize = 4;

/// Reference image of a case.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    image: RgbaImage,
    name: &'static str,
    /// True if the image is one of an equal scene, drawn by the CPU, or of nothing.
    is_equal: bool,
    /// True if nothing is to be seen.
    is_background: bool,
}

impl Reference {
    /// A ray-traced image.
    pub(super) fn traced(truth: &Truth) -> Self {
        Self {
            image: truth.image.clone(),
            name: "ray-traced",
            is_equal: false,
            is_background: false,
        }
    }

    /// The image of an equal scene.
    pub(super) fn drawn(image: RgbaImage) -> Self {
        Self {
            image,
            name: "equal scene",
            is_equal: true,
            is_background: false,
        }
    }

    /// An image of nothing.
    pub(super) fn empty(size_px: [u32; 2]) -> Self {
        let [red, green, blue] = BACKGROUND;
        Self {
            image: RgbaImage::from_pixel(size_px[0], size_px[1], Rgba([red, green, blue, 255])),
            name: "background",
            is_equal: true,
            is_background: true,
        }
    }
}

/// Errors of an image and its result.
#[derive(Debug, Clone, Default)]
pub(super) struct Judged {
    pub(super) result: String,
    pub(super) reference: &'static str,
    pub(super) flip: Option<f64>,
    pub(super) psnr_db: Option<f64>,
    /// PSNR of the images of both renderers.
    pub(super) between_db: Option<f64>,
    pub(super) hole_share: Option<f64>,
    pub(super) covered_share: Option<f64>,
    pub(super) message: Option<String>,
}

impl Judged {
    /// Compares an image with its reference and with the other renderer's image. `is_closed`: it consists of splats
    /// that close a surface.
    pub(super) fn of(
        reference: &Reference,
        image: &RgbaImage,
        of_other: Option<&RgbaImage>,
        is_closed: bool,
    ) -> Result<Self, BenchError> {
        let db = |other: &RgbaImage| {
            let squared = mean_squared_error(other, image)?;
            Ok::<f64, BenchError>(psnr_db(squared).min(EQUAL_DB))
        };
        let [expected, found] = [&reference.image, image].map(coverage);
        let count = |covered: &[bool]| covered.iter().filter(|&&is_covered| is_covered).count();
        let psnr_db = db(&reference.image)?;
        let between_db = of_other.map(db).transpose()?;
        let hole_share = hole_share(&expected, &found, image.width() as usize);
        let [expected_px, found_px] = [&expected, &found].map(|covered| count(covered));
        // A surface seen edge on is thinner than a pixel; renderers without antialiasing may show none of it.
        let must_be_seen = hole_share.is_some() || reference.is_equal && expected_px > FEW_PX;
        let result = if must_be_seen && found_px == 0 {
            "red: empty"
        } else if reference.is_background && found_px > 0 {
            "red: something where nothing is"
        } else if between_db.is_some_and(|db| db < MIN_DB) {
            "red: CPU and GPU differ"
        } else if reference.is_equal && psnr_db < MIN_DB {
            "red: differs from the equal scene"
        } else if is_closed && hole_share.is_some_and(|share| share > MAX_HOLE_SHARE) {
            "red: holes"
        } else {
            "ok"
        };
        Ok(Self {
            result: result.to_owned(),
            reference: reference.name,
            flip: Some(flip(&reference.image, image)?.mean()),
            psnr_db: Some(psnr_db),
            between_db,
            hole_share,
            covered_share: Some(found_px as f64 / found.len().max(1) as f64),
            message: None,
        })
    }

    /// Returns the result of a cloud that is refused, as it must be.
    pub(super) fn refused(message: String) -> Self {
        Self::without_image("ok: refused", Some(message))
    }

    /// Returns the result of a cloud that must be refused and is not.
    pub(super) fn drawn_anyway() -> Self {
        Self::without_image("red: not refused", None)
    }

    /// Returns the result of a cloud that should be drawn and is refused.
    pub(super) fn failed(message: String) -> Self {
        Self::without_image("red: refused", Some(message))
    }

    fn without_image(result: &str, message: Option<String>) -> Self {
        Self {
            result: result.to_owned(),
            reference: "message",
            message,
            ..Self::default()
        }
    }
}

/// Returns a mask of the pixels that differ from the background by more than rounding.
fn coverage(image: &RgbaImage) -> Vec<bool> {
    let differs = |pixel: &Rgba<u8>| pixel.0.iter().zip(BACKGROUND).any(|(a, b)| a.abs_diff(b) > 3);
    image.pixels().map(differs).collect()
}

/// Share of the inner pixels of the reference's surface at which the image shows the background; `None` where it has no
/// inner pixels. On an outline coverage is rounding.
fn hole_share(expected: &[bool], found: &[bool], width: usize) -> Option<f64> {
    let height = expected.len() / width.max(1);
    let (mut inner, mut open) = (0usize, 0usize);
    for row in 1..height.saturating_sub(1) {
        for column in 1..width.saturating_sub(1) {
            let is_inner = (row - 1..=row + 1).all(|row| {
                expected[row * width + column - 1..=row * width + column + 1]
                    .iter()
                    .all(|&covered| covered)
            });
            if is_inner {
                inner += 1;
                open += usize::from(!found[row * width + column]);
            }
        }
    }
    (inner > 0).then(|| open as f64 / inner as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey square with an edge of 8 pixels at the centre of 16.
    fn square(gray: u8) -> RgbaImage {
        let [red, green, blue] = BACKGROUND;
        RgbaImage::from_fn(16, 16, |x, y| {
            let is_inside = (4..12).contains(&x) && (4..12).contains(&y);
            Rgba(if is_inside {
                [gray, gray, gray, 255]
            } else {
                [red, green, blue, 255]
            })
        })
    }

    fn judge(reference: &Reference, image: &RgbaImage, other: Option<&RgbaImage>) -> String {
        Judged::of(reference, image, other, true).unwrap().result
    }

    #[test]
    fn results() {
        let [bright, dark] = [square(200), square(120)];
        let nothing = Reference::empty([16, 16]);
        let equal = Reference::drawn(bright.clone());
        let traced = Reference {
            is_equal: false,
            ..equal.clone()
        };
        assert_eq!(judge(&equal, &bright, Some(&bright)), "ok");
        assert_eq!(judge(&traced, &dark, None), "ok", "errors against a truth are figures");
        assert_eq!(judge(&equal, &dark, None), "red: differs from the equal scene");
        assert_eq!(judge(&traced, &bright, Some(&dark)), "red: CPU and GPU differ");
        assert_eq!(judge(&equal, &nothing.image, None), "red: empty");
        assert_eq!(judge(&nothing, &bright, None), "red: something where nothing is");
        let mut open = bright.clone();
        for (x, y) in [(6, 6), (7, 6)] {
            open.put_pixel(x, y, nothing.image.pixels().next().copied().unwrap());
        }
        // Two of 36 inner pixels.
        assert_eq!(judge(&traced, &open, None), "red: holes");
        let judged = Judged::of(&traced, &open, None, false).unwrap();
        assert_eq!((judged.result.as_str(), judged.hole_share), ("ok", Some(2.0 / 36.0)));
    }
}
