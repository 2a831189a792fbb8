//! Deferred shading on the processor (`shaders/passes/shade.wgsl`): light falls on eight pixels of a tile at a time,
//! when its surface is blended. The lights: `scene/lights.rs`.

use super::ambient_occlusion::Occlusion;
use super::eight::{Vectors, lane_numbers};
use super::linear::{to_display, to_linear};
use super::shadow::ShadowMap;
use super::view::PixelView;
use crate::scene::{Lamp, Lights};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use glam::Vec3;

/// Eight pixels of a surface.
pub(super) struct Surface<S: Simd> {
    /// Display-referred red, green and blue, 0 to 1.
    pub(super) albedo: [f32x8<S>; 3],
    /// In view space, of any length; of none where nobody knows it.
    pub(super) normal: Vectors<S>,
    /// Reversed.
    pub(super) depth: f32x8<S>,
}

/// What falls on surfaces, and what keeps it away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Illumination<'a> {
    pub(super) lights: Lights,
    pub(super) occlusion: Option<Occlusion<'a>>,
    pub(super) shadow: Option<ShadowMap<'a>>,
}

/// Linear light on eight pixels: what their colours are multiplied with, and what is added.
struct Light<S: Simd> {
    diffuse: [f32x8<S>; 3],
    specular: [f32x8<S>; 3],
}

/// Eight pixels with what their light depends on, in view space; directions have unit length.
struct Lit<S: Simd> {
    normal: Vectors<S>,
    to_eye: Vectors<S>,
    position: Vectors<S>,
}

/// The rays through eight pixels from `[x, y]` on to the right; their z is −1.
#[inline(always)]
pub(super) fn rays<S: Simd>(simd: S, view: &PixelView, [x, y]: [i32; 2]) -> Vectors<S> {
    let right = lane_numbers(simd) + (x as f32 + 0.5 - view.middle_px[0]);
    let down = y as f32 + 0.5 - view.middle_px[1];
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
        // Surfaces have two sides.
        normal: normal.times(splat(1.0).copysign(facing)),
        to_eye,
        position: ray.times(distance),
    };
    let mut light = lit.light(simd, illumination, facing.abs());
    if let Some(occlusion) = &illumination.occlusion {
        light.dim(occlusion.openness(simd, view, pixel, lit.normal, lit.normal.dot(ray)));
    }
    let [red, green, blue] = surface.albedo;
    // No `map` over arrays of registers: see `raster.rs`.
    let [red_diffuse, green_diffuse, blue_diffuse] = light.diffuse;
    let [red_specular, green_specular, blue_specular] = light.specular;
    let lit = [
        lit_channel(simd, red, red_diffuse, red_specular),
        lit_channel(simd, green, green_diffuse, green_specular),
        lit_channel(simd, blue, blue_diffuse, blue_specular),
    ];
    [
        simd.select_f32x8(has_normal, lit[0], red),
        simd.select_f32x8(has_normal, lit[1], green),
        simd.select_f32x8(has_normal, lit[2], blue),
    ]
}

/// A display-referred channel in linear light.
#[inline(always)]
fn lit_channel<S: Simd>(simd: S, albedo: f32x8<S>, diffuse: f32x8<S>, specular: f32x8<S>) -> f32x8<S> {
    let linear = to_linear(simd, albedo).mul_add(diffuse, specular);
    to_display(simd, linear.min(f32x8::splat(simd, 1.0)))
}

impl<S: Simd> Light<S> {
    /// Leaves a share of what does not mirror lamps.
    #[inline(always)]
    fn dim(&mut self, share: f32x8<S>) {
        for diffuse in &mut self.diffuse {
            *diffuse *= share;
        }
    }
}

impl<S: Simd> Lit<S> {
    /// All lights together; `facing` is the cosine between the normal and the way to the eye.
    #[inline(always)]
    fn light(&self, simd: S, illumination: &Illumination<'_>, facing: f32x8<S>) -> Light<S> {
        let lights = &illumination.lights;
        let splat = |value: f32| f32x8::splat(simd, value);
        let diffuse = facing.mul_add(splat(lights.head), splat(lights.ambient));
        // The half vector of the head light is the way to the eye.
        let specular = highlight(facing) * (lights.head * lights.specular);
        let mut light = Light {
            diffuse: [diffuse; 3],
            specular: [specular; 3],
        };
        let mut shadow = illumination.shadow.as_ref();
        for lamp in lights.lamps.iter().filter(|lamp| lamp.is_on()) {
            // The first one is the key light.
            self.add(simd, (lamp, shadow.take()), lights.specular, &mut light);
        }
        light
    }

    /// Adds the light of a lamp.
    #[inline(always)]
    fn add(&self, simd: S, (lamp, shadow): (&Lamp, Option<&ShadowMap<'_>>), white: f32, light: &mut Light<S>) {
        let place = Vectors::splat(simd, lamp.place.truncate());
        let way = place.minus(self.position.times(f32x8::splat(simd, lamp.place.w)));
        let to_lamp = way.times(1.0 / way.dot(way).max(f32::MIN_POSITIVE).sqrt());
        let nothing = f32x8::splat(simd, 0.0);
        let facing = self.normal.dot(to_lamp).max(nothing);
        let half = to_lamp.plus(self.to_eye);
        let along = self.normal.dot(half).max(nothing) * (1.0 / half.dot(half).max(f32::MIN_POSITIVE).sqrt());
        let highlight = simd.select_f32x8(facing.simd_gt(nothing), highlight(along), nothing) * white;
        let (lit_facing, highlight) = match shadow {
            Some(shadow) => {
                let lit = shadow.light_of_key(simd, self.position, self.normal, facing);
                (facing * lit, highlight * lit)
            }
            None => (facing, highlight),
        };
        let Vec3 { x, y, z } = lamp.color;
        for (channel, color) in [x, y, z].into_iter().enumerate() {
            light.diffuse[channel] = lit_facing.mul_add(f32x8::splat(simd, color), light.diffuse[channel]);
            light.specular[channel] = highlight.mul_add(f32x8::splat(simd, color), light.specular[channel]);
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
