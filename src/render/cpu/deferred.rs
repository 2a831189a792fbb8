//! Deferred shading on the CPU (`shaders/passes/shade.wgsl`): eight pixels of a tile are lit at a time, when its
//! surface is blended. The lights: `scene/light/lights.rs`.

use super::eight::{Vectors, lane_numbers};
use super::illumination::{Illumination, Lit, ShadedLamp};
use super::linear::{to_display, to_linear};
use super::physical;
use super::view::PixelView;
use crate::scene::Lights;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use glam::Vec3;

/// Eight pixels of a surface.
pub(super) struct Surface<S: Simd> {
    /// Display-referred red, green and blue, 0 to 1.
    pub(super) albedo: [f32x8<S>; 3],
    /// In view space, of any length; zero where unknown.
    pub(super) normal: Vectors<S>,
    /// Reversed.
    pub(super) depth: f32x8<S>,
}

/// Linear light on eight pixels: the factors on their colours, and the summands.
struct Light<S: Simd> {
    diffuse: [f32x8<S>; 3],
    specular: [f32x8<S>; 3],
}

/// The rays through eight pixels from `[x, y]` on to the right; their z is −1.
#[inline(always)]
pub(super) fn rays<S: Simd>(simd: S, view: &PixelView, [x, y]: [i32; 2]) -> Vectors<S> {
    let right = lane_numbers(simd) + (x as f32 + 0.5 - view.center_px[0]);
    let down = y as f32 + 0.5 - view.center_px[1];
    Vectors {
        x: right * (1.0 / view.px_per_slope[0]),
        y: f32x8::splat(simd, down / view.px_per_slope[1]),
        z: f32x8::splat(simd, -1.0),
    }
}

/// The display-referred colours of a surface at eight pixels from `pixel` on to the right. Without a normal they stay.
#[inline(always)]
pub(super) fn shade<S: Simd>(
    simd: S,
    illumination: &Illumination<'_>,
    view: &PixelView,
    pixel: [i32; 2],
    surface: &Surface<S>,
) -> [f32x8<S>; 3] {
    let splat = |value: f32| f32x8::splat(simd, value);
    let length2 = surface.normal.dot(surface.normal);
    let has_normal = length2.simd_gt(splat(0.0));
    let normal = surface.normal.times(1.0 / length2.max(f32::MIN_POSITIVE).sqrt());
    let ray = rays(simd, view, pixel);
    let to_eye = ray.times(-1.0 / ray.dot(ray).sqrt());
    let distance = view.near / surface.depth.max(f32::MIN_POSITIVE);
    let facing = normal.dot(to_eye);
    let lit = Lit {
        // Surfaces are two-sided.
        normal: normal.times(splat(1.0).copysign(facing)),
        to_eye,
        position: ray.times(distance),
    };
    let open = match &illumination.occlusion {
        Some(occlusion) => occlusion.openness(simd, view, pixel, lit.normal, lit.normal.dot(ray)),
        None => splat(1.0),
    };
    let [red, green, blue] = surface.albedo;
    // No `map` over arrays of registers: see `raster.rs`.
    let albedo = [to_linear(simd, red), to_linear(simd, green), to_linear(simd, blue)];
    let linear = if let Some(physical) = illumination.physical {
        physical::lit(simd, illumination, physical, &lit, albedo, open)
    } else {
        let light = light_on(simd, illumination, &lit, facing.abs());
        [
            albedo[0].mul_add(light.diffuse[0] * open, light.specular[0]),
            albedo[1].mul_add(light.diffuse[1] * open, light.specular[1]),
            albedo[2].mul_add(light.diffuse[2] * open, light.specular[2]),
        ]
    };
    let one = splat(1.0);
    [
        simd.select_f32x8(has_normal, to_display(simd, linear[0].min(one)), red),
        simd.select_f32x8(has_normal, to_display(simd, linear[1].min(one)), green),
        simd.select_f32x8(has_normal, to_display(simd, linear[2].min(one)), blue),
    ]
}

/// All lights together, after Lambert and Blinn 1977; `facing` is the cosine between the normal and the direction to
/// the eye.
#[inline(always)]
fn light_on<S: Simd>(simd: S, illumination: &Illumination<'_>, lit: &Lit<S>, facing: f32x8<S>) -> Light<S> {
    let lights = &illumination.lights;
    let splat = |value: f32| f32x8::splat(simd, value);
    let diffuse = facing.mul_add(splat(lights.head), splat(lights.ambient));
    // The half vector of the headlight is the direction to the eye.
    let specular = highlight(facing) * (lights.head * lights.specular);
    let mut light = Light {
        diffuse: [diffuse; 3],
        specular: [specular; 3],
    };
    for shaded in illumination.lamps() {
        light.add(simd, lit, shaded, lights.specular);
    }
    light
}

impl<S: Simd> Light<S> {
    /// Adds the light of a lamp.
    #[inline(always)]
    fn add(&mut self, simd: S, lit: &Lit<S>, shaded: ShadedLamp<'_>, white: f32) {
        let toward = lit.toward(simd, shaded);
        let nothing = f32x8::splat(simd, 0.0);
        let half = toward.to_lamp.plus(lit.to_eye);
        let along = lit.normal.dot(half).max(nothing) * (1.0 / half.dot(half).max(f32::MIN_POSITIVE).sqrt());
        let highlight = simd.select_f32x8(toward.facing.simd_gt(nothing), highlight(along), nothing) * white;
        let (facing, highlight) = (toward.facing * toward.share, highlight * toward.share);
        let Vec3 { x, y, z } = shaded.lamp.color;
        for (channel, color) in [x, y, z].into_iter().enumerate() {
            self.diffuse[channel] = facing.mul_add(f32x8::splat(simd, color), self.diffuse[channel]);
            self.specular[channel] = highlight.mul_add(f32x8::splat(simd, color), self.specular[channel]);
        }
    }
}

/// The highlight of Blinn 1977 for the cosine between normal and half vector.
#[inline(always)]
fn highlight<S: Simd>(cosine: f32x8<S>) -> f32x8<S> {
    const { assert!(Lights::SHININESS == 32) };
    let squared = cosine * cosine;
    let fourth_power = squared * squared;
    let eighth_power = fourth_power * fourth_power;
    let sixteenth_power = eighth_power * eighth_power;
    sixteenth_power * sixteenth_power
}
