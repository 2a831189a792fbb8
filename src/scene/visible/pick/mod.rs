//! Picking of the point of the cloud under a pixel, exactly as it is drawn.
//!
//! **How it works.** The ray through the centre of the pixel is tested against the records of the packet that the image
//! was drawn from, in f64, by the rules of the renderers: a point where its square or disk covers the pixel, a surfel
//! where the ray hits its disk, a voxel where it hits its cube. Records are stored in Morton order, so the boxes around
//! 64 of them are small, and all but a few are skipped (`ray.rs`). Of blended surfels the one that adds most to the
//! pixel is picked. Where nothing covers the pixel, the nearest record within a radius is: thin things can be clicked
//! on.
//!
//! **Why on the CPU.** It costs one read of the positions (`benches/pick.rs`), does not depend on the renderer, and
//! answers immediately: an index buffer would be one more target for every pass, cannot hold blended records, and has
//! to be read back.

mod codes;
mod hidden;
mod ray;
mod records;

use crate::cloud::{PointRecord, oct_decode};
use crate::scene::clip::at;
use crate::scene::{Content, Primitive, ScenePacket};
use crate::sequence::PreparedFrame;
use codes::surfels_near;
use glam::{DVec3, Vec3};
pub use hidden::hidden;
use ray::Ray;
use rayon::prelude::*;
use records::{Cubes, Disks, Sprites, Triangles};
use std::cmp::Ordering;
use std::sync::Arc;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 14;

/// All known data of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    /// Index of its frame in the sequence.
    pub frame: usize,
    /// Its place in the order of the frame.
    pub slot: usize,
    /// Its place in the file, points without finite coordinates counted.
    pub index_in_file: u32,
    /// In the coordinates of the file.
    pub position: DVec3,
    /// Precision of `position`: how far a coordinate of the file may be from it, as it is f32 from the origin of the
    /// sequence; half a step of the largest of its three, scene units.
    pub precision: f64,
    /// Unit normal, if there is one.
    pub normal: Option<PickedNormal>,
    /// 8-bit red, green, blue and alpha of the file, if it has colours.
    pub color: Option<[u8; 4]>,
    /// The colour in which it is drawn.
    pub drawn_color: [u8; 3],
    /// The names and values of all scalar fields.
    pub scalars: Vec<(String, f64)>,
}

/// A normal and where it is from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PickedNormal {
    /// From the file.
    File(Vec3),
    /// Estimated from neighbours.
    Estimated(Vec3),
}

impl Pick {
    /// Returns the attributes of the point at `slot` of `frame`, whose positions are relative to `origin`; `None` if it
    /// has fewer points.
    pub fn of(frame: &PreparedFrame, origin: DVec3, slot: usize) -> Option<Self> {
        let cloud = &frame.frame;
        let position = *cloud.positions().get(slot)?;
        let of_file = cloud.normals().map(|normals| normals[slot]);
        let estimated = frame.shapes.as_ref().and_then(|shapes| shapes.get(slot));
        let normal = match of_file.filter(|normal| *normal != Vec3::ZERO) {
            Some(normal) => Some(PickedNormal::File(normal)),
            None => estimated.map(|shape| PickedNormal::Estimated(oct_decode(shape.normal))),
        };
        let [red, green, blue, _] = frame.points.get(slot)?.color;
        Some(Self {
            frame: frame.index,
            slot,
            index_in_file: cloud.file_index()[slot],
            position: origin + position.as_dvec3(),
            precision: half_step(position),
            normal,
            color: cloud.colors().map(|colors| colors[slot]),
            drawn_color: [red, green, blue],
            scalars: cloud
                .scalar_fields()
                .iter()
                .map(|field| {
                    let value = f64::from(field.values[slot]) + field.offset;
                    (field.name.clone(), value)
                })
                .collect(),
        })
    }
}

/// Half the distance between the largest coordinate and the next f32.
fn half_step(position: Vec3) -> f64 {
    let largest = position.abs().max_element();
    0.5 * (f64::from(largest.next_up()) - f64::from(largest))
}

/// The slot in `frame` of the point under the pixel that holds `place_px`, in the image drawn of `frame` from `packet`;
/// else of the point nearest to it in the image, less than `radius_px` away; `None` if there is none. Of points at one
/// place it is the last, whose colour is seen.
///
/// Where cells of the octree are drawn, it is the point nearest to the hit: for a voxel one that is inside, unless it
/// closes a gap between others. Where triangles are drawn, it is the nearest one as well: they may have no other points
/// than their corners.
pub fn pick(packet: &ScenePacket, frame: &PreparedFrame, place_px: [f64; 2], radius_px: f64) -> Option<usize> {
    let ray = Ray::new(packet, place_px);
    match &packet.content {
        Content::Nothing => None,
        Content::Points(points) => {
            let sprites = Sprites::new(packet, points, None);
            let chosen = ray.choose(&sprites, radius_px)?;
            slot_of(packet, frame, points, chosen.record)
        }
        Content::Selected(_) | Content::Visible(_) => {
            let content = Content::Surfels(packet.content.gathered()?);
            let packet = ScenePacket {
                content,
                ..packet.clone()
            };
            pick(&packet, frame, place_px, radius_px)
        }
        Content::Surfels(surfels) => {
            let chosen = if packet.style.primitive == Primitive::Point {
                let sprites = Sprites::new(packet, &surfels.points, Some(&surfels.shapes));
                ray.choose(&sprites, radius_px)?
            } else {
                // The blended surfel with the largest weight, which an index buffer could not hold: it stores one
                // surfel per pixel.
                ray.choose(&Disks::new(surfels, &packet.style), radius_px)?
            };
            if packet.style.has_screen_normals() {
                // Only among the visible points, so that positions identify them.
                let place = Vec3::from_array(surfels.points.get(chosen.record)?.position);
                return nearest_drawn(packet, frame, place.as_dvec3(), |_| true);
            }
            let kind = packet.style.levels_kind();
            if kind.and_then(|kind| frame.levels.get(kind)).is_none() {
                return slot_of(packet, frame, &surfels.points, chosen.record);
            }
            // A surfel represents the points of a cell.
            nearest_drawn(packet, frame, chosen.place, |_| true)
        }
        Content::Voxels(voxels) => {
            let cubes = Cubes::new(voxels);
            let chosen = ray.choose(&cubes, radius_px)?;
            let cell = cubes.cell(chosen.record);
            nearest_drawn(packet, frame, chosen.place, |place| cell.contains(place))
        }
        Content::Mesh(mesh) => {
            // A point of the frame, not the position on the triangle: measuring, trails and the point panel work on
            // points.
            let chosen = ray.choose(&Triangles::new(mesh, packet), radius_px)?;
            nearest_drawn(packet, frame, chosen.place, |_| true)
        }
        Content::Coded(coded) => {
            let surfels = surfels_near(&ray, coded, &packet.style, radius_px);
            let disks = Disks::new(&surfels, &packet.style);
            let chosen = ray.choose(&disks, radius_px)?;
            nearest_drawn(packet, frame, chosen.place, |_| true)
        }
    }
}

/// The slot of a record of a packet that has all points of the frame but for those that are clipped.
fn slot_of(packet: &ScenePacket, frame: &PreparedFrame, drawn: &Arc<Vec<PointRecord>>, record: usize) -> Option<usize> {
    match packet.params.clip {
        Some(clip) if !Arc::ptr_eq(drawn, &frame.points) => {
            let retained = clip.retained(&frame.points);
            retained.get(record).map(|&slot| slot as usize)
        }
        _ => Some(record),
    }
}

/// Returns the [`nearest`] unclipped point, if there is one: a cell is drawn if its centre is unclipped.
fn nearest_drawn(
    packet: &ScenePacket,
    frame: &PreparedFrame,
    place: DVec3,
    is_within: impl Fn(DVec3) -> bool + Sync,
) -> Option<usize> {
    let Some(clip) = packet.params.clip else {
        return nearest(&frame.points, place, is_within);
    };
    let retained = clip.retained(&frame.points);
    let slot = nearest(&at(&frame.points, &retained), place, is_within)?;
    Some(retained[slot] as usize)
}

/// The point nearest to a place of those that are within, or of all if none is; of equals the last.
fn nearest(points: &[PointRecord], place: DVec3, is_within: impl Fn(DVec3) -> bool + Sync) -> Option<usize> {
    let rank = |slot: usize| {
        let there = Vec3::from_array(points[slot].position).as_dvec3();
        (!is_within(there), there.distance_squared(place), slot)
    };
    let order = |a: &(bool, f64, usize), b: &(bool, f64, usize)| -> Ordering {
        let apart = a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        apart.then(b.2.cmp(&a.2))
    };
    let all = (0..points.len()).into_par_iter();
    let best = all.with_min_len(POINTS_PER_TASK).map(rank).min_by(order);
    best.map(|(_, _, slot)| slot)
}

#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
