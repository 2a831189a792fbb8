//! Everything that one image needs.

use super::content::{CodedCells, Content, Surfels};
use super::style::{Antialiasing, BackFaces, PointLight, PointShape, PointSizing, PointStyle, Splatting};
use super::{Clip, DrawSettings, GroundPlane, Lighting, PhotosInFrame, Primitive, ViewTransform};
use crate::levels::octree::coded::CodeView;
use crate::math::Aabb;
use glam::Vec4;
use std::sync::Arc;

/// Everything a renderer needs for one image. Equal packets make equal images.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenePacket {
    /// Width and height, at least 1.
    pub viewport_px: [u32; 2],
    /// The camera.
    pub view: ViewTransform,
    /// Drawing style.
    pub style: DrawSettings,
    /// Content to draw; renderers distinguish records by their allocation.
    pub content: Content,
    /// The box around the cloud, for the grey of [`super::Splatting::Visibility`].
    pub bounds: Aabb,
    /// The plane of [`super::Backdrop::grid`], if it is on.
    pub ground: Option<GroundPlane>,
    /// Posed images that surfaces take their colours from, if not from the points.
    pub posed_images: Option<PhotosInFrame>,
    /// Parameters derived from settings for this image.
    pub params: PacketParams,
}

/// Parameters derived from settings for one image: lengths and positions of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PacketParams {
    /// Typical spacing of neighbouring points of the frame, scene units; 0 if it has not been measured.
    pub point_spacing: f32,
    /// Clip region: the part of the cloud that is drawn, relative to the origin of the frame; all if `None`.
    pub clip: Option<Clip>,
}

impl ScenePacket {
    /// The view distances that [`super::Splatting::Visibility`] shows white and black: around the whole cloud.
    pub fn depth_range(&self) -> [f32; 2] {
        let center = -self.view.to_view(self.bounds.center()).z;
        let radius = self.bounds.radius().max(f32::MIN_POSITIVE);
        [center - radius, center + radius]
    }

    /// Returns the packet that renderers draw for this image before antialiasing: several samples per pixel, see
    /// [`Antialiasing::samples_per_edge`](super::Antialiasing::samples_per_edge). Lengths given in pixels are scaled by
    /// the same factor.
    #[must_use]
    pub fn as_drawn(&self) -> Self {
        let samples = self.style.drawing.antialiasing.samples_per_edge();
        let mut drawn = self.clone();
        drawn.viewport_px = self.viewport_px.map(|edge| edge * samples);
        drawn.view.pixels_per_unit_at_1 *= samples as f32;
        drawn.style.points.size_px *= samples as f32;
        // Other cuts of levels of detail are selected for the final image.
        if let Content::Coded(cells) = &mut drawn.content {
            cells.lod_px *= samples as f32;
        }
        drawn
    }

    /// Returns the view of a byte code, and how finely it is drawn.
    pub fn code_view(&self, cells: &CodedCells) -> CodeView {
        let (view, surfels, codes) = (&self.view, &self.style.surfels, &self.style.codes);
        let [visibility, attribute] = surfels.splatting.scales(surfels.enlargement);
        let culls_back_faces = surfels.back_faces == BackFaces::Culled;
        let to_corner = std::f32::consts::SQRT_2 * surfels.splat_scale * visibility.max(attribute);
        let [left, right, bottom, top, _] = view.frustum_in_frame().planes().map(Vec4::truncate);
        CodeView {
            eye_high: view.eye_high,
            eye_low: view.eye_low,
            forward: -view.view_from_frame_rotation.row(2),
            sides: [left, right, bottom, top],
            near: view.near,
            px_per_slope: 0.5 * view.focal[0] * self.viewport_px[0] as f32,
            lod_px: cells.lod_px,
            deepest_level: cells.deepest_level,
            // Coded pixels may be drawn as points, which have no back.
            culls_back_faces,
            culls_by_own_normals: culls_back_faces && self.style.has_coded_pixels(),
            reach_radii: to_corner,
            normal_bits: codes.normal_bits.bits(),
            offset_bits: codes.offset_bits.bits(),
        }
    }

    /// Returns the same packet with the nodes of a byte code as points of a pixel where these are its footprints, for
    /// renderers that draw the footprints of other primitives.
    #[must_use]
    pub fn with_coded_pixels_as_points(mut self) -> Self {
        if self.content.coded().is_some() && self.style.has_coded_pixels() {
            self.style.primitive = Primitive::Point;
            self.style.points = PointStyle {
                size_px: 1.0,
                sizing: PointSizing::Pixels,
                shape: PointShape::Square,
                light: PointLight::Normals,
                ..self.style.points
            };
        }
        self
    }

    /// Returns the same packet with the surfels that the view shows of a byte code, for renderers that cannot draw it.
    #[must_use]
    pub fn with_surfels_of(&self, cells: &CodedCells) -> Self {
        let (points, shapes) = cells.cloud.surfels(&self.code_view(cells));
        let surfels = Surfels {
            points: Arc::new(points),
            shapes: Arc::new(shapes),
        };
        Self {
            content: Content::Surfels(surfels),
            ..self.clone()
        }
    }

    /// Height of the whole image that this one is a part of, pixels.
    pub fn whole_height_px(&self) -> f32 {
        let [top, bottom] = self.view.rows_of_whole;
        self.viewport_px[1] as f32 / (bottom - top)
    }

    /// Returns the lighting of the content: points without normals are not lit.
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

    /// Returns the packet with the same records in another view, for the depths alone that the visibility pass writes:
    /// without light, and with back faces.
    #[must_use]
    pub(super) fn for_depths(&self, view: ViewTransform, viewport_px: [u32; 2]) -> Self {
        let mut packet = self.clone();
        packet.viewport_px = viewport_px;
        packet.view = view;
        packet.ground = None;
        packet.posed_images = None;
        packet.style.light.lighting = Lighting::Unlit;
        packet.style.drawing.antialiasing = Antialiasing::None;
        let surfels = &mut packet.style.surfels;
        surfels.splat_scale *= surfels.splatting.scales(surfels.enlargement)[0];
        surfels.splatting = Splatting::Visibility;
        surfels.back_faces = BackFaces::Drawn;
        packet
    }

    /// The part of `part_px` of this image whose upper left pixel is `start_px`, with the same records. Precondition:
    /// it lies within the image, which is not a part itself.
    #[must_use]
    pub fn part(&self, start_px: [u32; 2], part_px: [u32; 2]) -> Self {
        Self {
            viewport_px: part_px,
            view: self.view.of_part(self.viewport_px, start_px, part_px),
            ..self.clone()
        }
    }
}
