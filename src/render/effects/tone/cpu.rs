//! The tone curve on the CPU (`shaders/effects/tone.wgsl`): a table of bytes.

use crate::render::effects::effect::{PictureRow, RowStep};
use crate::scene::ScenePacket;
use std::array;

/// Each byte of a channel after the curve.
#[derive(Debug)]
struct Curve([u8; 256]);

/// The settings of a packet.
pub(super) fn step(packet: &ScenePacket) -> Option<Box<dyn RowStep>> {
    let exponent = packet.style.light.tone_exponent()?;
    Some(Box::new(Curve::of(exponent)))
}

impl Curve {
    fn of(exponent: f32) -> Self {
        Self(array::from_fn(|byte| {
            // A table of 256 bytes differs from the GPU's power function by one step at most.
            let channel = (byte as f32 / 255.0).powf(exponent);
            (channel * 255.0 + 0.5) as u8
        }))
    }
}

impl RowStep for Curve {
    fn draw(&self, row: &mut PictureRow<'_>) {
        for [red, green, blue, _] in row.pixels.iter_mut() {
            for channel in [red, green, blue] {
                *channel = self.0[usize::from(*channel)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_white_are_unchanged_and_tones_between_get_brighter() {
        let Curve(brighter) = Curve::of(1.0 / 2.0);
        assert_eq!([brighter[0], brighter[64], brighter[255]], [0, 128, 255]);
        assert!(brighter.is_sorted());
        let Curve(darker) = Curve::of(2.0);
        assert_eq!([darker[0], darker[128], darker[255]], [0, 64, 255]);
    }
}
