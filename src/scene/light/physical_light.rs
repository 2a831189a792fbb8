//! Inputs of metallic–roughness shading in addition to lamps: the material of an image, and its environment lighting.
//!
//! **How it works.** A surface is a blend of a dielectric (4 % mirrored, the rest scattered in its colour) and of a
//! metal (mirrored in its colour), as in glTF 2.0. For a lamp, with half vector h and cosines of the normal:
//!
//! - one bounce is D·V·F: the distribution of GGX, the height-correlated visibility of Smith (Heitz 2014), and Schlick
//!   1994;
//! - further bounces, and the light scattered below, are products of losses at both angles (`albedo_curve.rs`).
//!
//! So a white surface in white light from all sides is white, whatever its material: no energy is lost or created. For
//! the environment, one bounce is the split sum of Karis 2013, and the rest is a matt surface's.
//!
//! Light is in the unit of lamps: a matt white surface across a lamp of 1 is white. So formulas lack a π of the books.

use super::albedo_curve::AlbedoCurve;
use super::lights::AMBIENT;
use crate::scene::ScenePacket;
use crate::scene::environment::{Environment, EnvironmentMap, Harmonics};
use crate::scene::style::{LightRig, Lighting};
use glam::Mat3;
use std::sync::{Arc, Mutex, PoisonError};

/// Intensity of the environment that fills areas lamps do not reach.
const ENVIRONMENT_WITH_LAMPS: f32 = 0.3;

/// The material and the environment of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalLight {
    /// Metalness of the material, 0 to 1.
    pub metallic: f32,
    /// Square of the roughness, for lamps.
    pub alpha: f32,
    /// From directions of view space to directions of the environment.
    pub environment_from_view: Mat3,
    /// Factor on the texels.
    pub environment_light: f32,
    /// Diffuse irradiance of matt surfaces as spherical harmonics, by their normal in the environment; with that
    /// factor.
    pub harmonics: Harmonics,
    /// Lookup tables that depend on the roughness.
    pub tables: Arc<PhysicalTables>,
}

/// Lookup tables of a roughness: the filtered environment, and the reflection of light at any angle.
#[derive(Debug, PartialEq)]
pub struct PhysicalTables {
    /// Rows of [`PhysicalTables::WIDTH`]: the environment as the roughness mirrors it, and one more row that begins
    /// with the entries of the curve.
    pub texels: Vec<[f32; 4]>,
    /// Albedo curve: the mirrored and the lost light.
    pub curve: AlbedoCurve,
}

impl PhysicalTables {
    /// Texels in a row, with the border of the environment.
    pub const WIDTH: usize = EnvironmentMap::EDGE + 2;
    /// Rows, the last of which is the curve's.
    pub const HEIGHT: usize = Self::WIDTH + 1;

    fn new(environment: Environment, roughness: f32) -> Self {
        let curve = AlbedoCurve::new(roughness.max(PhysicalLight::MIN_ROUGHNESS));
        let mut texels = environment.map().mirrored(roughness);
        texels.extend(curve.entries);
        texels.resize(Self::WIDTH * Self::HEIGHT, [0.0; 4]);
        Self { texels, curve }
    }

    /// Returns the tables of a roughness, recomputed if they are not among the last ones.
    fn of(environment: Environment, roughness: f32) -> Arc<Self> {
        /// Number of images whose tables are cached: both halves of a comparison.
        const MAX_CACHED: usize = 4;
        static CACHED: Mutex<Vec<(Environment, u32, Arc<PhysicalTables>)>> = Mutex::new(Vec::new());
        // Entries are replaced as a whole.
        let mut cached = CACHED.lock().unwrap_or_else(PoisonError::into_inner);
        let bits = roughness.to_bits();
        let known = cached.iter().position(|(of, at, _)| (*of, *at) == (environment, bits));
        let entry = match known {
            Some(place) => cached.remove(place),
            None => (environment, bits, Arc::new(Self::new(environment, roughness))),
        };
        let tables = Arc::clone(&entry.2);
        cached.insert(0, entry);
        cached.truncate(MAX_CACHED);
        tables
    }
}

impl PhysicalLight {
    /// Minimum roughness of highlights of lamps: a mirror would show a lamp as a point without size.
    pub const MIN_ROUGHNESS: f32 = 0.045;

    /// The physical light of a packet; `None` if it is shaded otherwise.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        if packet.lighting() != Lighting::Physical {
            return None;
        }
        let light = &packet.style.light;
        let roughness = light.roughness.clamp(0.0, 1.0);
        let tables = PhysicalTables::of(light.environment, roughness);
        let environment_light = match (light.environment, light.rig) {
            (Environment::None, _) => AMBIENT,
            (_, LightRig::None) => 1.0,
            _ => ENVIRONMENT_WITH_LAMPS,
        };
        let up = packet.view.up.environment_from_frame();
        Some(Self {
            metallic: light.metallic.clamp(0.0, 1.0),
            alpha: roughness.max(Self::MIN_ROUGHNESS).powi(2),
            // Fixed to the scene, unlike lamps: reflections that slide over a surface distinguish polished from
            // painted, and the sky stays above.
            environment_from_view: up * packet.view.view_from_frame_rotation.transpose(),
            environment_light,
            harmonics: light.environment.map().harmonics().times(environment_light),
            tables,
        })
    }
}
