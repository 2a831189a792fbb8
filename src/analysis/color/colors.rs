//! Colours for points that have none in the file.

use glam::Vec3;

/// The paper's fake colour (000 §III): the direction of a normal as red, green and blue, each from 0 (facing down the
/// axis) to 255 (facing up). The zero vector is grey.
pub fn fake_color(normal: Vec3) -> [u8; 4] {
    // `as` rounds towards zero and saturates; adding one half makes it round to nearest.
    let [red, green, blue] = ((normal + 1.0) * 127.5 + 0.5).to_array().map(|channel| channel as u8);
    [red, green, blue, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_map_to_known_colors() {
        assert_eq!(fake_color(Vec3::X), [255, 128, 128, 255]);
        assert_eq!(fake_color(Vec3::NEG_Y), [128, 0, 128, 255]);
        assert_eq!(fake_color(Vec3::ZERO), [128, 128, 128, 255]);
    }
}
