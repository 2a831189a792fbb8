//! Passes that light the blended surface. They differ in light and surface.

use super::state::{ColorUse, ScreenPass};
use crate::render::effects::{ambient_occlusion, shadow};
use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::{ShaderFile, shader_file};
use crate::scene::{AlbedoCurve, EnvironmentMap, Lights, PhysicalLight, ScenePacket};
use bytemuck::Zeroable;
use glam::Vec3;

const BLINN_PHONG: ShaderFile = shader_file!("common/blinn_phong.wgsl");
const PHYSICAL: ShaderFile = shader_file!("common/physical.wgsl");
const OWN_COLORS: ShaderFile = shader_file!("common/own_colors.wgsl");
const TEXTURED: ShaderFile = shader_file!("common/textured.wgsl");
const PHOTOS: ShaderFile = shader_file!("common/photos.wgsl");
const PHOTO_ANSWERS: ShaderFile = shader_file!("common/photo_answers.wgsl");
const SHADE_FILE: ShaderFile = shader_file!("passes/shade.wgsl");

/// Lights the blended surface; the output is sums, as the attribute pass gives them without lighting (Hofer et al. 2018
/// §3.6).
pub(in crate::render::gpu) const SHADE: ScreenPass = ScreenPass {
    name: "shade",
    files: &[BLINN_PHONG, OWN_COLORS, SHADE_FILE],
    parts: &[&LIGHTS, &ambient_occlusion::gpu::PART, &shadow::gpu::PART],
    source: Some(Source::Surfaces),
    color: ColorUse::replacing(Target::Sums),
    depth: None,
};

/// Deferred shading of surfaces with a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade physically",
    files: &[PHYSICAL, OWN_COLORS, SHADE_FILE],
    parts: &[&LIGHTS, &MATERIAL, &ambient_occlusion::gpu::PART, &shadow::gpu::PART],
    ..SHADE
};

/// Deferred shading of surfaces with view-dependent texturing (Yang et al. 2006 §3).
pub(in crate::render::gpu) const SHADE_PHOTOS: ScreenPass = ScreenPass {
    name: "shade images",
    files: &[BLINN_PHONG, PHOTOS, TEXTURED, SHADE_FILE],
    source: Some(Source::Textured),
    ..SHADE
};

/// Deferred shading of surfaces with view-dependent texturing and a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHOTOS_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade images physically",
    files: &[PHYSICAL, PHOTOS, TEXTURED, SHADE_FILE],
    parts: SHADE_PHYSICAL.parts,
    ..SHADE_PHOTOS
};

/// Deferred shading of the view-dependent texturing results.
pub(in crate::render::gpu) const SHADE_PHOTO_ANSWERS: ScreenPass = ScreenPass {
    name: "shade photo answers",
    files: &[BLINN_PHONG, PHOTO_ANSWERS, TEXTURED, SHADE_FILE],
    source: Some(Source::PhotoAnswers),
    ..SHADE
};

/// Deferred shading of the view-dependent texturing results with a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHOTO_ANSWERS_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade photo answers physically",
    files: &[PHYSICAL, PHOTO_ANSWERS, TEXTURED, SHADE_FILE],
    parts: SHADE_PHYSICAL.parts,
    ..SHADE_PHOTO_ANSWERS
};

const LIGHTS: Part = Part {
    constants: || declared![MAX_LAMPS, SHININESS],
    uniform: Some(Uniform {
        name: "lights",
        layout: &LightsUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&lights(packet)).to_vec(),
    }),
};

/// Maximum number of lamps in addition to the headlight.
const MAX_LAMPS: u32 = Lights::MAX_LAMPS as u32;

/// The power of highlights.
const SHININESS: u32 = Lights::SHININESS;

shared_struct! {
    /// As [`Lights`] has them.
    LightsUniform as "Lights" {
        /// From all sides.
        ambient: f32,
        /// From the eye.
        head: f32,
        /// Specular intensity: the whiteness of highlights.
        specular: f32,
        /// Padding.
        unused: f32,
        /// In view space: where a lamp is (the fourth is 1), or from which direction it shines (0).
        lamp_places: [[f32; 4]; Lights::MAX_LAMPS],
        /// Linear; black ones are none.
        lamp_colors: [[f32; 4]; Lights::MAX_LAMPS],
    }
}

fn lights(packet: &ScenePacket) -> LightsUniform {
    Lights::of(packet).map_or_else(LightsUniform::zeroed, |lights| LightsUniform {
        ambient: lights.ambient,
        head: lights.head,
        specular: lights.specular,
        unused: 0.0,
        lamp_places: lights.lamps.map(|lamp| lamp.place.to_array()),
        lamp_colors: lights.lamps.map(|lamp| lamp.color.extend(0.0).to_array()),
    })
}

const MATERIAL: Part = Part {
    constants: || declared![ALBEDO_ENTRIES, ENVIRONMENT_EDGE],
    uniform: Some(Uniform {
        name: "physical",
        layout: &PhysicalUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&physical(packet)).to_vec(),
    }),
};

/// Edge length of the environment texture.
const ENVIRONMENT_EDGE: u32 = EnvironmentMap::EDGE as u32;
const ALBEDO_ENTRIES: u32 = AlbedoCurve::COUNT as u32;

shared_struct! {
    /// As [`PhysicalLight`] has it.
    PhysicalUniform as "Physical" {
        /// Metalness of the surfaces.
        metallic: f32,
        /// The square of their roughness.
        alpha: f32,
        /// Mean of the curve of the light lost.
        mean_loss: f32,
        /// Mean of the curve of the light admitted.
        mean_let_in: f32,
        /// Columns of the rotation from view space into the axes of the environment.
        environment_from_view_x: [f32; 4],
        /// The second column.
        environment_from_view_y: [f32; 4],
        /// The third column.
        environment_from_view_z: [f32; 4],
        /// Spherical harmonics of the environment light that matt surfaces reflect, as a polynomial of their normal.
        harmonics: [[f32; 4]; 9],
        /// Factor on the texels of the environment.
        environment_light: f32,
        /// Padding.
        unused_a: f32,
        /// Padding.
        unused_b: [f32; 2],
    }
}

fn physical(packet: &ScenePacket) -> PhysicalUniform {
    let Some(physical) = PhysicalLight::of(packet) else {
        return PhysicalUniform::zeroed();
    };
    let curve = &physical.tables.curve;
    let column = |axis: Vec3| axis.extend(0.0).to_array();
    PhysicalUniform {
        metallic: physical.metallic,
        alpha: physical.alpha,
        mean_loss: curve.mean_loss,
        mean_let_in: curve.mean_let_in,
        environment_from_view_x: column(physical.environment_from_view.x_axis),
        environment_from_view_y: column(physical.environment_from_view.y_axis),
        environment_from_view_z: column(physical.environment_from_view.z_axis),
        harmonics: physical.harmonics.0.map(column),
        environment_light: physical.environment_light,
        unused_a: 0.0,
        unused_b: [0.0; 2],
    }
}
