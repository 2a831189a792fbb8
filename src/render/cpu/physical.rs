//! Metallic–roughness shading on the CPU (`shaders/common/physical.wgsl`), of eight pixels at a time. The formulas:
//! `scene/light/physical_light.rs`.

use super::eight::Vectors;
use super::illumination::{Illumination, Lit, ShadedLamp, Toward};
use super::tile::LANES;
use crate::scene::{AlbedoCurve, DIELECTRIC, EnvironmentMap, Lamp, PhysicalLight, PhysicalTables};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use glam::{Vec3, Vec4};

/// A losing share is not taken for less, so that quotients are numbers.
const MIN_LOSS: f32 = 1e-6;

/// Linear light on eight pixels, by the surface's reflection of it.
// Four sums by interaction with the surface: colours are multiplied in once, not for each light.
struct Light<S: Simd> {
    /// Reflected light per unit of the reflectance at normal incidence, and the light reflected in addition to that.
    mirrored: [f32x8<S>; 3],
    grazing: [f32x8<S>; 3],
    /// Light that goes to further bounces, and light that is let in.
    lost: [f32x8<S>; 3],
    let_in: [f32x8<S>; 3],
}

/// Exposure of eight pixels to the ambient light.
#[derive(Clone, Copy)]
struct Exposure<S: Simd> {
    /// The cosine between their normal and the eye.
    facing: f32x8<S>,
    /// Reflection of the environment: a scale on the reflectance, and a bias.
    scale: f32x8<S>,
    bias: f32x8<S>,
    /// The share of that light that gets here.
    open: f32x8<S>,
}

/// Linear light that comes from eight pixels with linear `albedo`; the share `open` of the light from around reaches
/// them.
#[inline(always)]
pub(super) fn lit<S: Simd>(
    simd: S,
    illumination: &Illumination<'_>,
    physical: &PhysicalLight,
    lit: &Lit<S>,
    albedo: [f32x8<S>; 3],
    open: f32x8<S>,
) -> [f32x8<S>; 3] {
    let curve = &physical.tables.curve;
    let facing = lit.normal.dot(lit.to_eye).max(f32x8::splat(simd, 0.0));
    let [scale, bias, loss, let_in] = entry_at(simd, curve, facing);
    let [loss, let_in] = [
        loss * (1.0 / curve.mean_loss.max(MIN_LOSS)),
        let_in * (1.0 / curve.mean_let_in),
    ];
    let exposure = Exposure {
        facing,
        scale,
        bias,
        open,
    };
    let light = on_surface(simd, illumination, physical, lit, exposure);
    // No closures that are called twice: see `raster.rs`.
    [
        light.color(physical, 0, albedo[0], [loss, let_in]),
        light.color(physical, 1, albedo[1], [loss, let_in]),
        light.color(physical, 2, albedo[2], [loss, let_in]),
    ]
}

/// All light.
#[inline(always)]
fn on_surface<S: Simd>(
    simd: S,
    illumination: &Illumination<'_>,
    physical: &PhysicalLight,
    lit: &Lit<S>,
    exposure: Exposure<S>,
) -> Light<S> {
    let Exposure {
        facing,
        scale,
        bias,
        open,
    } = exposure;
    let curve = &physical.tables.curve;
    let to_mirrored = lit.normal.times(facing * 2.0).minus(lit.to_eye);
    let mirrored = environment_at(simd, physical, in_environment(simd, physical, to_mirrored));
    let matt = harmonics_at(simd, physical, in_environment(simd, physical, lit.normal));
    let mut light = Light {
        mirrored: [mirrored[0] * scale, mirrored[1] * scale, mirrored[2] * scale],
        grazing: [mirrored[0] * bias, mirrored[1] * bias, mirrored[2] * bias],
        lost: [
            matt[0] * curve.mean_loss,
            matt[1] * curve.mean_loss,
            matt[2] * curve.mean_loss,
        ],
        let_in: [
            matt[0] * curve.mean_let_in,
            matt[1] * curve.mean_let_in,
            matt[2] * curve.mean_let_in,
        ],
    };
    for channel in 0..3 {
        light.mirrored[channel] *= open;
        light.grazing[channel] *= open;
        light.lost[channel] *= open;
        light.let_in[channel] *= open;
    }
    // The headlight is a lamp at the eye.
    let head = Lamp {
        place: Vec4::W,
        color: Vec3::splat(illumination.lights.head),
    };
    let head = head.is_on().then_some(ShadedLamp {
        lamp: &head,
        shadow: None,
    });
    for shaded in head.into_iter().chain(illumination.lamps()) {
        let toward = lit.toward(simd, shaded);
        light.add(simd, physical, lit, exposure, &toward, shaded.lamp.color);
    }
    light
}

impl<S: Simd> Light<S> {
    /// Computes a colour channel of the light that the surface sends to the eye; the last argument has the fractions
    /// lost and let in towards the eye.
    #[inline(always)]
    fn color(
        &self,
        physical: &PhysicalLight,
        channel: usize,
        albedo: f32x8<S>,
        [loss, let_in]: [f32x8<S>; 2],
    ) -> f32x8<S> {
        let metallic = physical.metallic;
        let mean_loss = physical.tables.curve.mean_loss;
        let reflectance = albedo * metallic + (1.0 - metallic) * DIELECTRIC;
        // The mean of Schlick's formula weighted by the cosine.
        let mean = albedo * (20.0 / 21.0) + 1.0 / 21.0;
        let of_metal = mean * mean * (1.0 - mean_loss) / (1.0 - mean * mean_loss);
        let of_dielectric = AlbedoCurve::of_more_bounces(DIELECTRIC, mean_loss);
        let again = of_metal * metallic + (1.0 - metallic) * of_dielectric;
        let mirrored = reflectance.mul_add(self.mirrored[channel], self.grazing[channel]);
        let bounced = (again * loss).mul_add(self.lost[channel], mirrored);
        (albedo * let_in * (1.0 - metallic)).mul_add(self.let_in[channel], bounced)
    }

    /// Adds the light of a lamp of this colour.
    #[inline(always)]
    fn add(
        &mut self,
        simd: S,
        physical: &PhysicalLight,
        lit: &Lit<S>,
        exposure: Exposure<S>,
        toward: &Toward<S>,
        color: Vec3,
    ) {
        let one = f32x8::splat(simd, 1.0);
        let alpha2 = physical.alpha * physical.alpha;
        let half = lit.to_eye.plus(toward.to_lamp);
        let half = half.times(1.0 / half.dot(half).max(f32::MIN_POSITIVE).sqrt());
        // 1 - cos², from the difference of two directions: cosines near 1 have too few digits.
        let between = half.minus(lit.normal);
        let short = between.dot(between) * 0.5;
        let sine2 = short * (2.0 - short);
        let spread = (one - sine2).mul_add(f32x8::splat(simd, alpha2), sine2);
        let visibility = 0.5
            / (smith(simd, exposure.facing, toward.facing, alpha2)
                + smith(simd, toward.facing, exposure.facing, alpha2))
            .max(f32::MIN_POSITIVE);
        let light = toward.facing * toward.share;
        let highlight = light * visibility * (alpha2 / (spread * spread));
        let grazing = 1.0 - half.dot(lit.to_eye).max(f32x8::splat(simd, 0.0)).min(one);
        let squared = grazing * grazing;
        let fresnel = squared * squared * grazing;
        let [_, _, loss, let_in] = entry_at(simd, &physical.tables.curve, toward.facing);
        let soft = light * exposure.open;
        let (lost, let_in) = (soft * loss, soft * let_in);
        let (mirrored, grazing) = (highlight * (one - fresnel), highlight * fresnel);
        for (channel, color) in color.to_array().into_iter().enumerate() {
            let color = f32x8::splat(simd, color);
            self.mirrored[channel] = mirrored.mul_add(color, self.mirrored[channel]);
            self.grazing[channel] = grazing.mul_add(color, self.grazing[channel]);
            self.lost[channel] = lost.mul_add(color, self.lost[channel]);
            self.let_in[channel] = let_in.mul_add(color, self.let_in[channel]);
        }
    }
}

#[inline(always)]
fn smith<S: Simd>(simd: S, first: f32x8<S>, second: f32x8<S>, alpha2: f32) -> f32x8<S> {
    let squared = (second * second).mul_add(f32x8::splat(simd, 1.0 - alpha2), f32x8::splat(simd, alpha2));
    first * squared.sqrt()
}

/// The entry of a curve between two that are stored.
#[inline(always)]
fn entry_at<S: Simd>(simd: S, curve: &AlbedoCurve, cosine: f32x8<S>) -> [f32x8<S>; 4] {
    const LAST: usize = AlbedoCurve::COUNT - 1;
    let place = cosine.min(f32x8::splat(simd, 1.0)) * LAST as f32;
    let first = place.floor().min(f32x8::splat(simd, (LAST - 1) as f32));
    let share = place - first;
    let first = simd.cvt_i32_f32x8(first);
    let mut columns = [[0.0; LANES]; 4];
    for lane in 0..LANES {
        let at = first[lane] as usize;
        let [before, after] = [&curve.entries[at], &curve.entries[at + 1]];
        for (column, (before, after)) in columns.iter_mut().zip(before.iter().zip(after)) {
            column[lane] = before + share[lane] * (after - before);
        }
    }
    let [scale, bias, loss, let_in] = &columns;
    [
        f32x8::from_slice(simd, scale),
        f32x8::from_slice(simd, bias),
        f32x8::from_slice(simd, loss),
        f32x8::from_slice(simd, let_in),
    ]
}

/// A direction of view space in the axes of the environment.
#[inline(always)]
fn in_environment<S: Simd>(simd: S, physical: &PhysicalLight, direction: Vectors<S>) -> Vectors<S> {
    let to = &physical.environment_from_view;
    let [x, y, z] = [to.row(0), to.row(1), to.row(2)];
    Vectors {
        x: Vectors::splat(simd, x).dot(direction),
        y: Vectors::splat(simd, y).dot(direction),
        z: Vectors::splat(simd, z).dot(direction),
    }
}

/// Evaluates the spherical harmonics: the environment light that a matt white surface with this normal reflects.
#[inline(always)]
fn harmonics_at<S: Simd>(simd: S, physical: &PhysicalLight, normal: Vectors<S>) -> [f32x8<S>; 3] {
    let Vectors { x, y, z } = normal;
    let basis = [y, z, x, x * y, y * z, z * z * 3.0 - 1.0, x * z, x.mul_sub(x, y * y)];
    let [mean, others @ ..] = &physical.harmonics.0;
    let mut sums = [
        f32x8::splat(simd, mean.x),
        f32x8::splat(simd, mean.y),
        f32x8::splat(simd, mean.z),
    ];
    for (value, coefficient) in basis.into_iter().zip(others) {
        for (sum, coefficient) in sums.iter_mut().zip(coefficient.to_array()) {
            *sum = value.mul_add(f32x8::splat(simd, coefficient), *sum);
        }
    }
    let nothing = f32x8::splat(simd, 0.0);
    [sums[0].max(nothing), sums[1].max(nothing), sums[2].max(nothing)]
}

/// Samples the environment reflected from a direction: interpolated between the centres of four texels of the unfolded
/// octahedron.
#[inline(always)]
fn environment_at<S: Simd>(simd: S, physical: &PhysicalLight, direction: Vectors<S>) -> [f32x8<S>; 3] {
    let one = f32x8::splat(simd, 1.0);
    let Vectors { x, y, z } = direction;
    let per_length = 1.0 / (x.abs() + y.abs() + z.abs()).max(f32::MIN_POSITIVE);
    let (across, along) = (x * per_length, z * per_length);
    let is_below = y.simd_lt(f32x8::splat(simd, 0.0));
    let folded_across = (one - along.abs()) * one.copysign(across);
    let folded_along = (one - across.abs()) * one.copysign(along);
    let across = simd.select_f32x8(is_below, folded_across, across);
    let along = simd.select_f32x8(is_below, folded_along, along);
    // Adds the border of one texel, less half a texel.
    let half = 0.5 * EnvironmentMap::EDGE as f32;
    let [column, row] = [across * half + (half + 0.5), along * half + (half + 0.5)];
    let (left, top) = (column.floor(), row.floor());
    let (beyond_left, beyond_top) = (column - left, row - top);
    let first = simd.cvt_i32_f32x8(top * PhysicalTables::WIDTH as f32 + left);
    let texels = &physical.tables.texels;
    let mut channels = [[0.0; LANES]; 4];
    for lane in 0..LANES {
        let at = first[lane] as usize;
        let [upper, lower] = [&texels[at..at + 2], &texels[at + PhysicalTables::WIDTH..][..2]];
        let (x, y) = (beyond_left[lane], beyond_top[lane]);
        for (place, channel) in channels.iter_mut().enumerate() {
            let above = upper[0][place] + x * (upper[1][place] - upper[0][place]);
            let below = lower[0][place] + x * (lower[1][place] - lower[0][place]);
            channel[lane] = above + y * (below - above);
        }
    }
    let [red, green, blue, _] = &channels;
    let light = physical.environment_light;
    [
        f32x8::from_slice(simd, red) * light,
        f32x8::from_slice(simd, green) * light,
        f32x8::from_slice(simd, blue) * light,
    ]
}
