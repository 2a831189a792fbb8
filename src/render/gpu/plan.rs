//! The order of passes of one picture: the background, those of the primitive (`primitives/mod.rs`), and what is done
//! over the whole picture at the end.
//!
//! Before them comes the map of a shadow, where there is one. Where shading is deferred, light falls on what the
//! primitive left, and leaves sums that are resolved as others are. Where it is asked for, eye-dome lighting follows
//! what is drawn, of sums before they are resolved; and the grid at the end. Antialiasing makes the picture that is
//! shown of it.

use super::gpu_data::ViewUniform;
use super::passes::screen::{
    BACKGROUND, EYE_DOME, EYE_DOME_OF_SUMS, FXAA, GRID, PHOTO_ANSWERS, PULL, PUSH, RESOLVE_PHOTOGRAPHS, SHADE,
    SHADE_PHOTO_ANSWERS, SHADE_PHOTO_ANSWERS_PHYSICAL, SHADE_PHOTOGRAPHS, SHADE_PHOTOGRAPHS_PHYSICAL, SHADE_PHYSICAL,
    SUPERSAMPLE,
};
use super::passes::{GeometryKey, ScreenPass};
use super::primitives::{self, Drawable};
use super::residency::{RecordSource, StreamKey};
use super::targets::{Precision, Target};
use crate::scene::{Antialiasing, EyeDomeLight, PhotoViews, PhysicalLight, ScenePacket, Shadow, Strategy};

/// What a packet asks for, as it is drawn ([`ScenePacket::as_drawn`]).
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub(super) drawable: Drawable<'a>,
    /// The gradient, if there is one.
    pub(super) background: Option<&'static ScreenPass>,
    /// What follows the passes over records.
    pub(super) finish: Vec<&'static ScreenPass>,
    /// Of the key light, if it has one.
    pub(super) shadow: Option<Shadow>,
    /// Of surfaces with a material.
    pub(super) physical: Option<PhysicalLight>,
    /// Of surfaces that have their colours from photographs.
    pub(super) photographs: Option<PhotoViews>,
    strategy: Strategy,
    /// What sums are to be held in.
    pub(super) precision: Precision,
}

/// Views that a picture can need: one for each pass over records, and that of the key light.
pub(super) const VIEWS: usize = 3;

/// The place of the view of the key light among them.
pub(super) const LAMP_VIEW: u32 = 2;

impl<'a> Plan<'a> {
    /// `blends_single_floats`: see [`Context`](super::context::Context).
    pub(super) fn new(packet: &'a ScenePacket, blends_single_floats: bool) -> Self {
        let drawable = primitives::drawable(packet);
        let physical = PhysicalLight::of(packet);
        let photographs = PhotoViews::of(packet);
        let fills_holes = photographs.as_ref().map(PhotoViews::fills_holes);
        let shade = match (fills_holes, &physical) {
            (None, None) => &SHADE,
            (None, Some(_)) => &SHADE_PHYSICAL,
            (Some(false), None) => &SHADE_PHOTOGRAPHS,
            (Some(false), Some(_)) => &SHADE_PHOTOGRAPHS_PHYSICAL,
            (Some(true), None) => &SHADE_PHOTO_ANSWERS,
            (Some(true), Some(_)) => &SHADE_PHOTO_ANSWERS_PHYSICAL,
        };
        let shade = drawable.draws_into(Target::Surfaces).then_some(shade);
        let draws_sums = shade.is_some() || drawable.draws_into(Target::Sums);
        let eye_dome = EyeDomeLight::of(packet).map(|_| if draws_sums { &EYE_DOME_OF_SUMS } else { &EYE_DOME });
        let closes_gaps = shade.is_some() && photographs.as_ref().is_some_and(|views| views.gap_px > 0);
        let resolve = drawable
            .resolve
            .map(|resolve| if closes_gaps { &RESOLVE_PHOTOGRAPHS } else { resolve });
        let [first, second] = if draws_sums {
            [eye_dome, resolve]
        } else {
            [resolve, eye_dome]
        };
        let grid = packet.ground.map(|_| &GRID);
        let antialias = match packet.style.drawing.antialiasing {
            Antialiasing::None => None,
            Antialiasing::Fxaa => Some(&FXAA),
            Antialiasing::Supersample => Some(&SUPERSAMPLE),
        };
        let background = packet.style.backdrop.background;
        Self {
            drawable,
            background: (background.top != background.bottom).then_some(&BACKGROUND),
            finish: [shade, first, second, grid, antialias].into_iter().flatten().collect(),
            shadow: Shadow::of(packet),
            physical,
            photographs,
            strategy: packet.style.drawing.strategy,
            precision: if packet.style.filters_splats() && blends_single_floats {
                Precision::Single
            } else {
                Precision::Half
            },
        }
    }

    /// The uniforms of each pass over records, the first of which are those of passes over the screen, and of the key
    /// light.
    pub(super) fn views(&self, packet: &ScenePacket) -> Vec<ViewUniform> {
        let surfels = &packet.style.surfels;
        let [visibility, attribute] = surfels.splatting.scales(surfels.enlargement);
        let first = ViewUniform::new(packet, visibility);
        let second = ViewUniform::new(packet, attribute).of_attributes(packet.style.splat_filter());
        let first = match &self.physical {
            Some(physical) => first.with_physical(physical),
            None => first,
        };
        match &self.shadow {
            Some(shadow) => vec![first.with_shadow(shadow), second, ViewUniform::of_lamp(shadow)],
            None => vec![first, second],
        }
    }

    /// The streams that are drawn.
    pub(super) fn stream_keys(&self) -> Vec<StreamKey> {
        let streams = self.drawable.streams.iter();
        streams.map(RecordSource::key).collect()
    }

    pub(super) fn geometry_keys(&self) -> impl Iterator<Item = GeometryKey> {
        let drawable = &self.drawable;
        drawable.passes.iter().map(|&pass| GeometryKey {
            strategy: drawable.amplification.strategy(self.strategy),
            amplification: drawable.amplification,
            pass,
            cull_back_faces: drawable.cull_back_faces,
            precision: self.precision,
        })
    }

    /// The pass over records that draws the shadow map.
    pub(super) fn shadow_key(&self) -> Option<GeometryKey> {
        let (amplification, pass) = self.drawable.depth_pass.filter(|_| self.shadow.is_some())?;
        Some(GeometryKey {
            strategy: amplification.strategy(self.strategy),
            amplification,
            pass,
            // Cells have faces towards the lamp alone; surfels cast shadows to both sides.
            cull_back_faces: false,
            precision: self.precision,
        })
    }

    pub(super) fn screen_passes(&self) -> impl Iterator<Item = &'static ScreenPass> {
        let of_answers: &[_] = if self.fills_photo_holes() {
            &[&PHOTO_ANSWERS, &PULL, &PUSH]
        } else {
            &[]
        };
        let finish = of_answers.iter().chain(&self.finish);
        self.background.into_iter().chain(finish.copied())
    }

    /// Whether what photographs do not show is filled from around.
    pub(super) fn fills_photo_holes(&self) -> bool {
        self.defers_shading() && self.photographs.as_ref().is_some_and(PhotoViews::fills_holes)
    }

    /// Whether light falls on the blended surface.
    pub(super) fn defers_shading(&self) -> bool {
        self.drawable.draws_into(Target::Surfaces)
    }

    /// Whether the depth buffer has what is drawn when the passes over records are done.
    pub(super) fn leaves_depths(&self) -> bool {
        self.drawable.passes.iter().any(|pass| pass.depth.is_some())
    }
}
