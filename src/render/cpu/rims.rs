//! Splat edges, when all tiles are drawn: the surface behind them shows through instead of the background. The
//! definitions of an edge and of the surface behind it are in `scene/effects/rims.rs`.
//!
//! How it works: all rows are searched before any is written, since the neighbours of a pixel must be the drawn ones,
//! not changed ones; then changed pixels are written. Most pixels are opaque or open, and are passed over.
//! `posed_images/gaps.rs` samples the input images first.

use crate::render::effects::background::cpu::Gradient;
use crate::scene::{GAP_ONE_SURFACE, PIXEL_LINES};
use rayon::prelude::*;

/// Opacities of pixels in eight bits. A GPU compares with `RIM_OPEN` and `RIM_OPAQUE` of `scene/effects/rims.rs`, which
/// are rounded to these.
const OPEN: u8 = 0;
const OPAQUE: u8 = u8::MAX;

/// A drawn image before its open pixels are filled.
pub(super) struct Drawn<'a> {
    pub(super) size: [i32; 2],
    /// The fourth byte of a pixel is its opacity.
    pub(super) pixels: &'a [[u8; 4]],
    /// Reversed.
    pub(super) depths: &'a [f32],
    /// Maximum distance of the opaque pixels on both sides of a splat edge, in steps from one to the other; 0: no edges
    /// are covered.
    pub(super) rim_px: i32,
}

/// An opaque pixel on a line from another one.
#[derive(Debug, Clone, Copy)]
struct End {
    steps: i32,
    at: usize,
}

/// Fills splat edges with the surface behind them, in an image that has opacities instead of alpha, and these reversed
/// depths.
pub(super) fn cover_rims(size_px: [u32; 2], rim_px: u32, gradient: &Gradient, image: &mut [u8], depths: &[f32]) {
    fill_rows(size_px, rim_px, image, depths, |drawn, y| {
        drawn.covered_of_row(gradient.at_row(y), y)
    });
}

/// Writes the pixels that `filled_of_row` finds in each row, with their places in the image: in all of them, before any
/// is written.
pub(super) fn fill_rows(
    size_px: [u32; 2],
    rim_px: u32,
    image: &mut [u8],
    depths: &[f32],
    filled_of_row: impl Fn(&Drawn<'_>, i32) -> Vec<(usize, [u8; 4])> + Sync,
) {
    let [width, height] = size_px.map(|edge| edge as i32);
    let (pixels, _) = image.as_chunks_mut::<4>();
    let drawn = Drawn {
        size: [width, height],
        pixels,
        depths,
        rim_px: rim_px as i32,
    };
    let filled: Vec<_> = (0..height).into_par_iter().map(|y| filled_of_row(&drawn, y)).collect();
    for (at, color) in filled.into_iter().flatten() {
        pixels[at] = color;
    }
}

impl Drawn<'_> {
    /// The pixels of a row at splat edges, with their places in the image.
    fn covered_of_row(&self, background: [f32; 3], y: i32) -> Vec<(usize, [u8; 4])> {
        let mut covered = Vec::new();
        for x in 0..self.size[0] {
            if let Some(behind) = self.behind_rim([x, y]) {
                let at = self.at([x, y]);
                covered.push((at, over(self.pixels[at], background, behind)));
            }
        }
        covered
    }

    pub(super) fn at(&self, [x, y]: [i32; 2]) -> usize {
        self.size[0] as usize * y as usize + x as usize
    }

    /// The colour behind the splat edge at a pixel, if it is at one, 0 to 1.
    #[inline(always)]
    pub(super) fn behind_rim(&self, pixel: [i32; 2]) -> Option<[f32; 3]> {
        match self.pixels[self.at(pixel)][3] {
            OPEN | OPAQUE => None,
            _ => self.behind(pixel),
        }
    }

    fn behind(&self, pixel: [i32; 2]) -> Option<[f32; 3]> {
        let mut found = None;
        let mut shortest = f32::INFINITY;
        // One of the four lines is enough, unlike for gaps: along a straight edge, one line never ends.
        for [right, down] in PIXEL_LINES {
            let step = ((right * right + down * down) as f32).sqrt();
            // Longer ones are no longer of interest.
            let max = self.rim_px.min((shortest / step).ceil() as i32 - 1);
            let Some(one) = self.opaque_end(pixel, [-right, -down], max - 1) else {
                continue;
            };
            let Some(other) = self.opaque_end(pixel, [right, down], max - one.steps) else {
                continue;
            };
            let span = (one.steps + other.steps) as f32 * step;
            if span < shortest {
                (found, shortest) = (Some((one, other)), span);
            }
        }
        found.map(|(one, other)| self.between(one, other))
    }

    /// The colour behind the stretch between two ends of a line.
    fn between(&self, one: End, other: End) -> [f32; 3] {
        let [depth, other_depth] = [one, other].map(|end| self.depths[end.at]);
        // On a single surface, which end is farther would depend on rounding, and the two renderers would differ.
        let to_other = if depth.min(other_depth) >= GAP_ONE_SURFACE * depth.max(other_depth) {
            one.steps as f32 / (one.steps + other.steps) as f32
        } else if depth < other_depth {
            0.0
        } else {
            1.0
        };
        std::array::from_fn(|axis| {
            let [color, other_color] = [one, other].map(|end| f32::from(self.pixels[end.at][axis]) / 255.0);
            color + to_other * (other_color - color)
        })
    }

    fn opaque_end(&self, pixel: [i32; 2], [right, down]: [i32; 2], max: i32) -> Option<End> {
        let max = max.min(self.space(pixel, 0, right)).min(self.space(pixel, 1, down));
        let per_step = self.size[0] as isize * down as isize + right as isize;
        let mut at = self.at(pixel);
        for steps in 1..=max {
            at = at.wrapping_add_signed(per_step);
            match self.pixels[at][3] {
                OPAQUE => return Some(End { steps, at }),
                OPEN => return None,
                _ => {}
            }
        }
        None
    }

    /// Steps of one pixel along an axis from another one on until the image ends.
    fn space(&self, pixel: [i32; 2], axis: usize, step: i32) -> i32 {
        match step {
            0 => i32::MAX,
            1 => self.size[axis] - 1 - pixel[axis],
            _ => pixel[axis],
        }
    }
}

/// Returns a pixel through which `behind` shines instead of the background.
pub(super) fn over([red, green, blue, opacity]: [u8; 4], background: [f32; 3], behind: [f32; 3]) -> [u8; 4] {
    let open = 1.0 - f32::from(opacity) / 255.0;
    let channel = |drawn: u8, axis: usize| {
        let value = f32::from(drawn) + 255.0 * open * (behind[axis] - background[axis]);
        (value + 0.5).clamp(0.0, 255.0) as u8
    };
    [channel(red, 0), channel(green, 1), channel(blue, 2), u8::MAX]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: [i32; 2] = [24, 16];

    /// The red behind the splat edge at `pixel`, of an image of these opacities. Red is ten times the column, and
    /// pixels right of column 11 have the reversed depth `behind`, next to 0.8.
    fn red_behind(behind: f32, opacity: impl Fn([i32; 2]) -> u8, pixel: [i32; 2]) -> Option<f32> {
        let all = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
        let pixels: Vec<[u8; 4]> = all().map(|at| [10 * at[0] as u8, 0, 0, opacity(at)]).collect();
        let depths: Vec<f32> = all().map(|[x, _]| if x < 12 { 0.8 } else { behind }).collect();
        let drawn = Drawn {
            size: SIZE,
            pixels: &pixels,
            depths: &depths,
            rim_px: 6,
        };
        drawn.behind_rim(pixel).map(|[red, _, _]| (255.0 * red).round())
    }

    #[test]
    fn the_background_shows_through_a_falloff_edge() {
        // Opaque except for two columns of a straight soft edge, which no line along it leaves.
        let rim = |[x, _]: [i32; 2]| if (10..12).contains(&x) { 90 } else { 255 };
        for y in [1, 8, 14] {
            assert_eq!(red_behind(0.2, rim, [10, y]), Some(120.0));
            assert_eq!(red_behind(0.2, rim, [11, y]), Some(120.0));
            // On a single surface, the interpolated colour shines through.
            assert_eq!(red_behind(0.79, rim, [10, y]), Some(100.0));
        }
        let wide = |[x, _]: [i32; 2]| if (5..12).contains(&x) { 90 } else { 255 };
        assert_eq!(red_behind(0.2, wide, [8, 8]), None);
    }

    #[test]
    fn outlines_and_edges_of_holes_are_unchanged() {
        let outline = |[x, _]: [i32; 2]| match x {
            ..10 => 255,
            10..12 => 90,
            _ => 0,
        };
        assert_eq!(red_behind(0.2, outline, [10, 8]), None);
        assert_eq!(red_behind(0.2, outline, [11, 8]), None);
        // Seven transparent pixels of each row and column, with a falloff around them.
        let hole = |[x, y]: [i32; 2]| match (x - 11).abs().max((y - 8).abs()) {
            ..4 => 0,
            4 => 90,
            _ => 255,
        };
        for pixel in [[7, 8], [15, 7], [11, 4], [12, 12], [11, 8]] {
            assert_eq!(red_behind(0.79, hole, pixel), None, "{pixel:?}");
        }
        // Pixels beyond the border are unknown.
        let at_border = |[x, _]: [i32; 2]| if x == 0 { 90 } else { 255 };
        assert_eq!(red_behind(0.2, at_border, [0, 8]), None);
    }

    proptest! {
        /// All lines of all lengths, one after the other.
        #[test]
        fn the_shortest_line_is_found(
            opacities in prop::collection::vec(prop::sample::select(vec![0_u8, 90, 90, 90, 200, 255]), 12 * 9),
            depths in prop::collection::vec(0.1_f32..1.0, 12 * 9),
            rim_px in 0_i32..12,
        ) {
            let (width, height) = (12, 9);
            let pixels: Vec<[u8; 4]> = (0u8..).zip(opacities).map(|(at, opacity)| [at, 0, 0, opacity]).collect();
            let drawn = Drawn {
                size: [width, height],
                pixels: &pixels,
                depths: &depths,
                rim_px,
            };
            let end = |[x, y]: [i32; 2], [right, down]: [i32; 2]| {
                let way = (1..).map(|steps| (steps, x + steps * right, y + steps * down));
                let mut inside = way.take_while(|&(_, x, y)| (0..width).contains(&x) && (0..height).contains(&y));
                let (steps, x, y) = inside.find(|&(_, x, y)| [0, 255].contains(&pixels[(width * y + x) as usize][3]))?;
                let at = (width * y + x) as usize;
                (pixels[at][3] == 255).then_some(End { steps, at })
            };
            for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
                let lines = PIXEL_LINES.iter().filter_map(|&[right, down]| {
                    let (one, other) = end(pixel, [-right, -down]).zip(end(pixel, [right, down]))?;
                    let steps = one.steps + other.steps;
                    let length = steps as f32 * ((right * right + down * down) as f32).sqrt();
                    (steps <= rim_px).then_some((length, one, other))
                });
                let shortest = lines.min_by(|one, other| one.0.total_cmp(&other.0));
                let expected = shortest.map(|(_, one, other)| drawn.between(one, other));
                let is_partial = ![0, 255].contains(&pixels[drawn.at(pixel)][3]);
                prop_assert_eq!(drawn.behind_rim(pixel), expected.filter(|_| is_partial));
            }
        }
    }

    #[test]
    fn half_covered_pixels_retain_their_half() {
        // 0.502 × (160, 80, 0) over the background (0, 0, 255).
        let background = [0.0, 0.0, 1.0];
        assert_eq!(over([80, 40, 127, 128], background, [1.0, 0.0, 0.0]), [207, 40, 0, 255]);
        // A transparent pixel takes the colour behind it.
        let nearly_blue = [9.0, 8.0, 7.0].map(|channel| channel / 255.0);
        assert_eq!(over([9, 8, 7, 0], nearly_blue, [1.0, 0.5, 0.0]), [255, 128, 0, 255]);
    }
}
