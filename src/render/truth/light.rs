//! Light on the surfaces of the ground truth, at each sample.
//!
//! The formulas are those of the renderers (`shaders/common/light.wgsl`, `shaders/common/physical.wgsl`), in f64: the
//! reference that the image of a mode is measured against has its light.

use super::rays::TruthView;
use crate::render::constants::{HEADLIGHT_AMBIENT, HEADLIGHT_SHININESS, HEADLIGHT_SPECULAR};
use crate::scene::{AlbedoCurve, DIELECTRIC, EnvironmentMap, Lighting, PhysicalLight, PhysicalTables};
use glam::DVec3;

/// A losing share is not taken for less, so that quotients are numbers.
const MIN_LOSS: f64 = 1e-6;

impl TruthView {
    /// Returns a colour (0 to 1) lit by the view's settings. Vectors in view space; the normal has unit length.
    pub(super) fn lit(&self, color: DVec3, normal: DVec3, ray: DVec3) -> DVec3 {
        if let Some(physical) = &self.physical {
            let to_eye = -ray.normalize();
            // Surfaces have two sides.
            let normal = normal * 1f64.copysign(normal.dot(to_eye));
            return to_display(on_material(physical, to_linear(color), normal, to_eye).min(DVec3::ONE));
        }
        if self.lighting == Lighting::Unlit {
            return color;
        }
        let [ambient, specular] = [HEADLIGHT_AMBIENT, HEADLIGHT_SPECULAR].map(f64::from);
        let facing = normal.dot(ray.normalize()).abs();
        let lit = color * (ambient + (1.0 - ambient) * facing) + specular * facing.powi(HEADLIGHT_SHININESS as i32);
        lit.min(DVec3::ONE)
    }
}

/// Linear light of the environment that a surface with linear `albedo` sends to the eye.
fn on_material(physical: &PhysicalLight, albedo: DVec3, normal: DVec3, to_eye: DVec3) -> DVec3 {
    let curve = &physical.tables.curve;
    let [mean_loss, mean_let_in] = [curve.mean_loss, curve.mean_let_in].map(f64::from);
    let facing = normal.dot(to_eye).max(0.0);
    let [scale, bias, loss, let_in] = entry_at(curve, facing);
    let [loss, let_in] = [loss / mean_loss.max(MIN_LOSS), let_in / mean_let_in];
    let to_environment = physical.environment_from_view.as_dmat3();
    let mirrored = environment_at(physical, to_environment * (normal * (2.0 * facing) - to_eye));
    let matt = harmonics_at(physical, to_environment * normal);
    let metallic = f64::from(physical.metallic);
    let reflectance = albedo * metallic + (1.0 - metallic) * f64::from(DIELECTRIC);
    // The mean of Schlick's formula by the cosine.
    let mean = albedo * (20.0 / 21.0) + 1.0 / 21.0;
    let of_metal = mean * mean * (1.0 - mean_loss) / (DVec3::ONE - mean * mean_loss);
    let of_dielectric = f64::from(AlbedoCurve::of_more_bounces(DIELECTRIC, curve.mean_loss));
    let again = of_metal * metallic + (1.0 - metallic) * of_dielectric;
    let first_bounce = mirrored * (reflectance * scale + bias);
    let more_bounces = again * matt * (loss * mean_loss);
    first_bounce + more_bounces + albedo * matt * (let_in * mean_let_in * (1.0 - metallic))
}

/// The entry of a curve between two that are stored.
fn entry_at(curve: &AlbedoCurve, cosine: f64) -> [f64; 4] {
    const LAST: usize = AlbedoCurve::COUNT - 1;
    let place = cosine.min(1.0) * LAST as f64;
    let first = (place.floor() as usize).min(LAST - 1);
    let share = place - first as f64;
    std::array::from_fn(|column| {
        let [before, after] = [first, first + 1].map(|at| f64::from(curve.entries[at][column]));
        before + share * (after - before)
    })
}

/// The environment light that a matt white surface with this normal reflects.
fn harmonics_at(physical: &PhysicalLight, normal: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = normal;
    let basis = [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
    let terms = basis.into_iter().zip(physical.harmonics.0);
    let sum: DVec3 = terms.map(|(value, coefficient)| value * coefficient.as_dvec3()).sum();
    sum.max(DVec3::ZERO)
}

/// The environment from a direction: between the centres of four texels of the unfolded octahedron.
fn environment_at(physical: &PhysicalLight, direction: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let [across, along] = if y < 0.0 {
        [(1.0 - z.abs()) * 1f64.copysign(x), (1.0 - x.abs()) * 1f64.copysign(z)]
    } else {
        [x, z]
    };
    // With the border of a texel, less half of one.
    let half = 0.5 * EnvironmentMap::EDGE as f64;
    let [column, row] = [across, along].map(|place| place * half + (half + 0.5));
    let texel = |column: f64, row: f64| {
        let [red, green, blue, _] = physical.tables.texels[row as usize * PhysicalTables::WIDTH + column as usize];
        DVec3::new(red.into(), green.into(), blue.into())
    };
    let (left, top) = (column.floor(), row.floor());
    let along_row = |row: f64| texel(left, row).lerp(texel(left + 1.0, row), column - left);
    along_row(top).lerp(along_row(top + 1.0), row - top) * f64::from(physical.environment_light)
}

/// The light of display-referred channels from 0 to 1 (sRGB, IEC 61966-2-1).
pub(super) fn to_linear(channels: DVec3) -> DVec3 {
    channels.map(|channel| {
        if channel <= 0.040_45 {
            channel / 12.92
        } else {
            ((channel + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// The channels of light from 0 to 1.
pub(super) fn to_display(light: DVec3) -> DVec3 {
    light.map(|light| {
        if light <= 0.003_130_8 {
            light * 12.92
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Harmonics;
    use glam::{Mat3, Vec3};
    use std::sync::Arc;

    /// Uniform light from all sides.
    fn white(metallic: f32) -> PhysicalLight {
        let mut harmonics = [Vec3::ZERO; 9];
        harmonics[0] = Vec3::ONE;
        PhysicalLight {
            metallic,
            alpha: 0.25,
            environment_from_view: Mat3::IDENTITY,
            environment_light: 1.0,
            harmonics: Harmonics(harmonics),
            tables: Arc::new(PhysicalTables {
                texels: vec![[1.0; 4]; PhysicalTables::WIDTH * PhysicalTables::HEIGHT],
                curve: AlbedoCurve::new(0.5),
            }),
        }
    }

    #[test]
    fn white_surfaces_in_white_light_are_white_from_every_side() {
        for metallic in [0.0, 0.5, 1.0] {
            for facing in [0.1f64, 0.37, 0.8, 1.0] {
                let to_eye = DVec3::new((1.0 - facing * facing).sqrt(), 0.0, facing);
                let light = on_material(&white(metallic), DVec3::ONE, DVec3::Z, to_eye);
                assert!(
                    (light - DVec3::ONE).abs().max_element() < 1e-5,
                    "{metallic}, {facing}: {light}"
                );
                let dark = on_material(&white(metallic), DVec3::ZERO, DVec3::Z, to_eye);
                assert!(dark.max_element() < 0.7, "{metallic}, {facing}: {dark}");
            }
        }
    }

    #[test]
    fn the_environment_is_seen_where_its_texels_are() {
        let mut light = white(1.0);
        // Red rises with the column and green with the row of the unfolded octahedron.
        let texels = (0..PhysicalTables::WIDTH * PhysicalTables::HEIGHT).map(|place| {
            let [column, row] = [place % PhysicalTables::WIDTH, place / PhysicalTables::WIDTH];
            [column as f32, row as f32, 0.0, 0.0]
        });
        light.tables = Arc::new(PhysicalTables {
            texels: texels.collect(),
            curve: AlbedoCurve::new(0.5),
        });
        let half = 0.5 * EnvironmentMap::EDGE as f64;
        let at = |x: f64, y: f64, z: f64| {
            let found = environment_at(&light, DVec3::new(x, y, z));
            [(found.x - 0.5) / half - 1.0, (found.y - 0.5) / half - 1.0]
        };
        let is_near =
            |found: [f64; 2], expected: [f64; 2]| (0..2).all(|axis| (found[axis] - expected[axis]).abs() < 1e-5);
        assert!(is_near(at(0.0, 1.0, 0.0), [0.0, 0.0]));
        assert!(is_near(at(1.0, 2.0, 1.0), [0.25, 0.25]));
        assert!(is_near(at(1.0, -2.0, 1.0), [0.75, 0.75]));
        assert!(is_near(at(-1.0, -2.0, 1.0), [-0.75, 0.75]));
    }

    #[test]
    fn channels_and_light_are_inverse() {
        for channel in 0..=255 {
            let channel = DVec3::splat(f64::from(channel) / 255.0);
            assert!((to_display(to_linear(channel)) - channel).abs().max_element() < 1e-6);
        }
        assert!((to_linear(DVec3::splat(188.0 / 255.0)).x - 0.5).abs() < 0.005);
    }
}
