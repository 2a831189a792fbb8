//! What is drawn on the processor: one file or folder a primitive, with the names of `render/gpu/primitives`.

mod coded;
mod points;
mod surfels;
mod voxels;

use super::blocks::Blocks;
use super::records;
use super::rows::TileRow;
use crate::render::constants::DEPTH_SLACK_RADII;
use crate::scene::{Content, Primitive, ScenePacket, Splatting};
use coded::Coded;
use points::Points;
use surfels::Surfels;
use voxels::Cubes;

/// What a packet shows: the one place where its content is asked for, once a picture.
pub(super) enum Drawable<'a> {
    Points(Points<'a>),
    Surfels(Surfels<'a>),
    Cubes(Cubes<'a>),
    Coded(Coded<'a>),
    /// The frame lacks what the primitive needs.
    Nothing,
}

impl<'a> Drawable<'a> {
    pub(super) fn of(packet: &'a ScenePacket) -> Self {
        Self::with_slack(packet, DEPTH_SLACK_RADII)
    }

    /// What lies on the surface that [`of_surfaces`] shows.
    pub(super) fn of_surface(packet: &'a ScenePacket) -> Self {
        match Self::with_slack(packet, 0.0) {
            Self::Coded(_) => Self::Nothing,
            Self::Points(points) => Self::Points(points.of_surface()),
            drawable => drawable,
        }
    }

    fn with_slack(packet: &'a ScenePacket, slack_radii: f32) -> Self {
        let style = &packet.style;
        match &packet.content {
            Content::Nothing => Self::Nothing,
            Content::Points(records) => Self::Points(Points::new(packet, records, None)),
            Content::Surfels(surfels) if style.primitive == Primitive::Point => {
                Self::Points(Points::new(packet, &surfels.points, Some(&surfels.shapes)))
            }
            Content::Surfels(surfels) => Self::Surfels(Surfels {
                points: &surfels.points,
                shapes: &surfels.shapes,
                style,
                slack_radii,
            }),
            Content::Voxels(voxels) => Self::Cubes(Cubes::new(voxels, style.light.lighting)),
            Content::Coded(cells) => Self::Coded(Coded::new(cells, style)),
        }
    }

    /// Boxes around records. A byte code has its own.
    pub(super) fn blocks(&self) -> Blocks {
        match self {
            Self::Points(points) => Blocks::of(points),
            Self::Surfels(surfels) => Blocks::of(surfels),
            Self::Cubes(cubes) => Blocks::of(cubes),
            Self::Coded(_) | Self::Nothing => Blocks::of(&Points::NONE),
        }
    }

    /// Draws what [`Drawable::blocks`] are around; how many records were handed to tiles.
    pub(super) fn draw(&self, packet: &ScenePacket, blocks: &Blocks, bands: Vec<TileRow<'_>>) -> u64 {
        match self {
            Self::Points(points) => records::draw(points, blocks, packet, bands),
            Self::Surfels(surfels) => records::draw(surfels, blocks, packet, bands),
            Self::Cubes(cubes) => records::draw(cubes, blocks, packet, bands),
            Self::Coded(coded) => coded::draw(coded, packet, bands),
            Self::Nothing => records::draw(&Points::NONE, blocks, packet, bands),
        }
    }
}

/// `packet` as it is drawn for depths alone: what is blended in two passes lies on the disks of its first.
pub(super) fn of_surfaces(packet: &ScenePacket) -> ScenePacket {
    let mut packet = packet.clone();
    let surfels = &mut packet.style.surfels;
    match surfels.splatting {
        Splatting::Regular | Splatting::NoDepth | Splatting::Visibility | Splatting::Opaque => {}
        Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => {
            surfels.splat_scale *= surfels.splatting.scales(surfels.enlargement)[0];
            surfels.splatting = Splatting::Visibility;
        }
    }
    packet
}
