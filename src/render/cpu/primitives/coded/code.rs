//! The byte code of a packet, and how it is drawn.

use crate::levels::octree::CodedCloud;
use crate::render::constants::depth_slack_radii;
use crate::scene::{CodedCells, DrawSettings, Footprint};

/// Factor by which masks may be larger than the splats they stand for: sizes are rounded, and so is the position where
/// they are seen.
pub(super) const MASK_SLACK: f32 = 1.2;

/// A byte code, and how it is drawn.
#[derive(Debug, Clone, Copy)]
pub(in crate::render::cpu) struct Coded<'a> {
    pub(super) cloud: &'a CodedCloud,
    pub(super) lod_px: f32,
    pub(super) deepest_level: u32,
    pub(super) cull_back_faces: bool,
    pub(super) darkens_back_faces: bool,
    /// True if each node is drawn as a pixel instead of a mask.
    pub(super) are_pixels: bool,
    pub(super) normal_bits: u32,
    pub(super) offset_bits: u32,
    /// Nodes that a block stands for, on average.
    pub(super) block_nodes: usize,
    /// Factors on radii in the visibility and in the attribute pass.
    pub(super) scales: [f32; 2],
    /// Depth bias of the visibility pass, in radii.
    pub(super) slack_radii: f32,
}

impl<'a> Coded<'a> {
    pub(in crate::render::cpu) fn new(cells: &'a CodedCells, style: &DrawSettings) -> Self {
        let surfels = &style.surfels;
        let scales = surfels.splatting.scales(surfels.enlargement);
        Self {
            cloud: &cells.cloud,
            lod_px: cells.lod_px,
            deepest_level: cells.deepest_level,
            cull_back_faces: style.culls_back_faces(),
            darkens_back_faces: style.darkens_back_faces(),
            are_pixels: style.codes.footprint == Footprint::Pixels,
            normal_bits: style.codes.normal_bits.bits(),
            offset_bits: style.codes.offset_bits.bits(),
            block_nodes: style.codes.block_nodes as usize,
            scales: scales.map(|scale| scale * surfels.splat_scale),
            slack_radii: depth_slack_radii(style),
        }
    }

    /// The code of a packet.
    #[cfg(test)]
    pub(super) fn of(packet: &'a crate::scene::ScenePacket) -> Option<Self> {
        let cells = packet.content.coded()?;
        Some(Self::new(cells, &packet.style))
    }

    /// Returns the reach of splats, in their radii.
    pub(super) fn largest_scale(&self) -> f32 {
        if self.are_pixels {
            return 0.0;
        }
        MASK_SLACK * self.scales[0].max(self.scales[1])
    }
}
