//! Halo of the screen-space steps: the neighbourhood that those after the passes over records read.

use crate::scene::{AmbientOcclusion, EyeDomeLight, ScenePacket, gap_px, rim_px, speck_px};

/// Returns the halo size: the maximum distance in pixels at which others affect the colour of a pixel.
pub fn halo_px(packet: &ScenePacket) -> u32 {
    let drawn = packet.as_drawn();
    let eye_dome = EyeDomeLight::of(&drawn).map_or(0, |light| light.halo_px());
    let occlusion = AmbientOcclusion::of(&drawn).map_or(0, |occlusion| occlusion.halo_px());
    let antialiasing = packet.style.drawing.antialiasing;
    // Specks are detected after their surroundings have been closed.
    let closing = gap_px(&drawn).max(rim_px(&drawn)) + speck_px(gap_px(&drawn));
    let looks_px = eye_dome.max(occlusion).max(closing);
    looks_px.div_ceil(antialiasing.samples_per_edge()) + antialiasing.halo_px()
}
