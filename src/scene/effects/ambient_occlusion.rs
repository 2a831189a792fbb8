//! Ambient occlusion: the fraction of ambient light that reaches a position, by the surfaces near it in the image.
//!
//! **How it works** (volumetric obscurance, Loos and Sloan 2010, with the hemisphere of the normal). A ball is put
//! around the position in a pixel. The half of it above the tangent plane counts: the share of that volume behind the
//! surface of the image is dark. The volume is measured along [`AmbientOcclusion::LINES`] through the ball, along the
//! view axis. All of it is heights above the place in units of the radius, towards the eye:
//!
//! - a line at `[x, y]` is in the ball from `-t` to `t = sqrt(1 - x² - y²)`;
//! - the tangent plane is at `g` there, so the line is in the half ball from `bottom = clamp(g, -t, t)` on;
//! - the surface of the image is at `h` there, so the line is filled from `bottom` to `clamp(h, bottom, t)`;
//! - a surface far in front of the place hides it without being near: lines count less from `h = t + 1` on, and nothing
//!   from `t + 2` on.
//!
//! The share of the light that is lost is `Σ filled / Σ (t - bottom)`. In a corner of two walls at right angles it is a
//! half, and `(1 - d)² · (2 + d) / 4` at `d` radii from it, seen from any distance and side; a plane has none, as `h =
//! g`: both lie on rays through the same pixels, so perspective is exact.
//!
//! Lines change by lengths and not by hits, so few of them are smooth, and they are the same for every pixel: there is
//! no noise, nothing to blur, and parts of an image match the whole. Horizons (Bavoil and Sainz 2008; Jimenez et al.
//! 2016) take angles where this takes lengths, and both noise.
//!
//! Depths come from the depth buffer, normals from the blended surface. The radius is a share of the cloud's, so that
//! creases stay as dark when the camera moves.

use crate::scene::ScenePacket;
use crate::scene::style::OnOff;

/// The usual radius of the ball, as a share of the cloud's.
const RADIUS_OF_CLOUD: f32 = 0.2;

/// The largest ball in an image, as a share of its height.
const MAX_RADIUS_OF_HEIGHT: f32 = 0.15;

/// The largest ball in any image: parts of large ones are drawn with this margin around them.
const MAX_RADIUS_PX: f32 = 512.0;

/// Ambient occlusion parameters of an image, in addition to depths and normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOcclusion {
    /// Radius of the ball at the near plane; `near / distance` times that at a distance.
    pub near_radius_px: f32,
    /// The largest one.
    pub max_radius_px: f32,
    /// Pixels from the view axis for a slope of 1.
    pub px_per_slope: f32,
    /// Strength: the fraction of the light that is lost relative to the fraction that is filled; 1 is the same
    /// fraction.
    pub strength: f32,
}

impl AmbientOcclusion {
    /// Number of lines through a ball: three rings of eight that represent equal areas of its disk.
    pub const LINES: usize = 24;

    /// Heights above the tangent plane that count as on it, in radii: splats are flat where surfaces bend.
    pub const ROUGHNESS: f32 = 0.02;

    /// The ambient occlusion of a packet; `None` if it is off, or without a lit surface.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        let style = &packet.style;
        let light = &style.light;
        let is_on = light.ao == OnOff::On && light.ao_strength > 0.0 && light.ao_radius > 0.0;
        (is_on && style.is_shaded_with_depths()).then(|| {
            let cloud = style.of_sequence.ground_box.unwrap_or(packet.bounds);
            let radius = light.ao_radius * RADIUS_OF_CLOUD * cloud.radius();
            let px_per_slope = packet.view.pixels_per_unit_at_1;
            Self {
                near_radius_px: radius * px_per_slope / packet.view.near,
                max_radius_px: (MAX_RADIUS_OF_HEIGHT * packet.whole_height_px().round()).min(MAX_RADIUS_PX),
                px_per_slope,
                strength: light.ao_strength,
            }
        })
    }

    /// Returns the halo size: the distance of the farthest lines, in columns or rows.
    pub fn halo_px(&self) -> u32 {
        self.max_radius_px.ceil() as u32
    }

    /// Returns the positions of the lines in a ball of radius 1 around the origin. Opposite lines are pairs; no two
    /// rings look in the same directions.
    pub fn lines() -> [[f32; 2]; Self::LINES] {
        const RINGS: usize = 3;
        const PER_RING: usize = AmbientOcclusion::LINES / RINGS;
        std::array::from_fn(|line| {
            let (ring, place) = (line / PER_RING, line % PER_RING);
            let away = ((ring as f32 + 0.5) / RINGS as f32).sqrt();
            let turn = (place as f32 + (ring as f32 + 0.5) / RINGS as f32) / PER_RING as f32;
            let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
            [away * cos, away * sin]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_directions_are_distinct_and_paired_with_opposites() {
        let lines = AmbientOcclusion::lines();
        for [x, y] in lines {
            let is_opposite = |[right, up]: &[f32; 2]| (x + right).abs() + (y + up).abs() < 1e-6;
            assert_eq!(lines.iter().filter(|line| is_opposite(line)).count(), 1);
        }
        let mut degrees = lines.map(|[x, y]| y.atan2(x).to_degrees());
        degrees.sort_by(f32::total_cmp);
        assert!(degrees.windows(2).all(|pair| pair[1] - pair[0] > 14.9), "{degrees:?}");
    }
}
