//! Depth maps of the surface as seen by each input image (Yang et al. 2006 §3.3). Both renderers get them from here:
//! they are drawn on the CPU, once for each frame and not for each rendered image.

use super::cpu::depths::distances_of_surface;
use crate::scene::{DepthMap, PhotoDepths, PhotosInFrame, ScenePacket, SurfelStyle, seen_by_photo};
use std::sync::Arc;

/// The depths of the packet drawn last, and their inputs.
#[derive(Debug, Default)]
pub(in crate::render) struct KnownDepths(Option<((PhotosInFrame, SurfelStyle), Arc<PhotoDepths>)>);

impl KnownDepths {
    /// Returns the depth maps of a packet: those that it provides, those that are cached, or those drawn now.
    pub(in crate::render) fn of(&mut self, packet: &ScenePacket) -> Arc<PhotoDepths> {
        let Some(shown) = &packet.posed_images else {
            return Arc::default();
        };
        if let Some(depths) = &shown.depths {
            return Arc::clone(depths);
        }
        let of = (shown.clone(), packet.style.surfels);
        let known = self.0.take().filter(|(known, _)| *known == of);
        let known = known.unwrap_or_else(|| (of, Arc::new(depths_of_photos(packet))));
        Arc::clone(&self.0.insert(known).1)
    }
}

/// Returns the depth maps of the input images of a packet: from their files, else from the surface. Empty without input
/// images.
pub fn depths_of_photos(packet: &ScenePacket) -> PhotoDepths {
    let Some(shown) = &packet.posed_images else {
        return PhotoDepths::default();
    };
    let mut blocks = None;
    let max_extent = 2.0 * packet.bounds.radius();
    let posed_images = shown.posed_images.all().iter();
    let maps = posed_images.map(|posed_image| {
        if let Some(depth) = &posed_image.depth {
            return DepthMap::new(depth.size_px(), depth.metres().to_vec(), max_extent, true);
        }
        let Some(seen) = seen_by_photo(packet, posed_image) else {
            return DepthMap::new([1, 1], vec![0.0], 0.0, false);
        };
        let distances = distances_of_surface(&seen, &mut blocks);
        DepthMap::new(seen.viewport_px, distances, max_extent, false)
    });
    PhotoDepths { maps: maps.collect() }
}
