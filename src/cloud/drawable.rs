//! Lengths that images can be drawn with: those whose squares and products single precision can hold.
//!
//! Coordinates are single-precision floats, which reach from 1e-38 to 3e38. Distances, normals and projections are made
//! of squares and products of two or three lengths, so far larger or smaller clouds gave empty images without a word.

use super::error::DRAWABLE_EXTENTS;
use super::{CloudError, Frame};

impl Frame {
    /// Returns this frame if images can be drawn of it: if it is neither too large nor too small nor too far away from
    /// the origin for single precision. Points that coincide have no extent, and are drawn.
    pub(crate) fn drawable(self) -> Result<Self, CloudError> {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return Ok(self);
        }
        // In f64, as the difference of the largest numbers is none of f32.
        let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
        let reach = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        let [min, max] = [DRAWABLE_EXTENTS.start(), DRAWABLE_EXTENTS.end()].map(|&end| f64::from(end));
        let is_small = extent > 0.0 && extent < min;
        if is_small || extent.max(reach) > max {
            let length = if is_small { extent } else { extent.max(reach) };
            return Err(CloudError::Undrawable {
                length,
                exponent: -(length.log10().round() as i32),
            });
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use glam::DVec3;

    fn span(length: f32) -> Result<Frame, CloudError> {
        let positions = Positions::F32(vec![[0.0; 3], [length, 0.0, 0.0]]);
        Frame::from_raw(RawCloud::from_positions(positions), DVec3::ZERO)
            .unwrap()
            .drawable()
    }

    #[test]
    fn extents_of_24_orders_are_drawn_and_others_say_why() {
        for length in [0.0, 1e-12, 1e-6, 1.0, 1e6, 1e12] {
            assert!(span(length).is_ok(), "{length}");
        }
        for (length, expected) in [
            (1e-13, "1e13"),
            (1e-30, "1e30"),
            (1e13, "1e-13"),
            (1e30, "1e-30"),
            (3e38, "1e-38"),
        ] {
            let message = span(length).unwrap_err().to_string();
            assert!(
                message.contains("1e-12 to 1e12") && message.contains(expected),
                "{message}"
            );
        }
        let empty = Frame::from_raw(RawCloud::from_positions(Positions::F32(Vec::new())), DVec3::ZERO).unwrap();
        assert!(empty.drawable().is_ok());
    }

    #[test]
    fn points_far_from_the_origin_of_their_sequence_are_refused() {
        let positions = Positions::F32(vec![[1e30; 3]]);
        let frame = Frame::from_raw(RawCloud::from_positions(positions.clone()), DVec3::ZERO).unwrap();
        assert!(frame.drawable().is_err());
        let origin = DVec3::splat(f64::from(1e30f32));
        let frame = Frame::from_raw(RawCloud::from_positions(positions), origin).unwrap();
        assert!(frame.drawable().is_ok(), "relative to it they are at zero");
    }
}
