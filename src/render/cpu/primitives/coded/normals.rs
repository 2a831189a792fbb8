//! Per-frame precomputation for each quantised normal instead of each point (Botsch et al. 2002 §4.1, §5.1).
//!
//! How it works: a table by the index of the normal, with its bits masked to the precision that is drawn. An entry has
//! the normal as a function of pixels (the back-face test of a point is a dot product of three with its projection),
//! the projection of the normal (for offsets), the class that the footprint is chosen by, and the light of a lamp at
//! infinity, as that depends on the normal alone: for the headlight, in the direction from the eye to the centre of the
//! cloud. Close up the result differs from a lamp at the eye: this is lighting *once per surfel* here; finer lighting
//! uses the product above, which is the cosine except for the length of the ray.

use super::footprints;
use super::transform::homogeneous;
use crate::cloud::{coarser_normal, quantised_normals};
use crate::render::cpu::shading::headlight;
use crate::render::cpu::view::PixelView;
use crate::scene::{Lighting, ScenePacket};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// A quantised normal as it is seen.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(super) struct SeenNormal {
    /// `facing · (u, v, w)` is the product of the normal and the vector from the eye to the point at these pixels times
    /// distance. 0 for the fourth component.
    pub(super) facing: Vec4,
    /// The image of the unit vector, as pixels times distance, and 0.
    pub(super) image: Vec4,
    /// The factor on colours, and the white that is added.
    pub(super) light: [f32; 2],
    /// See [`footprints::class_of`].
    pub(super) class: u32,
}

/// Entries that are worth handing to another thread.
const NORMALS_PER_TASK: usize = 1 << 10;

/// Normals that footprints are chosen for: lower bits are masked out.
const FOOTPRINT_BITS: u32 = 13;

/// The table for normals of this number of bits.
pub(super) fn seen(packet: &ScenePacket, view: &PixelView, bits: u32) -> Vec<SeenNormal> {
    let to_center = packet.view.to_view(packet.bounds.center());
    let coarse = quantised_normals(FOOTPRINT_BITS);
    let classes: Vec<u32> = coarse
        .par_iter()
        .with_min_len(NORMALS_PER_TASK)
        .map(|&normal| footprints::class_of(view.rotate(normal)))
        .collect();
    quantised_normals(bits)
        .par_iter()
        .with_min_len(NORMALS_PER_TASK)
        .enumerate()
        .map(|(index, &normal)| {
            let normal = view.rotate(normal);
            let facing = view.along_rays(normal);
            let coarser = index >> bits.saturating_sub(FOOTPRINT_BITS);
            SeenNormal {
                facing: Vec4::new(facing.per_px[0], facing.per_px[1], facing.at_origin, 0.0),
                image: homogeneous(view, normal).extend(0.0),
                // A lamp at infinity, as in the paper: near the object, 15 dB compared with exact disks.
                light: light(packet.style.light.lighting, normal, to_center),
                class: classes[coarser],
            }
        })
        .collect()
}

fn light(lighting: Lighting, normal: Vec3, to_center: Vec3) -> [f32; 2] {
    match lighting {
        Lighting::Unlit => [1.0, 0.0],
        _ => headlight(normal, to_center),
    }
}

/// The entry of a finest index.
#[inline(always)]
pub(super) fn entry(table: &[SeenNormal], finest: u32, bits: u32) -> &SeenNormal {
    &table[coarser_normal(finest, bits) as usize]
}
