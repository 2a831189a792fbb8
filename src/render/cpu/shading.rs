//! Headlight of `shaders/common/light.wgsl`.

use crate::render::constants::HEADLIGHT_SHININESS;
use crate::scene::Lighting;
use glam::Vec3;

pub(super) use crate::render::constants::{BACK_SIDE, HEADLIGHT_AMBIENT as AMBIENT, HEADLIGHT_SPECULAR as SPECULAR};

/// The colour of a patch and its light.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shading {
    /// Red, green and blue, 0 to 1.
    pub(super) color: [f32; 3],
    pub(super) light: Light,
    /// A factor on the mask, where masks are summed up.
    pub(super) weight: f32,
    /// Normal at which the blended surface is lit, if it is lit.
    pub(super) normal: Option<SurfaceNormal>,
}

/// Surface normal that a patch contributes to the sum of normals, in view space. Surfaces have two sides: summed
/// normals are turned towards the eye.
#[derive(Debug, Clone, Copy)]
pub(super) enum SurfaceNormal {
    /// One normal for all pixels.
    Same(Vec3),
    /// Normal of a surface in another direction than the patch: the sum of the functions `p`, `q` and `w` of pixels
    /// times `along_rays` is the product of the normal and the ray that has z = −1, whose sign determines which side is
    /// seen.
    OfSideSeen { normal: Vec3, along_rays: [f32; 3] },
}

/// A factor on a colour, and white that is added to it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Light {
    /// Everywhere.
    Same([f32; 2]),
    /// Factors, and white, at the corners `−u−v`, `u−v`, `v−u` and `u+v`.
    OfCorners([[f32; 4]; 2]),
    /// Worked out at each pixel.
    OfPixels,
    /// Light computed at each pixel, on a surface in another direction than the patch, as in
    /// [`SurfaceNormal::OfSideSeen`].
    OfPixelsOn([f32; 3]),
}

impl Light {
    /// Computes the lighting of a patch at `center` from the eye; its half edges may be needed.
    #[inline(always)]
    pub(super) fn new(lighting: Lighting, normal: Vec3, center: Vec3, u: Vec3, v: Vec3) -> Self {
        match lighting {
            Lighting::Unlit | Lighting::Lambert | Lighting::BlinnPhong | Lighting::Physical => Self::Same([1.0, 0.0]),
            Lighting::PerSurfel => Self::Same(headlight(normal, center)),
            Lighting::PerVertex => {
                let corners = [-u - v, u - v, v - u, u + v];
                let lights = corners.map(|corner| headlight(normal, center + corner));
                Self::OfCorners([0, 1].map(|part| lights.map(|light| light[part])))
            }
            Lighting::PerFragment => Self::OfPixels,
        }
    }
}

// The exponent computed by the multiplications below, and by those in `raster.rs`.
const _: () = assert!(HEADLIGHT_SHININESS == 3 * 8);

/// Light from the eye, along a vector of any length.
pub(super) fn headlight(normal: Vec3, from_eye: Vec3) -> [f32; 2] {
    headlight_of_cosine(normal.dot(from_eye.normalize_or_zero()).abs())
}

/// Computes the headlight from the cosine between the normal and the direction to the eye.
#[inline(always)]
pub(super) fn headlight_of_cosine(facing: f32) -> [f32; 2] {
    let facing8 = facing.powi(8);
    [
        AMBIENT + (1.0 - AMBIENT) * facing,
        SPECULAR * facing8 * facing8 * facing8,
    ]
}

/// The colour of a surfel that faces away, if back sides are to be distinguished.
#[inline(always)]
pub(super) fn seen_from_behind(color: [f32; 3]) -> [f32; 3] {
    let [red, green, blue] = color;
    [red * BACK_SIDE, green * BACK_SIDE, blue * BACK_SIDE]
}

/// A colour of bytes, 0 to 1.
#[inline(always)]
pub(super) fn unit_color([red, green, blue]: [u8; 3]) -> [f32; 3] {
    let unit = |channel: u8| f32::from(channel) * (1.0 / 255.0);
    [unit(red), unit(green), unit(blue)]
}
