//! Directional albedo of rough surfaces: the light they mirror, and the energy that one pass over their microfacets
//! loses.
//!
//! **How it works.** Microfacets follow GGX (Walter et al. 2007) with the height-correlated masking of Smith (Heitz
//! 2014). Their formula covers one bounce only. On rough surfaces light bounces again, so a white metal would be grey.
//! Kulla and Conty 2017 return the lost energy as a second lobe, a product of the losses at both angles: it is the same
//! when light and eye change places, and energy is neither created nor lost. A dielectric scatters the light that its
//! microfacets let in, again in proportion at both angles.
//!
//! The losses are integrals with one parameter, the cosine between normal and eye; they are tabulated for the roughness
//! of an image, and both renderers interpolate between the same entries. Samples are of the microfacets that the eye
//! sees (Heitz 2018), on a regular grid: there is no noise.

use glam::Vec3;
use std::f32::consts::PI;

/// Normal-incidence reflectance (F0) of a dielectric: glass and plastics, a refractive index of 1.5.
pub(crate) const DIELECTRIC: f32 = 0.04;

/// The reflectance of a surface of one roughness, by the cosine between its normal and the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct AlbedoCurve {
    /// Table entries for cosines from 0 to 1 in equal steps: the mirrored light per unit of the reflectance at normal
    /// incidence, and that in addition to it (the two sums of Karis 2013); the fraction of light that a bounce loses;
    /// and the fraction that the microfacets of a dielectric let in.
    pub entries: [[f32; 4]; Self::COUNT],
    /// Means over all directions of light, by their cosine, of the last two.
    pub mean_loss: f32,
    /// The curve of the share that is let in.
    pub mean_let_in: f32,
}

/// Cells of the grid of samples, along both sides of half a disk.
const GRID: [usize; 2] = [48, 32];

impl AlbedoCurve {
    /// Entries.
    // The losses have one parameter, as the roughness is the whole image's: 10 ms when it changes.
    pub const COUNT: usize = 128;

    /// Creates the albedo curve of a roughness from 0 to 1.
    pub fn new(roughness: f32) -> Self {
        let alpha = roughness * roughness;
        let mut entries = [[0.0; 4]; Self::COUNT];
        for (place, entry) in entries.iter_mut().enumerate() {
            let cosine = place as f32 / (Self::COUNT - 1) as f32;
            let [scale, bias] = mirrored(cosine, alpha);
            *entry = [scale, bias, 1.0 - scale - bias, 0.0];
        }
        let mean_loss = mean(&entries, 2);
        let again = Self::of_more_bounces(DIELECTRIC, mean_loss);
        for entry in &mut entries {
            let [scale, bias, loss, _] = *entry;
            entry[3] = 1.0 - (DIELECTRIC * scale + bias + again * loss);
        }
        Self {
            mean_loss,
            mean_let_in: mean(&entries, 3),
            entries,
        }
    }

    /// The share of the light of further bounces that a surface keeps of its own colour, if it mirrors so much at right
    /// angles.
    pub fn of_more_bounces(reflectance: f32, mean_loss: f32) -> f32 {
        // The mean of Schlick's formula weighted by the cosine.
        let mean = reflectance + (1.0 - reflectance) / 21.0;
        mean * mean * (1.0 - mean_loss) / (1.0 - mean * mean_loss)
    }
}

/// The mean of a column over the half sphere by the cosine, of entries between which is a straight line.
fn mean(entries: &[[f32; 4]; AlbedoCurve::COUNT], column: usize) -> f32 {
    let step = 1.0 / (AlbedoCurve::COUNT - 1) as f64;
    let pieces = entries.windows(2).zip(0..).map(|(ends, place)| {
        let [first, second] = [ends[0], ends[1]].map(|entry| f64::from(entry[column]));
        let from = f64::from(place) * step;
        // The cosine-weighted integral of a line.
        step * (0.5 * (first + second) * from + step * (first + 2.0 * second) / 6.0)
    });
    (2.0 * pieces.sum::<f64>()) as f32
}

/// Returns the mirrored light per unit of the reflectance at normal incidence, and that in addition to it.
fn mirrored(cosine: f32, alpha: f32) -> [f32; 2] {
    let cosine = cosine.max(1e-4);
    let to_eye = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let of_eye = masking(to_eye.z, alpha);
    let (mut sums, mut all) = ([0.0f64; 2], 0.0);
    for row in 0..GRID[0] {
        // Rows are closer together towards the edge of the disk: strongly tilted microfacets of smooth surfaces are
        // there.
        let inwards = 1.0 - (row as f32 + 0.5) / GRID[0] as f32;
        let share = 1.0 - inwards.powi(4);
        let weight = inwards.powi(3);
        all += f64::from(weight) * GRID[1] as f64;
        for column in 0..GRID[1] {
            // Half of the disk: the other half is its mirror image.
            let angle = PI * ((column as f32 + 0.5) / GRID[1] as f32 - 0.5);
            let half = seen_microfacet(to_eye, alpha, share, angle);
            let facing = to_eye.dot(half).max(0.0);
            let to_light = half * (2.0 * facing) - to_eye;
            if to_light.z <= 0.0 {
                continue;
            }
            let visible = (1.0 + of_eye) / (1.0 + of_eye + masking(to_light.z, alpha));
            let fresnel = (1.0 - facing).powi(5);
            sums[0] += f64::from(weight * visible * (1.0 - fresnel));
            sums[1] += f64::from(weight * visible * fresnel);
        }
    }
    sums.map(|sum| (sum / all) as f32)
}

/// Smith's auxiliary function of GGX.
fn masking(cosine: f32, alpha: f32) -> f32 {
    let cosine2 = cosine * cosine;
    let slope2 = (1.0 - cosine2).max(0.0) / cosine2.max(1e-12);
    0.5 * ((1.0 + alpha * alpha * slope2).sqrt() - 1.0)
}

/// Returns the normal of a microfacet that the eye sees, for a position on the disk that it projects them to: the root
/// of `share` from its centre (Heitz 2018).
fn seen_microfacet(to_eye: Vec3, alpha: f32, share: f32, angle: f32) -> Vec3 {
    let stretched = Vec3::new(alpha * to_eye.x, alpha * to_eye.y, to_eye.z).normalize();
    let aside = stretched.x.hypot(stretched.y);
    let right = if aside > 0.0 {
        Vec3::new(-stretched.y, stretched.x, 0.0) / aside
    } else {
        Vec3::X
    };
    let up = stretched.cross(right);
    let radius = share.sqrt();
    // The mirror plane is that of `up`: half of the disk is to its right.
    let x = radius * angle.cos();
    let whole = radius * angle.sin();
    let blend = 0.5 * (1.0 + stretched.z);
    let y = (1.0 - blend) * (1.0 - x * x).max(0.0).sqrt() + blend * whole;
    let on_half_sphere = right * x + up * y + stretched * (1.0 - x * x - y * y).max(0.0).sqrt();
    Vec3::new(
        alpha * on_half_sphere.x,
        alpha * on_half_sphere.y,
        on_half_sphere.z.max(0.0),
    )
    .normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Reflection by brute force: the formula of microfacets summed over the half sphere in double precision, in equal
    /// steps of the azimuth, and in steps of the slope of microfacets that are closer to each other for steep ones.
    fn mirrored_by_quadrature(cosine: f64, alpha: f64) -> [f64; 2] {
        const STEPS: [usize; 2] = [1000, 500];
        let to_eye = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
        let masking = |cosine: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)).sqrt() - 1.0);
        let mut sums = [0.0; 2];
        for i in 0..STEPS[0] {
            // Quantiles of the GGX distribution: its density cancels out.
            let root = 1.0 - (i as f64 + 0.5) / STEPS[0] as f64;
            let share = 1.0 - root.powi(4);
            let height2 = root.powi(4) / (1.0 + (alpha * alpha - 1.0) * share);
            let (height, aside) = (height2.sqrt(), (1.0 - height2).sqrt());
            for j in 0..STEPS[1] {
                let azimuth = TAU * (j as f64 + 0.5) / STEPS[1] as f64;
                let half = [aside * azimuth.cos(), aside * azimuth.sin(), height];
                let facing = half[0] * to_eye[0] + half[2] * to_eye[2];
                let light = 2.0 * facing * height - to_eye[2];
                if facing <= 0.0 || light <= 0.0 {
                    continue;
                }
                let visible = 1.0 / (1.0 + masking(cosine) + masking(light));
                // D V 4 cos(light) is reflected; the density of light is D cos(half) / (4 facing).
                let weight = 4.0 * root.powi(3) * visible * facing / (cosine * height) / (STEPS[0] * STEPS[1]) as f64;
                let fresnel = (1.0 - facing).powi(5);
                sums[0] += weight * (1.0 - fresnel);
                sums[1] += weight * fresnel;
            }
        }
        sums
    }

    #[test]
    fn the_reflected_share_matches_numerical_integration() {
        for roughness in [0.1, 0.25, 0.5, 0.75, 1.0f32] {
            let alpha = roughness * roughness;
            for cosine in [0.05, 0.2, 0.5, 0.9, 1.0f32] {
                let exact = mirrored_by_quadrature(f64::from(cosine), f64::from(alpha));
                for (found, exact) in mirrored(cosine, alpha).into_iter().zip(exact) {
                    let off = (f64::from(found) - exact).abs();
                    assert!(off < 1e-3, "{roughness}, {cosine}: {found}, not {exact}");
                }
            }
        }
    }

    #[test]
    fn a_smooth_surface_is_a_mirror() {
        let curve = AlbedoCurve::new(0.0);
        assert!(curve.mean_loss < 1e-3);
        for (place, [scale, bias, loss, _]) in curve.entries.iter().enumerate().skip(4) {
            let cosine = place as f32 / (AlbedoCurve::COUNT - 1) as f32;
            let fresnel = (1.0 - cosine).powi(5);
            assert!(
                (bias - fresnel).abs() < 1e-4 && (scale - (1.0 - fresnel)).abs() < 1e-4,
                "{cosine}"
            );
            assert!(loss.abs() < 1e-4);
        }
    }

    #[test]
    fn rougher_surfaces_lose_more_energy() {
        let losses = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0].map(|roughness| AlbedoCurve::new(roughness).mean_loss);
        assert!(losses.is_sorted(), "{losses:?}");
        // At a roughness of 1, more than half.
        assert!((0.5..0.65).contains(&losses[5]), "{losses:?}");
    }
}
