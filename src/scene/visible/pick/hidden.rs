//! Occlusion test of a point of the cloud against the drawn records.
//!
//! **How it works.** The ray through the pixel of the point is tested against the drawn records, as for a click. The
//! first hit occludes the point if that is behind it by more than the distance of surfels of one surface: a label on a
//! surface is not hidden by its neighbours.

use super::codes::surfels_near;
use super::ray::Ray;
use super::records::{Cubes, Disks, Sprites, Triangles};
use crate::scene::{Content, Primitive, ScenePacket, Surfels};
use glam::{DVec2, DVec3};

/// Occlusion slack: an occluder is nearer than the point by at least this fraction of the point's distance.
const SLACK: f64 = 0.02;

/// Performs the occlusion test for `places`, relative to the origin of the sequence, each with its pixel: true for
/// those behind the surface drawn there. Places outside the image are not hidden.
pub fn hidden(packet: &ScenePacket, places: &[(DVec3, DVec2)]) -> Vec<bool> {
    let [width, height] = packet.viewport_px.map(f64::from);
    let is_seen = |px: DVec2| (0.0..width).contains(&px.x) && (0.0..height).contains(&px.y);
    if !places.iter().any(|&(_, px)| is_seen(px)) {
        return vec![false; places.len()];
    }
    // Records that the renderer would gather are gathered once for all places.
    if let Some(surfels) = packet.content.gathered() {
        let content = Content::Surfels(surfels);
        let packet = ScenePacket {
            content,
            ..packet.clone()
        };
        return hidden(&packet, places);
    }
    let is_hidden = |&(place, px): &(DVec3, DVec2)| is_seen(px) && is_behind(packet, place, px);
    places.iter().map(is_hidden).collect()
}

fn is_behind(packet: &ScenePacket, place: DVec3, px: DVec2) -> bool {
    // A ray against the packet, as for a click: correct for every primitive without reading back a depth buffer.
    let ray = Ray::new(packet, px.to_array());
    let depth = ray.depth_of(place);
    // With parallel rays the eye is far away, whatever the cloud's size.
    let slack = SLACK * depth / f64::from(packet.view.telephoto);
    nearest_place(packet, &ray).is_some_and(|nearest| ray.depth_of(nearest) < depth - slack)
}

/// Returns the nearest hit of the ray with the drawn records.
fn nearest_place(packet: &ScenePacket, ray: &Ray) -> Option<DVec3> {
    let of_surfels = |surfels: &Surfels| {
        if packet.style.primitive == Primitive::Point {
            ray.choose(&Sprites::new(packet, &surfels.points, Some(&surfels.shapes)), 0.0)
        } else {
            ray.choose(&Disks::new(surfels, &packet.style), 0.0)
        }
    };
    let seen = match &packet.content {
        Content::Nothing => None,
        Content::Points(points) => ray.choose(&Sprites::new(packet, points, None), 0.0),
        Content::Surfels(surfels) => of_surfels(surfels),
        Content::Selected(_) | Content::Visible(_) => of_surfels(&packet.content.gathered()?),
        Content::Voxels(voxels) => ray.choose(&Cubes::new(voxels), 0.0),
        Content::Mesh(mesh) => ray.choose(&Triangles::new(mesh, packet), 0.0),
        Content::Coded(coded) => {
            let surfels = surfels_near(ray, coded, &packet.style, 0.0);
            ray.choose(&Disks::new(&surfels, &packet.style), 0.0)
        }
    };
    seen.map(|seen| seen.place)
}
