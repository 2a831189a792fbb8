//! Everything that one picture needs.

use super::content::Content;
use super::style::{Antialiasing, BackFaces, Splatting};
use super::{Clip, DrawSettings, GroundPlane, Lighting, PhotographsInFrame, Primitive, ViewTransform};
use crate::math::Aabb;

/// Everything a renderer needs for one picture. Equal packets make equal pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenePacket {
    /// Width and height, at least 1.
    pub viewport_px: [u32; 2],
    /// The camera.
    pub view: ViewTransform,
    /// How to draw.
    pub style: DrawSettings,
    /// What to draw; renderers tell records apart by their allocation.
    pub content: Content,
    /// The box around the cloud, for the grey of [`super::Splatting::Visibility`].
    pub bounds: Aabb,
    /// The plane of [`super::Backdrop::grid`], if it is on.
    pub ground: Option<GroundPlane>,
    /// What surfaces have their colours from, if these are not those of points.
    pub photographs: Option<PhotographsInFrame>,
    /// What settings are in this picture.
    pub params: PacketParams,
}

/// What is derived from settings for one picture: lengths and places of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PacketParams {
    /// How far apart neighbouring points of the frame typically are, scene units; 0 where nobody has measured it.
    pub point_spacing: f32,
    /// What of the cloud is drawn, relative to the origin of the frame; all if `None`.
    pub clip: Option<Clip>,
}

impl ScenePacket {
    /// The view distances that [`super::Splatting::Visibility`] shows white and black: around the whole cloud.
    pub fn depth_range(&self) -> [f32; 2] {
        let middle = -self.view.to_view(self.bounds.center()).z;
        let radius = self.bounds.radius().max(f32::MIN_POSITIVE);
        [middle - radius, middle + radius]
    }

    /// What renderers draw for this picture before antialiasing: several pixels for each, see
    /// [`Antialiasing::samples_per_edge`](super::Antialiasing::samples_per_edge). What is told in pixels has as many
    /// more.
    #[must_use]
    pub fn as_drawn(&self) -> Self {
        let samples = self.style.drawing.antialiasing.samples_per_edge();
        let mut drawn = self.clone();
        drawn.viewport_px = self.viewport_px.map(|edge| edge * samples);
        drawn.view.pixels_per_unit_at_1 *= samples as f32;
        drawn.style.points.size_px *= samples as f32;
        if let Content::Coded(cells) = &mut drawn.content {
            cells.lod_px *= samples as f32;
        }
        drawn
    }

    /// Height of the whole picture that this one is a part of, pixels.
    pub fn whole_height_px(&self) -> f32 {
        let [top, bottom] = self.view.rows_of_whole;
        self.viewport_px[1] as f32 / (bottom - top)
    }

    /// How what is drawn is lit: points without normals are not.
    pub fn lighting(&self) -> Lighting {
        let is_lit = match &self.content {
            Content::Points(_) => false,
            _ => self.style.primitive != Primitive::Point || self.style.lights_points(),
        };
        if is_lit {
            self.style.light.lighting
        } else {
            Lighting::Unlit
        }
    }

    /// The same records in another view, for the depths alone that the visibility pass leaves: without light, and with
    /// what faces away.
    #[must_use]
    pub(super) fn for_depths(&self, view: ViewTransform, viewport_px: [u32; 2]) -> Self {
        let mut packet = self.clone();
        packet.viewport_px = viewport_px;
        packet.view = view;
        packet.ground = None;
        packet.photographs = None;
        packet.style.light.lighting = Lighting::Unlit;
        packet.style.drawing.antialiasing = Antialiasing::None;
        let surfels = &mut packet.style.surfels;
        surfels.splat_scale *= surfels.splatting.scales(surfels.enlargement)[0];
        surfels.splatting = Splatting::Visibility;
        surfels.back_faces = BackFaces::Drawn;
        packet
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
