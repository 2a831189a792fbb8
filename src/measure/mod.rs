//! Error metrics that compare a result with the ground truth: errors of images, of clouds and of normals, each with its
//! unit, its range and its source.
//!
//! | measure | of | unit, range | source |
//! |---|---|---|---|
//! | [`psnr_db`] | two images | decibels, 0 to ∞ (equal) | peak signal to noise over 8-bit channels |
//! | [`flip`] | two images | 0 (equal) to 1 | Andersson et al. 2020, differences that a person notices when flipping between them |
//! | [`ssim()`] | two images | −1 to 1 (equal) | Wang et al. 2004, preservation of luminance, contrast and structure |
//! | [`TemporalError`] | two consecutive images, and of the truth | FLIP, 0 to 1; share of a channel's range, 0 to 2 | – |
//! | [`PixelDifference`] | two images | pixels; steps of a channel, 0 to 255 | – |
//! | [`SurfaceError`] | depths of two views | pixels; fractions 0 to 1 | – |
//! | [`GeometryError`] | two clouds | scene units (squared: means); decibels | Tian et al. 2017, D1 and D2 of MPEG's `pc_error` |
//! | [`CloudError`] | two clouds with colours and normals | the same; degrees | colours and normals of nearest points |
//! | [`Change`] | two frames | scene units | D1 one way, point by point |
//! | [`AngularError`] | two sets of normals | degrees, 0 to 90 or 180 | – |
//!
//! PSNR and SSIM allow comparison with other work. PSNR weighs a shift of a thin line as much as a wrong colour, and
//! does not account for its visibility; FLIP does. SSIM distinguishes a change of luminance from a lost structure, but
//! sees no colours.

mod change;
mod difference;
mod flip;
mod geometry;
mod normals;
mod psnr;
mod ssim;
mod surface;
mod temporal;

pub use change::Change;
pub use difference::PixelDifference;
pub use flip::{ErrorMap, PIXELS_PER_DEGREE, Perceived, flip};
pub use geometry::{CloudError, CloudMismatch, Distances, GeometryError, OneWay, ReferenceCloud, Side};
pub use normals::{AngularError, Orientation, angle_deg};
pub use psnr::{mean_squared_error, psnr_db};
pub use ssim::{SSIM_WINDOW_PX, SsimError, ssim};
pub use surface::{DepthImage, DepthTolerance, SurfaceError, SurfaceMismatch};
pub use temporal::{Consecutive, TemporalError};

use image::RgbaImage;

/// Two images that cannot be compared pixel by pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a picture of {}x{} pixels cannot be compared with one of {}x{}", 
    test_px[0], test_px[1], reference_px[0], reference_px[1]
)]
pub struct SizeMismatch {
    /// Width and height of the truth.
    pub reference_px: [u32; 2],
    /// Width and height of the image compared with it.
    pub test_px: [u32; 2],
}

fn check_sizes(reference_px: [u32; 2], test_px: [u32; 2]) -> Result<(), SizeMismatch> {
    if reference_px == test_px {
        return Ok(());
    }
    Err(SizeMismatch { reference_px, test_px })
}

fn size_px(image: &RgbaImage) -> [u32; 2] {
    [image.width(), image.height()]
}
