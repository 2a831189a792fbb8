//! What each photograph sees of the surface: its depths (paper 004 §3.3). Both renderers have them from here: they are
//! drawn on the processor, once for each frame and not for each picture.

use super::cpu::depths::distances_of_surface;
use crate::scene::{DepthMap, PhotoDepths, PhotographsInFrame, ScenePacket, SurfelStyle, seen_by_photograph};
use std::sync::Arc;

/// The depths of the packet that was drawn last, and what they were drawn of.
#[derive(Debug, Default)]
pub(in crate::render) struct KnownDepths(Option<((PhotographsInFrame, SurfelStyle), Arc<PhotoDepths>)>);

impl KnownDepths {
    /// Those of a packet: those that it brings, those that are known, or drawn now.
    pub(in crate::render) fn of(&mut self, packet: &ScenePacket) -> Arc<PhotoDepths> {
        let Some(shown) = &packet.photographs else {
            return Arc::default();
        };
        if let Some(depths) = &shown.depths {
            return Arc::clone(depths);
        }
        let of = (shown.clone(), packet.style.surfels);
        let known = self.0.take().filter(|(known, _)| *known == of);
        let known = known.unwrap_or_else(|| (of, Arc::new(depths_of_photographs(packet))));
        Arc::clone(&self.0.insert(known).1)
    }
}

/// The depths that the photographs of a packet see: those of their files, else of the surface. Empty without
/// photographs.
pub fn depths_of_photographs(packet: &ScenePacket) -> PhotoDepths {
    let Some(shown) = &packet.photographs else {
        return PhotoDepths::default();
    };
    let mut blocks = None;
    let most_extent = 2.0 * packet.bounds.radius();
    let photographs = shown.photographs.all().iter();
    let maps = photographs.map(|photograph| {
        if let Some(depth) = &photograph.depth {
            return DepthMap::new(depth.size_px(), depth.metres().to_vec(), most_extent, true);
        }
        let Some(seen) = seen_by_photograph(packet, photograph) else {
            return DepthMap::new([1, 1], vec![0.0], 0.0, false);
        };
        let distances = distances_of_surface(&seen, &mut blocks);
        DepthMap::new(seen.viewport_px, distances, most_extent, false)
    });
    PhotoDepths { maps: maps.collect() }
}
