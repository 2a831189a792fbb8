//! Light that falls on surfaces, and light from depths.

use super::Choice;
use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Unit, Values, group};
use crate::scene::environment::Environment;

choices! {
    /// Lighting mode: the place where the headlight is evaluated (the 4D media paper §V-B), or the deferred shading of
    /// the finished surface (Hofer et al. 2018 §3.6). Colours of cameras have their light in them, and are not lit
    /// again.
    Lighting, "lighting", auto PerFragment = "Automatic",
        "Smooth; none where cameras took the colours, which have light in them"
    {
        Unlit = "none", "None", "Plain colours",
            also ["unlit", "flat", "off"];
        PerSurfel = "surfel", "Per surfel or face", "Once for each surfel or voxel face";
        PerVertex = "vertex", "Per vertex", "At each corner, interpolated between";
        PerFragment = "fragment", "Smooth", "At each pixel (per fragment)",
            also ["phong", "gouraud"];
        Lambert = "lambert", "Matt", "At each pixel of the blended surface, without highlights",
            also ["diffuse", "matte"];
        BlinnPhong = "blinn-phong", "Shiny", "At each pixel of the blended surface, with highlights",
            also ["specular", "glossy", "highlights"];
        /// Metallic–roughness, with an environment; see [`PhysicalLight`](crate::scene::PhysicalLight).
        Physical = "physical", "Physical", "At each pixel of the blended surface: metal or not, smooth or rough",
            also ["pbr"];
    }
}

impl Lighting {
    /// Returns the light that this is, at each pixel: the headlight is one light, wherever it is evaluated.
    #[must_use]
    pub fn at_each_pixel(self) -> Self {
        match self {
            Self::PerSurfel | Self::PerVertex => Self::PerFragment,
            other => other,
        }
    }

    /// Returns true if shading is deferred: the blended surface is lit, not the splats.
    pub fn is_deferred(self) -> bool {
        matches!(self, Self::Lambert | Self::BlinnPhong | Self::Physical)
    }
}

choices! {
    /// Light rig of deferred shading; see [`Lights`](crate::scene::Lights).
    LightRig, "rig of lights", auto Head = "Automatic",
        "The headlight, or the environment alone where there is one"
    {
        Head = "head", "Headlight", "One from the eye";
        ThreePoint = "three-point", "Three-point", "A warm key light, a cool one that fills, and one from behind";
        /// Sainz and Pajarola 2004 §5.
        Paper = "paper", "Two lamps", "Two lamps near the cloud, left and right above it";
        Colored = "colored", "Four colours", "Red, green, blue and yellow from four sides";
        None = "none", "None", "No lamp: the environment alone, or white from all sides";
    }
}

impl LightRig {
    /// Returns true if the rig's first lamp is far away, so that its shadow can be determined.
    pub fn has_far_key(self) -> bool {
        matches!(self, Self::ThreePoint | Self::Colored)
    }
}

choices! {
    /// Eye-dome lighting (EDL): shading of the image by its depths.
    EyeDome, "choice of eye-dome lighting", auto Off = "Automatic", "Where points have no other light" {
        On = "on", "On", "Whatever is drawn";
        Off = "off", "Off", "Never";
    }
}

choices! {
    /// On/off switch.
    OnOff, "choice of on and off" {
        Off = "off", "Off", "Without it";
        On = "on", "On", "With it";
    }
}

group! {
    /// Light that falls on surfaces, and light from depths.
    LightSettings decided LightStyle {
        /// Lighting mode of surfaces.
        lighting: Choice<Lighting> = Choice::Auto, "lighting" LIGHTING {
            flag: "lighting",
            other_flags: &["shading"],
            value_name: "MODEL",
            help: "Lighting model",
            everyday: true,
            title: "Lighting",
            hint: "Evaluation of the headlight, or lighting of the blended surface",
            section: Section::Shading,
            when: |drawn| drawn.is_lit(),
            label: Label::Unusual(Place::What, "{} light"),
            also: &["shading", "illumination", "relight"],
            values: Values::Words(Choice::<Lighting>::WORDS),
        }
        /// Light rig of deferred shading.
        rig: Choice<LightRig> = Choice::Auto, "lights" RIG {
            flag: "lights",
            value_name: "RIG",
            help: "Lights for the deferred models (lambert, blinn-phong, physical)",
            title: "Lights",
            hint: "Which lights fall on the blended surface; they move with the camera",
            section: Section::Shading,
            when: |drawn| drawn.is_lit_deferred(),
            label: Label::Unusual(Place::What, "{} lights"),
            also: &["light rig", "lamps", "light source"],
            values: Values::Words(Choice::<LightRig>::WORDS),
        }
        /// Metalness of a surface.
        metallic: f32 = 0.0, "metallic" METALLIC {
            flag: "metallic",
            value_name: "0..1",
            help: "Metalness of surfaces in physical lighting",
            title: "Metallic",
            hint: "Metalness: metals reflect in their colour, other materials scatter it",
            section: Section::Shading,
            when: |drawn| drawn.is_lit_physically(),
            label: Label::If(|drawn| drawn.is_lit_physically(), Place::What, "metallic {}"),
            also: &["metalness", "pbr", "material"],
            values: Values::Number(Numbers {
                typed: Typed::Retained("a number from 0 to 1"),
                ..Numbers::USUAL
            }),
        }
        /// Roughness of a surface; the roughness of microfacets is its square.
        roughness: f32 = 0.5, "roughness" ROUGHNESS {
            flag: "roughness",
            value_name: "0..1",
            help: "Roughness of surfaces in physical lighting",
            title: "Roughness",
            hint: "Roughness: reflections are sharp at 0 and blurred at 1",
            section: Section::Shading,
            when: |drawn| drawn.is_lit_physically(),
            label: Label::If(|drawn| drawn.is_lit_physically(), Place::What, "roughness {}"),
            also: &["glossiness", "pbr", "material"],
            values: Values::Number(Numbers {
                typed: Typed::Retained("a number from 0 to 1"),
                ..Numbers::USUAL
            }),
        }
        /// Environment around the scene.
        environment: Environment = Environment::Studio, "environment" ENVIRONMENT {
            flag: "environment",
            value_name: "NAME|FILE",
            help: "Environment map for physical lighting: a name, or the path of an image",
            title: "Environment",
            hint: "Surroundings that light the scene from all sides; they rotate with the scene",
            section: Section::Shading,
            when: |drawn| drawn.is_lit_physically(),
            label: Label::If(|drawn| drawn.is_lit_physically(), Place::What, "in {}"),
            also: &["environment map", "hdri", "image-based lighting", "skybox"],
            values: Values::Environment,
        }
        /// Shadow casting by the first lamp.
        shadows: OnOff = OnOff::Off, "shadows" SHADOWS {
            flag: "shadows",
            value_name: "WHETHER",
            help: "Cast shadows from the key light of three-point and colored",
            everyday: true,
            title: "Shadows",
            hint: "Whether the first of several lights that are far away casts shadows",
            section: Section::Shading,
            when: |drawn| drawn.has_key_light(),
            label: Label::If(|drawn| drawn.has_shadows(), Place::What, "with shadows"),
            also: &["cast shadows"],
            values: Values::Words(OnOff::WORDS),
        }
        /// Ambient occlusion: light blocked by surfaces near a point.
        ao: OnOff = OnOff::Off, "ao" AO {
            flag: "ao",
            value_name: "WHETHER",
            help: "Darken creases of the surface (ambient occlusion)",
            everyday: true,
            title: "Ambient occlusion",
            hint: "Darkens creases and hollows of the blended surface: what is near a place keeps light from it",
            section: Section::Shading,
            when: |drawn| drawn.is_shaded_with_depths(),
            label: Label::If(|drawn| drawn.is_occluded(), Place::What, "with ambient occlusion"),
            also: &["ssao", "ao", "pcv", "sky visibility", "contact shadows"],
            values: Values::Words(OnOff::WORDS),
        }
        /// Ambient occlusion strength: the fraction of that light that is lost; 1 is as much as is blocked.
        ao_strength: f32 = 1.0, "ao_strength" AO_STRENGTH {
            flag: "ao-strength",
            value_name: "FACTOR",
            help: "Strength of --ao",
            title: "Occlusion strength",
            hint: "How much ambient occlusion darkens; 1 is as much as light is kept away",
            section: Section::Shading,
            when: |drawn| drawn.is_occluded(),
            also: &["ao strength", "ssao strength"],
            values: Values::Number(Numbers {
                retained: [0.0, 4.0],
                offered: [0.0, 2.0],
                typed: Typed::NotNegative,
                unit: Unit::Is(" ×"),
                ..Numbers::USUAL
            }),
        }
        /// Ambient occlusion radius: the maximum distance of occluders; 1 is a fifth of the cloud's radius.
        ao_radius: f32 = 1.0, "ao_radius" AO_RADIUS {
            flag: "ao-radius",
            value_name: "FACTOR",
            help: "Radius of --ao; 1 is a fifth of the radius of the cloud",
            title: "Occlusion radius",
            hint: "How far away what keeps light from a place may be; 1 is a fifth of the cloud's radius",
            section: Section::Shading,
            when: |drawn| drawn.is_occluded(),
            also: &["ao radius", "ssao radius"],
            values: Values::Number(Numbers {
                retained: [0.05, 4.0],
                offered: [0.1, 4.0],
                unit: Unit::Is(" ×"),
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
        /// Eye-dome lighting (EDL): additional shading of the image by its depths.
        eye_dome: Choice<EyeDome> = Choice::Auto, "eye_dome" EYE_DOME {
            flag: "edl",
            other_flags: &["eye-dome"],
            value_name: "WHETHER",
            help: "Shade by depth (eye-dome lighting; auto: for points without other light)",
            everyday: true,
            title: "Eye-dome lighting",
            hint: "Darkens points behind their neighbours: depth alone shows shapes, without normals",
            section: Section::Shading,
            when: |drawn| drawn.leaves_depths(),
            full_name: "Eye-dome lighting (EDL)",
            also: &["edl", "depth shading", "outline"],
            values: Values::Words(Choice::<EyeDome>::WORDS),
        }
        /// Eye-dome lighting strength; 1 is the default.
        eye_dome_strength: f32 = 1.0, "eye_dome_strength" EYE_DOME_STRENGTH {
            flag: "edl-strength",
            other_flags: &["eye-dome-strength"],
            value_name: "FACTOR",
            help: "Strength of --edl",
            title: "Strength",
            hint: "Strength of eye-dome lighting; 1 is the default",
            section: Section::Shading,
            when: |drawn| drawn.has_eye_dome(),
            full_name: "Eye-dome strength",
            also: &["edl strength"],
            values: Values::Number(Numbers {
                retained: [0.0, 4.0],
                offered: [0.0, 4.0],
                typed: Typed::NotNegative,
                unit: Unit::Is(" ×"),
                ..Numbers::USUAL
            }),
        }
        /// Gamma: brightness of the finished image between black and white, which stay; 1 leaves it unchanged.
        gamma: f32 = 1.0, "gamma" GAMMA {
            flag: "gamma",
            value_name: "GAMMA",
            help: "Brighten the image (above 1) or darken it (below 1); black and white are unchanged",
            title: "Gamma",
            hint: "Brightens the finished image above 1 and darkens it below; black and white stay",
            section: Section::Shading,
            also: &["brightness", "exposure", "contrast", "tone"],
            values: Values::Number(Numbers {
                retained: [0.1, 10.0],
                offered: [0.25, 4.0],
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
    }
}

impl LightStyle {
    /// The power that channels of the image from 0 to 1 are raised to; `None` if they are unchanged.
    pub fn tone_exponent(&self) -> Option<f32> {
        let changes = self.gamma > 0.0 && self.gamma.is_finite() && (self.gamma - 1.0).abs() > f32::EPSILON;
        changes.then(|| 1.0 / self.gamma)
    }
}

impl LightSettings {
    /// These settings with a rig: where none is chosen, an environment lights alone.
    pub(super) fn with_rig(mut self) -> Self {
        let has_environment = self.lighting == Lighting::Physical && self.environment != Environment::None;
        if has_environment {
            self.rig = self.rig.or(LightRig::None).into();
        }
        self
    }
}
