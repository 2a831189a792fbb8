//! Texture memory budget: the downscaling of input images that makes their textures fit into memory.
//!
//! All are halved the same number of times: images of one scene that differ in sharpness would show where one gives way
//! to another. Textures are layers of one array, so each takes the same space as the largest, with all levels of its
//! mipmap.

use super::mips::half;

/// Bytes of a pixel: red, green, blue and alpha.
const PIXEL_BYTES: u64 = 4;

/// Sides are below 2^32: after 32 halvings all are one pixel.
const MAX_HALVINGS: u32 = 32;

/// Bytes of a texture of `size_px` with all levels of its mipmap.
pub fn texture_bytes(size_px: [u32; 2]) -> u64 {
    let mut size_px = size_px;
    let mut bytes = 0_u64;
    loop {
        let pixels = u64::from(size_px[0]) * u64::from(size_px[1]);
        bytes = bytes.saturating_add(pixels.saturating_mul(PIXEL_BYTES));
        if size_px[0] <= 1 && size_px[1] <= 1 {
            return bytes;
        }
        size_px = size_px.map(half);
    }
}

/// Returns the minimum number of times that images of these sizes are halved until an array of their textures takes at
/// most `budget_bytes`, and no side is longer than `max_side_px`, which is limited by GPUs. Images that cannot fit are
/// halved down to pixels.
pub fn halvings_within(sizes_px: &[[u32; 2]], budget_bytes: u64, max_side_px: u32) -> u32 {
    let largest = |axis: usize| sizes_px.iter().map(|size_px| size_px[axis]).max().unwrap_or(0);
    let mut size_px = [largest(0), largest(1)];
    let mut halvings = 0;
    let fits = |size_px: [u32; 2]| {
        let bytes = texture_bytes(size_px).saturating_mul(sizes_px.len() as u64);
        bytes <= budget_bytes && size_px.iter().all(|&side| side <= max_side_px)
    };
    while halvings < MAX_HALVINGS && !fits(size_px) && size_px != [1, 1] {
        size_px = size_px.map(half);
        halvings += 1;
    }
    halvings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mipmaps_add_a_third_to_a_texture() {
        assert_eq!(texture_bytes([1, 1]), 4);
        assert_eq!(texture_bytes([4, 2]), 4 * (8 + 2 + 1));
        let bytes = texture_bytes([1024, 1024]);
        assert!((bytes as f64 / (4.0 * 1024.0 * 1024.0) - 4.0 / 3.0).abs() < 1e-4);
        // No image, and the largest: neither loops forever.
        assert_eq!(texture_bytes([0, 0]), 0);
        assert_eq!(texture_bytes([u32::MAX; 2]), u64::MAX);
    }

    #[test]
    fn images_are_halved_until_they_fit() {
        let sizes = [[1024, 512], [512, 1024]];
        let whole = 2 * texture_bytes([1024, 1024]);
        assert_eq!(halvings_within(&sizes, whole, 8192), 0);
        assert_eq!(halvings_within(&sizes, whole - 1, 8192), 1);
        assert_eq!(halvings_within(&sizes, whole / 16, 8192), 2);
        assert_eq!(halvings_within(&sizes, whole, 256), 2);
        assert_eq!(halvings_within(&sizes, 0, 8192), 10);
        assert_eq!(halvings_within(&[], 0, 8192), 0);
        assert_eq!(halvings_within(&[[u32::MAX; 2]], 64, 8192), 30);
    }
}
