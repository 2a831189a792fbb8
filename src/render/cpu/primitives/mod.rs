//! Primitives drawn on the CPU: one file or folder per primitive, with the names of `render/gpu/primitives`.

mod coded;
mod mesh;
mod points;
mod surfels;
mod voxels;

use super::blocks::Blocks;
use super::illumination::Illumination;
use super::records;
use super::rows::TileRow;
use crate::render::constants::depth_slack_radii;
use crate::scene::{Content, Lighting, Primitive, ScenePacket, Shadow, Splatting};
use coded::Coded;
use mesh::Mesh;
use points::Points;
use surfels::Surfels;
use voxels::Cubes;

/// Drawable content of a packet: the only place where its content is matched, once per rendered frame.
pub(super) enum Drawable<'a> {
    Points(Points<'a>),
    Surfels(Surfels<'a>),
    Cubes(Cubes<'a>),
    Mesh(Mesh<'a>),
    Coded(Coded<'a>),
    /// The frame lacks data that the primitive needs.
    Nothing,
}

impl<'a> Drawable<'a> {
    pub(super) fn of(packet: &'a ScenePacket) -> Self {
        Self::with_slack(packet, [depth_slack_radii(&packet.style), 0.0])
    }

    /// Returns the drawable that writes depths to a shadow map.
    pub(super) fn of_shadow(shadow: &'a Shadow) -> Self {
        Self::with_slack(&shadow.lamp_packet, [shadow.slack_radii; 2])
    }

    /// Returns the drawable that lies on the surface that [`of_surfaces`] shows.
    pub(super) fn of_surface(packet: &'a ScenePacket) -> Self {
        match Self::with_slack(packet, [0.0; 2]) {
            Self::Coded(_) => Self::Nothing,
            Self::Points(points) => Self::Points(points.of_surface()),
            drawable => drawable,
        }
    }

    /// With how far surfels and cells are pushed back.
    fn with_slack(packet: &'a ScenePacket, [slack_radii, slack_of_cells]: [f32; 2]) -> Self {
        let style = &packet.style;
        match &packet.content {
            // Selected records were gathered before.
            Content::Nothing | Content::Selected(_) | Content::Visible(_) => Self::Nothing,
            Content::Points(records) => Self::Points(Points::new(packet, records, None)),
            Content::Surfels(surfels) if style.primitive == Primitive::Point => {
                Self::Points(Points::new(packet, &surfels.points, Some(&surfels.shapes)))
            }
            Content::Surfels(surfels) => Self::Surfels(Surfels::new(style, surfels, slack_radii)),
            Content::Voxels(voxels) => Self::Cubes(Cubes::new(voxels, style.light.lighting, slack_of_cells)),
            Content::Mesh(records) => Self::Mesh(Mesh { records, style }),
            Content::Coded(cells) => Self::Coded(Coded::new(cells, style)),
        }
    }

    /// Boxes around records. A byte code has its own.
    pub(super) fn blocks(&self) -> Blocks {
        match self {
            Self::Points(points) => Blocks::of(points),
            Self::Surfels(surfels) => Blocks::of(surfels),
            Self::Cubes(cubes) => Blocks::of(cubes),
            Self::Mesh(mesh) => Blocks::of(mesh),
            Self::Coded(_) | Self::Nothing => Blocks::of(&Points::NONE),
        }
    }

    /// Draws the records within [`Drawable::blocks`], lit if shading is deferred; returns the number of records handed
    /// to tiles.
    pub(super) fn draw(
        &self,
        packet: &ScenePacket,
        blocks: &Blocks,
        illumination: Option<Illumination<'_>>,
        bands: Vec<TileRow<'_>>,
    ) -> u64 {
        match self {
            Self::Points(points) => records::draw(points, blocks, packet, illumination, bands),
            Self::Surfels(surfels) => records::draw(surfels, blocks, packet, illumination, bands),
            Self::Cubes(cubes) => records::draw(cubes, blocks, packet, illumination, bands),
            Self::Mesh(mesh) => records::draw(&mesh.seen(packet), blocks, packet, illumination, bands),
            Self::Coded(coded) => coded::draw(coded, packet, bands),
            Self::Nothing => records::draw(&Points::NONE, blocks, packet, illumination, bands),
        }
    }
}

/// `packet` as it is drawn for depths alone, without light: splats blended in two passes lie on the disks of the first.
pub(super) fn of_surfaces(packet: &ScenePacket) -> ScenePacket {
    let mut packet = packet.clone();
    packet.style.light.lighting = Lighting::Unlit;
    let surfels = &mut packet.style.surfels;
    match surfels.splatting {
        Splatting::Regular | Splatting::NoDepth | Splatting::Sorted | Splatting::Visibility | Splatting::Opaque => {}
        Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
            surfels.splat_scale *= surfels.splatting.scales(surfels.enlargement)[0];
            surfels.splatting = Splatting::Visibility;
        }
    }
    packet
}
