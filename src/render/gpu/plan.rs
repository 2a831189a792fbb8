//! The order of passes of one image: the background, those of the primitive (`primitives/mod.rs`), and the steps over
//! the whole image at the end.
//!
//! The shadow map comes first, if there is one. Where shading is deferred, the output of the primitive is lit, giving
//! sums that are resolved like others. Effects (`render/effects`) run at their stages: on the drawn surface, on sums
//! before they are resolved; on the image; and from it to the one shown.

use super::gpu_data::ViewUniform;
use super::passes::screen::{PHOTO_ANSWERS, PULL, PUSH, RESOLVE_PHOTOS};
use super::passes::shade::{
    SHADE, SHADE_PHOTO_ANSWERS, SHADE_PHOTO_ANSWERS_PHYSICAL, SHADE_PHOTOS, SHADE_PHOTOS_PHYSICAL, SHADE_PHYSICAL,
};
use super::passes::{GeometryKey, ScreenPass};
use super::primitives::{self, Drawable};
use super::residency::{RecordSource, StreamKey};
use super::targets::{Precision, Source, Target};
use crate::render::effects::{self, Stage};
use crate::scene::{PhotoViews, PhysicalLight, ScenePacket, Shadow, Strategy};

/// Render plan of a packet, as it is drawn ([`ScenePacket::as_drawn`]).
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub(super) drawable: Drawable<'a>,
    /// Background passes, which precede the passes over records: the gradient, if there is one.
    pub(super) behind: Vec<&'static ScreenPass>,
    /// Screen-space passes that follow the passes over records.
    pub(super) finish: Vec<&'static ScreenPass>,
    /// Shadow of the key light, if it has one.
    pub(super) shadow: Option<Shadow>,
    /// Lighting of surfaces with a material.
    pub(super) physical: Option<PhysicalLight>,
    /// Views for view-dependent texturing of surfaces.
    pub(super) posed_images: Option<PhotoViews>,
    strategy: Strategy,
    /// Floating-point precision of the sums.
    pub(super) precision: Precision,
}

/// Views that an image can need: one for each pass over records, and the key light's.
pub(super) const VIEWS: usize = 3;

/// The place of the view of the key light among them.
pub(super) const LAMP_VIEW: u32 = 2;

impl<'a> Plan<'a> {
    /// `blends_single_floats`: see [`Context`](super::context::Context).
    pub(super) fn new(packet: &'a ScenePacket, blends_single_floats: bool) -> Self {
        let drawable = primitives::drawable(packet);
        let physical = PhysicalLight::of(packet);
        let posed_images = PhotoViews::of(packet);
        let fills_holes = posed_images.as_ref().map(PhotoViews::fills_holes);
        let shade = match (fills_holes, &physical) {
            (None, None) => &SHADE,
            (None, Some(_)) => &SHADE_PHYSICAL,
            (Some(false), None) => &SHADE_PHOTOS,
            (Some(false), Some(_)) => &SHADE_PHOTOS_PHYSICAL,
            (Some(true), None) => &SHADE_PHOTO_ANSWERS,
            (Some(true), Some(_)) => &SHADE_PHOTO_ANSWERS_PHYSICAL,
        };
        let shade = drawable.draws_into(Target::Surfaces).then_some(shade);
        let draws_sums = shade.is_some() || drawable.draws_into(Target::Sums);
        let closes_gaps = shade.is_some() && posed_images.as_ref().is_some_and(|views| views.gap_px > 0);
        let resolve = drawable
            .resolve
            .map(|resolve| if closes_gaps { &RESOLVE_PHOTOS } else { resolve });
        // Effects on sums before these are resolved.
        let [of_sums, of_picture] = [(Target::Sums, true), (Target::Picture, false)].map(|(target, of_sums)| {
            let passes = effects::passes(packet, Stage::Drawn, target);
            passes.filter(move |_| draws_sums == of_sums)
        });
        let finish = shade
            .into_iter()
            .chain(of_sums)
            .chain(resolve)
            .chain(of_picture)
            .chain(effects::passes(packet, Stage::Picture, Target::Picture))
            .chain(effects::passes(packet, Stage::Shown, Target::Shown))
            .collect();
        Self {
            drawable,
            behind: effects::passes(packet, Stage::Behind, Target::Picture).collect(),
            finish,
            shadow: Shadow::of(packet),
            physical,
            posed_images,
            strategy: packet.style.drawing.strategy,
            // Half floats stop accumulating hundreds of small weights: outlines of filtered splats moved by 0.7 pixels.
            precision: if packet.style.filters_splats() && blends_single_floats {
                Precision::Single
            } else {
                Precision::Half
            },
        }
    }

    /// The uniforms of each pass over records, the first of which also serve passes over the screen, and of the key
    /// light.
    pub(super) fn views(&self, packet: &ScenePacket) -> Vec<ViewUniform> {
        let surfels = &packet.style.surfels;
        let [visibility, attribute] = surfels.splatting.scales(surfels.enlargement);
        // Only the attribute pass filters: filtered splats that are seen almost edge-on extend far beyond the surface,
        // towards the eye as well, and in the visibility pass occluded splats they should blend with.
        let first = ViewUniform::new(packet, visibility);
        let second = ViewUniform::new(packet, attribute).of_attributes(packet.style.splat_filter());
        match &self.shadow {
            Some(shadow) => vec![first, second, ViewUniform::of_lamp(shadow)],
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
            // Cells only have faces towards the lamp; surfels cast shadows to both sides.
            cull_back_faces: false,
            precision: self.precision,
        })
    }

    pub(super) fn screen_passes(&self) -> impl Iterator<Item = &'static ScreenPass> + '_ {
        let of_answers: &[&'static ScreenPass] = if self.fills_photo_holes() {
            &[&PHOTO_ANSWERS, &PULL, &PUSH]
        } else {
            &[]
        };
        self.behind.iter().chain(of_answers).chain(&self.finish).copied()
    }

    /// Returns true if the displayed image is a different texture from the one that is drawn.
    pub(super) fn makes_another(&self) -> bool {
        self.finish.iter().any(|pass| pass.color.target == Target::Shown)
    }

    /// Returns true if a pass that draws into the image also reads it.
    pub(super) fn reads_picture(&self) -> bool {
        let mut passes = self.finish.iter();
        passes.any(|pass| pass.source == Some(Source::PictureCopy))
    }

    /// Returns true if holes that the input images do not show are filled from around.
    pub(super) fn fills_photo_holes(&self) -> bool {
        self.defers_shading() && self.posed_images.as_ref().is_some_and(PhotoViews::fills_holes)
    }

    /// Returns true if shading is deferred, so that the blended surface is lit.
    pub(super) fn defers_shading(&self) -> bool {
        self.drawable.draws_into(Target::Surfaces)
    }

    /// Returns true if the depth buffer contains the drawn surface when the passes over records are done.
    pub(super) fn leaves_depths(&self) -> bool {
        self.drawable.passes.iter().any(|pass| pass.depth.is_some())
    }
}
