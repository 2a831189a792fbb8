//! Illumination of surfaces, eight pixels at a time: the lit surfaces, and the lamps; shared by the shading models.

use super::eight::Vectors;
use super::photos::Projected;
use crate::render::effects::ambient_occlusion::cpu::Occlusion;
use crate::render::effects::shadow::cpu::ShadowMap;
use crate::scene::{Lamp, Lights, PhysicalLight};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Light that falls on surfaces, and its occluders.
#[derive(Debug, Clone, Copy)]
pub(super) struct Illumination<'a> {
    pub(super) lights: Lights,
    pub(super) occlusion: Option<Occlusion<'a>>,
    pub(super) shadow: Option<ShadowMap<'a>>,
    /// Physically based light, if surfaces have a material, and there is an environment.
    pub(super) physical: Option<&'a PhysicalLight>,
    /// Projected images that surfaces are coloured from, if their colours are not those of points.
    pub(super) posed_images: Option<&'a Projected<'a>>,
}

impl Illumination<'_> {
    /// The lamps that shine, with the shadow of the first one, which is the key light.
    #[inline(always)]
    pub(super) fn lamps(&self) -> impl Iterator<Item = ShadedLamp<'_>> {
        let mut shadow = self.shadow.as_ref();
        let lamps = self.lights.lamps.iter();
        lamps
            .map(move |lamp| ShadedLamp {
                lamp,
                shadow: shadow.take(),
            })
            .filter(|shaded| shaded.lamp.is_on())
    }
}

/// A lamp that shines, with its occlusion.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShadedLamp<'a> {
    pub(super) lamp: &'a Lamp,
    pub(super) shadow: Option<&'a ShadowMap<'a>>,
}

/// Eight pixels with the inputs of their lighting, in view space; directions have unit length.
pub(super) struct Lit<S: Simd> {
    /// Towards the eye.
    pub(super) normal: Vectors<S>,
    pub(super) to_eye: Vectors<S>,
    pub(super) position: Vectors<S>,
}

/// The direction to a lamp.
pub(super) struct Toward<S: Simd> {
    pub(super) to_lamp: Vectors<S>,
    /// Its cosine with the normal; 0 from behind.
    pub(super) facing: f32x8<S>,
    /// The share of the light of the lamp that gets there.
    pub(super) share: f32x8<S>,
}

impl<S: Simd> Lit<S> {
    #[inline(always)]
    pub(super) fn toward(&self, simd: S, shaded: ShadedLamp<'_>) -> Toward<S> {
        let ShadedLamp { lamp, shadow } = shaded;
        let place = Vectors::splat(simd, lamp.place.truncate());
        let way = place.minus(self.position.times(f32x8::splat(simd, lamp.place.w)));
        let to_lamp = way.times(1.0 / way.dot(way).max(f32::MIN_POSITIVE).sqrt());
        let facing = self.normal.dot(to_lamp).max(f32x8::splat(simd, 0.0));
        let share = match shadow {
            Some(shadow) => shadow.light_of_key(simd, self.position, self.normal, facing),
            None => f32x8::splat(simd, 1.0),
        };
        Toward { to_lamp, facing, share }
    }
}
