//! Synthetic environments: light as a formula of its direction.

use glam::Vec3;

/// A photographer's studio: grey walls that are lighter above, a large soft light above the left shoulder of who looks
/// from the front, strips at both sides and a weaker one behind. Each side has a light, so that a turning shape is
/// never in the dark.
pub(super) fn studio(direction: Vec3) -> Vec3 {
    let walls = 0.14 + 0.16 * smoothstep(-0.4, 1.0, direction.y);
    let mut light = Vec3::splat(walls) * Vec3::new(1.0, 1.0, 1.03);
    for soft in &SOFT_LIGHTS {
        light += soft.color * soft.brightness * soft.shape(direction);
    }
    light
}

/// A clear sky above dry ground, with the sun 40 degrees high at the right of who looks from the front.
pub(super) fn sky(direction: Vec3) -> Vec3 {
    let horizon = Vec3::new(0.80, 0.90, 1.0);
    let zenith = Vec3::new(0.16, 0.34, 0.80);
    let ground = Vec3::new(0.30, 0.26, 0.21);
    let height = direction.y.max(0.0);
    let above = horizon.lerp(zenith, height.sqrt());
    let to_sun = direction.dot(SUN.normalize());
    // Haze around the sun, and its disk, which is six times as wide as the real one: as wide as a texel.
    let haze = Vec3::new(1.0, 0.9, 0.7) * (0.8 * to_sun.max(0.0).powi(24));
    let disk = Vec3::new(1.0, 0.93, 0.80) * (90.0 * smoothstep(0.9975, 0.9992, to_sun));
    let sky = above + haze + disk;
    // The horizon is slightly wider than a texel.
    ground.lerp(sky, smoothstep(-0.02, 0.02, direction.y))
}

/// White from all sides.
pub(super) fn uniform(_: Vec3) -> Vec3 {
    Vec3::ONE
}

const SUN: Vec3 = Vec3::new(0.55, 0.64, 0.53);

/// Rectangular area light with soft edges, as seen from the centre.
struct SoftLight {
    towards: Vec3,
    /// Slopes from its centre to its edges, rightwards and upwards.
    half: [f32; 2],
    brightness: f32,
    color: Vec3,
}

const SOFT_LIGHTS: [SoftLight; 5] = [
    SoftLight {
        towards: Vec3::new(-0.55, 0.75, 0.6),
        half: [0.55, 0.4],
        brightness: 5.0,
        color: Vec3::new(1.0, 0.97, 0.93),
    },
    SoftLight {
        towards: Vec3::new(1.0, 0.25, 0.35),
        half: [0.14, 0.75],
        brightness: 2.4,
        color: Vec3::new(0.93, 0.97, 1.0),
    },
    SoftLight {
        towards: Vec3::new(-1.0, 0.2, -0.3),
        half: [0.14, 0.75],
        brightness: 2.4,
        color: Vec3::new(0.93, 0.97, 1.0),
    },
    SoftLight {
        towards: Vec3::new(0.35, 0.55, -1.0),
        half: [0.6, 0.25],
        brightness: 2.8,
        color: Vec3::new(1.0, 0.98, 0.95),
    },
    SoftLight {
        towards: Vec3::new(0.0, 1.0, 0.0),
        half: [0.5, 0.5],
        brightness: 1.4,
        color: Vec3::ONE,
    },
];

impl SoftLight {
    /// 1 within, 0 outside.
    fn shape(&self, direction: Vec3) -> f32 {
        let towards = self.towards.normalize();
        let along = direction.dot(towards);
        if along <= 0.0 {
            return 0.0;
        }
        let aside = if towards.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
        let right = aside.cross(towards).normalize();
        let up = towards.cross(right);
        let slopes = [direction.dot(right) / along, direction.dot(up) / along];
        let inside = |axis: usize| 1.0 - smoothstep(self.half[axis] - 0.04, self.half[axis] + 0.04, slopes[axis].abs());
        inside(0) * inside(1)
    }
}

fn smoothstep(from: f32, to: f32, value: f32) -> f32 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
