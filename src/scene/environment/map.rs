//! An environment made ready for light: diffuse light, and the reflections of surfaces of each roughness.

use super::harmonics::Harmonics;
use super::octahedral::Octahedral;
use super::prefilter::blurred;
use glam::Vec3;

/// Texels along an edge of the environment, and of maps of every roughness above 0. Blurrier maps have no detail for
/// more of them.
const EDGE: usize = EnvironmentMap::EDGE;
const EDGES: [usize; 8] = [128, 64, 64, 32, 32, 32, 32, 32];

/// An environment made ready for light.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentMap {
    harmonics: Harmonics,
    /// For roughness 0, and in equal steps up to 1.
    levels: Vec<Octahedral>,
}

impl EnvironmentMap {
    /// Texels along an edge of the square that directions are mapped to, without its border.
    pub const EDGE: usize = 256;

    /// Creates an environment map of the light from each direction, with the exposure at which a matt white surface is
    /// just white where most light falls on it. Light that is not finite or is below 0 counts as none.
    pub(super) fn new(light: impl Fn(Vec3) -> Vec3 + Sync) -> Self {
        let light = |direction| {
            let light = light(direction);
            if light.is_finite() {
                light.max(Vec3::ZERO)
            } else {
                Vec3::ZERO
            }
        };
        let map = Octahedral::new(EDGE, light);
        let exposure = exposure(&Harmonics::of(&map));
        let map = Octahedral::new(EDGE, |direction| light(direction) * exposure);
        let mut halves = vec![map];
        while let Some(last) = halves.last().filter(|last| last.edge() > 2) {
            halves.push(last.halved());
        }
        let harmonics = Harmonics::of(&halves[0]);
        let steps = (1..).zip(EDGES);
        let blurred = steps.map(|(step, edge)| blurred(&halves, step as f32 / EDGES.len() as f32, edge));
        let mut levels: Vec<Octahedral> = blurred.collect();
        halves.truncate(1);
        levels.splice(0..0, halves);
        Self { harmonics, levels }
    }

    /// The light that a matt white surface sends back.
    pub fn harmonics(&self) -> &Harmonics {
        &self.harmonics
    }

    /// Returns the prefiltered environment that a surface of a roughness from 0 to 1 reflects: rows of texels with a
    /// border of one around a square of [`EnvironmentMap::EDGE`], interpolated between the two nearest levels.
    pub(in crate::scene) fn mirrored(&self, roughness: f32) -> Vec<[f32; 4]> {
        let place = roughness.clamp(0.0, 1.0) * EDGES.len() as f32;
        let first = (place as usize).min(EDGES.len() - 1);
        let share = place - first as f32;
        let [sharp, blurred] = [&self.levels[first], &self.levels[first + 1]];
        // An image has a single roughness: with one map blended here, pixels read four texels instead of eight.
        let texels = Octahedral::new(EDGE, |direction| sharp.at(direction).lerp(blurred.at(direction), share));
        texels
            .texels()
            .iter()
            .map(|texel| texel.extend(0.0).to_array())
            .collect()
    }
}

/// Returns the exposure factor that makes the most light of a matt white surface 1; 1 without light.
fn exposure(harmonics: &Harmonics) -> f32 {
    let map = Octahedral::new(16, |normal| harmonics.at(normal));
    let max = map
        .shares()
        .map(|(_, light, _)| light.max_element())
        .fold(0.0, f32::max);
    let exposure = 1.0 / max;
    if exposure.is_finite() && max > 0.0 {
        exposure
    } else {
        1.0
    }
}
