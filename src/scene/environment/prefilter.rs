//! Environment prefiltering for surfaces of different roughness: blurred as wide as each scatters light (Karis 2013).
//!
//! A blurred map has the light of a surface that is seen along its normal. The approximation ignores that its
//! highlights are longer when it is seen edge-on. Samples are of microfacet normals (Walter et al. 2007), and each
//! takes the mean over the part of the environment that it represents (Křivánek and Colbert 2008), so that a few make
//! no noise. They are the same for each texel and each run.

use super::octahedral::Octahedral;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Samples for a texel.
const SAMPLES: u32 = 96;

/// The environment blurred for a roughness above 0; `halves` are the environment, and each half of the one before.
pub(super) fn blurred(halves: &[Octahedral], roughness: f32, edge: usize) -> Octahedral {
    let alpha = roughness * roughness;
    let texels = halves[0].edge() * halves[0].edge();
    let samples: Vec<Sample> = (0..SAMPLES)
        .map(|index| Sample::new(index, alpha, texels as f32))
        .filter(|sample| sample.toward.z > 0.0)
        .collect();
    let all: f32 = samples.iter().map(|sample| sample.toward.z).sum();
    Octahedral::new(edge, |normal| {
        let (right, up) = normal.any_orthonormal_pair();
        let light = samples.iter().map(|sample| {
            let Vec3 { x, y, z } = sample.toward;
            light_of_level(halves, right * x + up * y + normal * z, sample.level) * z
        });
        light.sum::<Vec3>() / all
    })
}

/// Sample direction of the light relative to a normal along z, and the number of times that the environment is to be
/// halved.
struct Sample {
    toward: Vec3,
    level: f32,
}

impl Sample {
    fn new(index: u32, alpha: f32, texels: f32) -> Self {
        let share = (index as f32 + 0.5) / SAMPLES as f32;
        // The golden ratio: samples that are close in one coordinate are far apart in the other.
        let turn = TAU * (0.618_034 * index as f32).fract();
        let alpha2 = alpha * alpha;
        let cosine2 = (1.0 - share) / (1.0 + (alpha2 - 1.0) * share);
        let (cosine, sine) = (cosine2.sqrt(), (1.0 - cosine2).max(0.0).sqrt());
        let half = Vec3::new(sine * turn.cos(), sine * turn.sin(), cosine);
        let toward = half * (2.0 * cosine) - Vec3::Z;
        let spread = cosine2 * (alpha2 - 1.0) + 1.0;
        let density = alpha2 / (PI * spread * spread) / 4.0;
        // Relative to the solid angle of a texel. One more level, so that neighbouring samples overlap.
        let wide = texels / (SAMPLES as f32 * density * 4.0 * PI);
        let level = (0.5 * wide.max(1.0).log2() + 1.0).max(0.0);
        Self { toward, level }
    }
}

fn light_of_level(halves: &[Octahedral], direction: Vec3, level: f32) -> Vec3 {
    let last = halves.len() - 1;
    let first = (level as usize).min(last);
    let light = halves[first].at(direction);
    if first == last {
        return light;
    }
    light.lerp(halves[first + 1].at(direction), level - first as f32)
}
