//! Lights of deferred shading: the illumination of the finished surface of an image, in linear light.
//!
//! **How it works** (Hofer et al. 2018 §3.6; Botsch and Kobbelt 2003). Splats write colours, normals and depths instead
//! of lit colours; lighting is evaluated once for each pixel of the blended surface. A packet's lights are given in
//! view space, as renderers need them: lamps move with the camera, so that the visible side is lit. Colours are linear,
//! and such that a white surface across a lamp of 1 is white.
//!
//! Light of a lamp follows Lambert, with the highlights of Blinn 1977 where they are requested. The headlight shines
//! from the eye. Surfaces are two-sided: normals are turned towards the eye first.

use crate::scene::ScenePacket;
use crate::scene::style::{LightRig, Lighting};
use glam::{Vec3, Vec4};

/// Light from all sides.
pub(super) const AMBIENT: f32 = 0.08;

/// The lights of a packet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// Light from all sides.
    pub ambient: f32,
    /// Light from the eye.
    pub head: f32,
    /// Intensity of specular highlights, which are white.
    pub specular: f32,
    /// Lamps in addition to the headlight; black ones are off.
    pub lamps: [Lamp; Lights::MAX_LAMPS],
    /// Distance to the centre of the cloud: a unit in which distances of surfaces are near 1.
    pub usual_distance: f32,
}

/// A lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// In view space: where it is (the fourth is 1), or from which direction it shines (0).
    pub place: Vec4,
    /// Red, green and blue, linear.
    pub color: Vec3,
}

impl Lamp {
    const NONE: Self = Self {
        place: Vec4::Z,
        color: Vec3::ZERO,
    };

    /// One that is infinitely far away, in a direction of view space.
    fn far(x: f32, y: f32, z: f32, color: Vec3) -> Self {
        Self {
            place: Vec3::new(x, y, z).normalize().extend(0.0),
            color,
        }
    }

    /// Returns true if the lamp is on.
    pub fn is_on(&self) -> bool {
        self.color != Vec3::ZERO
    }
}

impl Lights {
    /// Specular exponent of Blinn 1977, which determines how small highlights are.
    pub const SHININESS: u32 = 32;

    /// The first lamp, if it is far away, so that its shadow can be determined.
    pub fn key(&self) -> Option<&Lamp> {
        self.lamps.first().filter(|lamp| lamp.is_on() && lamp.place.w == 0.0)
    }

    /// Maximum number of lamps in addition to the headlight.
    pub const MAX_LAMPS: usize = 4;

    /// Returns the lights of a packet; `None` where lighting is evaluated per splat, or there is none.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        let light = &packet.style.light;
        let specular = match packet.lighting() {
            // There, ambient light and highlights come from [`PhysicalLight`](crate::scene::PhysicalLight).
            Lighting::Lambert | Lighting::Physical => 0.0,
            Lighting::BlinnPhong => 0.25,
            Lighting::Unlit | Lighting::PerSurfel | Lighting::PerVertex | Lighting::PerFragment => {
                return None;
            }
        };
        let center = packet.view.to_view(packet.bounds.center());
        let radius = packet.bounds.radius();
        let rig = light.rig;
        let (head, lamps) = match rig {
            LightRig::None => (0.0, Vec::new()),
            LightRig::Head => (1.0 - AMBIENT, Vec::new()),
            LightRig::ThreePoint => (0.1, three_point()),
            LightRig::Paper => (0.0, of_paper(center, radius)),
            LightRig::Colored => (0.15, colored()),
        };
        let mut all = [Lamp::NONE; Self::MAX_LAMPS];
        all[..lamps.len()].copy_from_slice(&lamps);
        Some(Self {
            ambient: if rig == LightRig::None { 1.0 } else { AMBIENT },
            head,
            specular,
            lamps: all,
            // From within a cloud, its visible parts are about as far away as it is large.
            usual_distance: (-center.z).max(0.5 * radius).max(packet.view.near),
        })
    }
}

/// As photographers place them: a warm key, a cool fill from the other side, and a rim light from behind.
fn three_point() -> Vec<Lamp> {
    vec![
        Lamp::far(-0.5, 0.6, 0.65, 0.75 * Vec3::new(1.0, 0.9, 0.75)),
        Lamp::far(0.8, 0.1, 0.6, 0.3 * Vec3::new(0.7, 0.85, 1.0)),
        Lamp::far(0.3, 0.6, -0.75, Vec3::splat(0.6)),
    ]
}

/// Two at places, as in the tests of Sainz and Pajarola 2004 §5, which says no more of them: to the left and to the
/// right above the cloud, before it.
fn of_paper(center: Vec3, radius: f32) -> Vec<Lamp> {
    [(-1.5, 0.65), (1.5, 0.35)]
        .map(|(right, white)| Lamp {
            place: (center + radius * Vec3::new(right, 1.5, 2.0)).extend(1.0),
            color: Vec3::splat(white),
        })
        .to_vec()
}

/// Four colours that make white together, from four sides.
fn colored() -> Vec<Lamp> {
    vec![
        Lamp::far(-0.8, 0.3, 0.5, Vec3::new(0.9, 0.05, 0.05)),
        Lamp::far(0.8, 0.3, 0.5, Vec3::new(0.05, 0.8, 0.05)),
        Lamp::far(0.0, -0.8, 0.5, Vec3::new(0.05, 0.05, 0.9)),
        Lamp::far(0.0, 0.9, 0.4, Vec3::new(0.5, 0.4, 0.1)),
    ]
}
