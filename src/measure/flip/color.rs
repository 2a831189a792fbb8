//! The colour spaces of FLIP (Andersson et al. 2020, §4.1): linear sRGB, `YCxCz` for filtering, Hunt-adjusted L*a*b*
//! for distances.

use glam::{DMat3, DVec3, Mat3, Vec3};
use std::sync::LazyLock;

/// Chromaticities of the primaries of sRGB (ITU-R BT.709).
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// Chromaticity of its white, D65 to five digits.
const WHITE: [f64; 2] = [0.312_71, 0.329_02];

/// Threshold below which the cube root of L*a*b* becomes linear.
const LAB_DELTA: f32 = 6.0 / 29.0;

/// XYZ, relative to white, from linear sRGB, and back.
struct Matrices {
    white_relative_from_linear: Mat3,
    linear_from_white_relative: Mat3,
}

static MATRICES: LazyLock<Matrices> = LazyLock::new(|| {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let white = xyz(WHITE);
    let primaries = DMat3::from_cols_array_2d(&PRIMARIES.map(|primary| xyz(primary).to_array()));
    // The amount of each primary that adds up to white.
    let shares = primaries.inverse() * white;
    let xyz_from_linear = primaries * DMat3::from_diagonal(shares);
    let from_linear = DMat3::from_diagonal(white.recip()) * xyz_from_linear;
    Matrices {
        white_relative_from_linear: from_linear.as_mat3(),
        linear_from_white_relative: from_linear.inverse().as_mat3(),
    }
});

/// Linear values of the 256 stored ones.
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|stored| {
        let stored = stored as f64 / 255.0;
        let linear = if stored > 0.040_45 {
            ((stored + 0.055) / 1.055).powf(2.4)
        } else {
            stored / 12.92
        };
        linear as f32
    })
});

/// Light of a stored colour, 0 to 1 a channel.
pub(super) fn linear_from_stored(stored: [u8; 3]) -> Vec3 {
    Vec3::from_array(stored.map(|channel| LINEAR[channel as usize]))
}

/// Luminance (Y), red against green (Cx) and blue against yellow (Cz): linear, so that averaging light is averaging
/// them.
pub(super) fn ycxcz_from_linear(linear: Vec3) -> Vec3 {
    let relative = MATRICES.white_relative_from_linear * linear;
    Vec3::new(
        116.0 * relative.y - 16.0,
        500.0 * (relative.x - relative.y),
        200.0 * (relative.y - relative.z),
    )
}

pub(super) fn linear_from_ycxcz(ycxcz: Vec3) -> Vec3 {
    let y = (ycxcz.x + 16.0) / 116.0;
    MATRICES.linear_from_white_relative * Vec3::new(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0)
}

/// L*a*b* in which colours are the less colourful the darker they are, as Hunt found for eyes.
pub(super) fn hunt_lab_from_linear(linear: Vec3) -> Vec3 {
    let relative = MATRICES.white_relative_from_linear * linear;
    let [x, y, z] = relative.to_array().map(|share| {
        if share > LAB_DELTA.powi(3) {
            share.cbrt()
        } else {
            share / (3.0 * LAB_DELTA * LAB_DELTA) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    Vec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
}

/// `HyAB` distance: city-block between lightness and chroma, Euclidean within chroma. Better than ΔE where colours
/// differ much.
pub(super) fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_white_and_gray_have_no_chroma() {
        for (stored, lightness) in [(0u8, 0.0), (119, 50.0), (255, 100.0)] {
            let lab = hunt_lab_from_linear(linear_from_stored([stored; 3]));
            // The stored 119 is the closest to the grey of lightness 50: 50.03.
            assert!((lab.x - lightness).abs() < 0.05, "{lab}");
            assert!(lab.y.abs() < 1e-3 && lab.z.abs() < 1e-3, "{lab}");
        }
        let white = ycxcz_from_linear(Vec3::ONE);
        assert!(
            (white - Vec3::new(100.0, 0.0, 0.0)).abs().max_element() < 1e-3,
            "{white}"
        );
    }

    #[test]
    fn red_matches_published_values() {
        // L*a*b* of sRGB red under D65: 53.24, 80.09, 67.20; Hunt multiplies the last two by 0.01 L.
        let red = hunt_lab_from_linear(Vec3::X);
        let expected = Vec3::new(53.24, 0.5324 * 80.09, 0.5324 * 67.20);
        assert!((red - expected).abs().max_element() < 0.05, "{red}");
    }

    #[test]
    fn filtering_space_round_trips() {
        for stored in [[0, 0, 0], [255, 0, 17], [12, 200, 90], [3, 9, 251]] {
            let linear = linear_from_stored(stored);
            let back = linear_from_ycxcz(ycxcz_from_linear(linear));
            assert!(
                (back - linear).abs().max_element() < 1e-5,
                "{stored:?}: {back} for {linear}"
            );
        }
    }
}
