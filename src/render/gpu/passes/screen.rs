//! Passes over the whole target.

use super::state::{COMPLETED, ColorUse, DepthUse, MULTIPLIED, OVER, ScreenPass};
use crate::render::gpu::targets::{Source, Target};

/// The WGSL of a pass that lets light fall, with these files of `shaders/common/`: what light is, and what it falls on.
macro_rules! shade {
    ($($file:literal),+) => {
        concat!(
            include_str!("../../../../shaders/common/linear.wgsl"),
            include_str!("../../../../shaders/common/ambient_occlusion.wgsl"),
            include_str!("../../../../shaders/common/shadow.wgsl"),
            $(include_str!(concat!("../../../../shaders/common/", $file)),)+
            include_str!("../../../../shaders/common/blended_surface.wgsl"),
            include_str!("../../../../shaders/passes/shade.wgsl")
        )
    };
}

/// All of them.
pub const SCREEN_PASSES: [&ScreenPass; 18] = [
    &BACKGROUND,
    &SHADE,
    &SHADE_PHYSICAL,
    &SHADE_PHOTOGRAPHS,
    &SHADE_PHOTOGRAPHS_PHYSICAL,
    &PHOTO_ANSWERS,
    &PULL,
    &PUSH,
    &SHADE_PHOTO_ANSWERS,
    &SHADE_PHOTO_ANSWERS_PHYSICAL,
    &RESOLVE,
    &RESOLVE_PHOTOGRAPHS,
    &DEPTH_VIEW,
    &EYE_DOME,
    &EYE_DOME_OF_SUMS,
    &GRID,
    &FXAA,
    &SUPERSAMPLE,
];

/// The gradient behind the cloud.
pub(in crate::render::gpu) const BACKGROUND: ScreenPass = ScreenPass {
    name: "background",
    wgsl: include_str!("../../../../shaders/passes/background.wgsl"),
    source: None,
    color: ColorUse {
        target: Target::Picture,
        blend: None,
    },
    depth: None,
};

/// Light falls on the blended surface; what is left are sums, as the attribute pass leaves them without it (paper 003
/// §3.6).
pub(in crate::render::gpu) const SHADE: ScreenPass = ScreenPass {
    name: "shade",
    wgsl: shade!("blinn_phong.wgsl", "own_colors.wgsl"),
    source: Some(Source::Surfaces),
    color: ColorUse {
        target: Target::Sums,
        blend: None,
    },
    depth: None,
};

/// The same on surfaces with a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade physically",
    wgsl: shade!("physical.wgsl", "own_colors.wgsl"),
    ..SHADE
};

/// The same on surfaces that have their colours from photographs (paper 004 §3).
pub(in crate::render::gpu) const SHADE_PHOTOGRAPHS: ScreenPass = ScreenPass {
    name: "shade photographs",
    wgsl: shade!(
        "blinn_phong.wgsl",
        "photo_table.wgsl",
        "photographs.wgsl",
        "photographed.wgsl"
    ),
    source: Some(Source::Photographed),
    ..SHADE
};

/// The same with a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHOTOGRAPHS_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade photographs physically",
    wgsl: shade!(
        "physical.wgsl",
        "photo_table.wgsl",
        "photographs.wgsl",
        "photographed.wgsl"
    ),
    ..SHADE_PHOTOGRAPHS
};

/// What photographs say of each pixel, where what they do not show is filled from around.
pub(in crate::render::gpu) const PHOTO_ANSWERS: ScreenPass = ScreenPass {
    name: "photo answers",
    wgsl: concat!(
        include_str!("../../../../shaders/common/photo_table.wgsl"),
        include_str!("../../../../shaders/common/photographs.wgsl"),
        include_str!("../../../../shaders/common/blended_surface.wgsl"),
        include_str!("../../../../shaders/passes/photo_answers.wgsl")
    ),
    source: Some(Source::Photographed),
    color: ColorUse {
        target: Target::PhotoAnswers,
        blend: None,
    },
    depth: None,
};

/// A coarser level of these.
pub(in crate::render::gpu) const PULL: ScreenPass = ScreenPass {
    name: "pull",
    wgsl: include_str!("../../../../shaders/passes/pull.wgsl"),
    source: Some(Source::FinerLevel),
    color: ColorUse {
        target: Target::PhotoLevel,
        blend: None,
    },
    depth: None,
};

/// What a level lacks is taken from the next coarser one.
pub(in crate::render::gpu) const PUSH: ScreenPass = ScreenPass {
    name: "push",
    wgsl: include_str!("../../../../shaders/passes/push.wgsl"),
    source: Some(Source::CoarserLevel),
    color: ColorUse {
        target: Target::PhotoLevel,
        blend: Some(COMPLETED),
    },
    depth: None,
};

/// Light falls on what photographs said.
pub(in crate::render::gpu) const SHADE_PHOTO_ANSWERS: ScreenPass = ScreenPass {
    name: "shade photo answers",
    wgsl: shade!(
        "blinn_phong.wgsl",
        "photo_table.wgsl",
        "photo_answers.wgsl",
        "photographed.wgsl"
    ),
    source: Some(Source::PhotoAnswers),
    ..SHADE
};

/// The same with a material, in an environment.
pub(in crate::render::gpu) const SHADE_PHOTO_ANSWERS_PHYSICAL: ScreenPass = ScreenPass {
    name: "shade photo answers physically",
    wgsl: shade!(
        "physical.wgsl",
        "photo_table.wgsl",
        "photo_answers.wgsl",
        "photographed.wgsl"
    ),
    ..SHADE_PHOTO_ANSWERS
};

/// Normalises what the attribute pass summed up, and lays it over the background.
pub(in crate::render::gpu) const RESOLVE: ScreenPass = ScreenPass {
    name: "resolve",
    wgsl: concat!(
        include_str!("../../../../shaders/common/rims.wgsl"),
        include_str!("../../../../shaders/passes/resolve.wgsl")
    ),
    source: Some(Source::Sums),
    color: ColorUse {
        target: Target::Picture,
        blend: Some(OVER),
    },
    depth: None,
};

/// The same of surfaces that have their colours from photographs, whose gaps are closed.
pub(in crate::render::gpu) const RESOLVE_PHOTOGRAPHS: ScreenPass = ScreenPass {
    name: "resolve photographs",
    wgsl: concat!(
        include_str!("../../../../shaders/common/photo_table.wgsl"),
        include_str!("../../../../shaders/common/photographs.wgsl"),
        include_str!("../../../../shaders/common/blended_surface.wgsl"),
        include_str!("../../../../shaders/common/rims.wgsl"),
        include_str!("../../../../shaders/passes/resolve_photographs.wgsl")
    ),
    source: Some(Source::PhotographedSums),
    ..RESOLVE
};

/// The visibility pass as grey (Fig. 3c).
pub(in crate::render::gpu) const DEPTH_VIEW: ScreenPass = ScreenPass {
    name: "depth view",
    wgsl: include_str!("../../../../shaders/passes/depth_view.wgsl"),
    source: Some(Source::Depths),
    ..RESOLVE
};

/// Eye-dome lighting: what is drawn so far is multiplied with the shade of each pixel (Boucheny 2009).
pub(in crate::render::gpu) const EYE_DOME: ScreenPass = ScreenPass {
    name: "eye-dome lighting",
    wgsl: include_str!("../../../../shaders/passes/eye_dome.wgsl"),
    source: Some(Source::Depths),
    color: ColorUse {
        target: Target::Picture,
        blend: Some(MULTIPLIED),
    },
    depth: None,
};

/// The same of what the attribute pass left, before it is resolved: so the background that shines through at the rims
/// of splats keeps its colour, as all of the background does.
pub(in crate::render::gpu) const EYE_DOME_OF_SUMS: ScreenPass = ScreenPass {
    name: "eye-dome lighting of sums",
    color: ColorUse {
        target: Target::Sums,
        blend: Some(MULTIPLIED),
    },
    ..EYE_DOME
};

/// Lines on the ground, laid over the picture where nothing is before them.
pub(in crate::render::gpu) const GRID: ScreenPass = ScreenPass {
    name: "grid",
    wgsl: include_str!("../../../../shaders/passes/grid.wgsl"),
    source: None,
    color: ColorUse {
        target: Target::Picture,
        blend: Some(OVER),
    },
    depth: Some(DepthUse::TestOnly),
};

/// The picture that is shown, with smooth edges (Lottes 2009).
pub(in crate::render::gpu) const FXAA: ScreenPass = ScreenPass {
    name: "FXAA",
    wgsl: include_str!("../../../../shaders/passes/fxaa.wgsl"),
    source: Some(Source::Picture),
    color: ColorUse {
        target: Target::Shown,
        blend: None,
    },
    depth: None,
};

/// The picture that is shown, of several pixels for each.
pub(in crate::render::gpu) const SUPERSAMPLE: ScreenPass = ScreenPass {
    name: "supersample",
    wgsl: include_str!("../../../../shaders/passes/supersample.wgsl"),
    ..FXAA
};
