//! Everything that one picture needs.

use super::content::Content;
use super::{AmbientOcclusion, EyeDomeLight, GroundPlane, Style, ViewTransform};
use crate::math::Aabb;

/// Everything a renderer needs for one picture. Equal packets make equal pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenePacket {
    /// Width and height, at least 1.
    pub viewport_px: [u32; 2],
    /// The camera.
    pub view: ViewTransform,
    /// How to draw.
    pub style: Style,
    /// What to draw; renderers tell records apart by their allocation.
    pub content: Content,
    /// The box around the cloud, for the grey of [`super::Splatting::Visibility`].
    pub bounds: Aabb,
    /// The plane of [`super::Backdrop::grid`], if it is on.
    pub ground: Option<GroundPlane>,
}

impl ScenePacket {
    /// The view distances that [`super::Splatting::Visibility`] shows white and black: around the whole cloud.
    pub fn depth_range(&self) -> [f32; 2] {
        let middle = -self.view.to_view(self.bounds.center()).z;
        let radius = self.bounds.radius().max(f32::MIN_POSITIVE);
        [middle - radius, middle + radius]
    }

    /// How many pixels around a pixel its colour depends on at most.
    pub fn halo_px(&self) -> u32 {
        let eye_dome = EyeDomeLight::of(self).map_or(0, |light| light.halo_px());
        let occlusion = AmbientOcclusion::of(self).map_or(0, |occlusion| occlusion.halo_px());
        eye_dome.max(occlusion)
    }

    /// The part of `part_px` of this picture whose upper left pixel is `start_px`, with the same records. Precondition:
    /// it lies within the picture, which is no part itself.
    #[must_use]
    pub fn part(&self, start_px: [u32; 2], part_px: [u32; 2]) -> Self {
        Self {
            viewport_px: part_px,
            view: self.view.of_part(self.viewport_px, start_px, part_px),
            ..self.clone()
        }
    }
}
