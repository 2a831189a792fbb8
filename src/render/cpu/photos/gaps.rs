//! Closing of gaps in a surface once all tiles are drawn, where images show that something is there. For the definition
//! of a gap and its contents see `scene/effects/gaps.rs`.
//!
//! How it works: rows are processed in parallel, since the neighbours of a pixel must be the drawn ones, not closed
//! ones; then closed pixels are written. Most pixels that are not covered are background: the distances to the left and
//! upwards show that for most of them. The former is known while a row is processed, the latter is computed before.
//! Specks are looked for in the result.

use super::{PhotoAnswer, Place, Projected, Scores};
use crate::render::cpu::rims::{Drawn, fill_rows, over};
use crate::render::cpu::view::PixelView;
use crate::render::effects::background::cpu::Gradient;
use crate::scene::{GAP_ONE_SURFACE, GAP_SOLID, GAPS_PER_SLIT, PIXEL_LINES, speck_px};
use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;

/// End of a line from a pixel, where it meets the surface or the border of the image.
#[derive(Debug, Clone, Copy)]
struct End {
    steps: i32,
    /// Reversed; 0 beyond the border.
    depth: f32,
}

impl Projected<'_> {
    /// Closes gaps in an image with opacities instead of alpha, and these reversed depths; fills edges without image
    /// samples with the surface behind, and remaining specks with their surroundings.
    pub(in crate::render::cpu) fn close_gaps(
        &self,
        view: &PixelView,
        rim_px: u32,
        gradient: &Gradient,
        image: &mut [u8],
        depths: &[f32],
    ) {
        let level = Level::new();
        let rows_down = rows_from_solid(view.size_px, image);
        // After lighting, for pixels that are not fully covered: no tile is drawn twice for it.
        fill_rows(view.size_px, rim_px, image, depths, |drawn, y| {
            dispatch!(level, simd => {
                simd.vectorize(
                    #[inline(always)]
                    || self.closed_of_row(simd, view, drawn, &rows_down, gradient.at_row(y), y),
                )
            })
        });
        let widest_speck = speck_px(self.views.gap_px) as i32;
        fill_rows(view.size_px, rim_px, image, depths, |drawn, y| {
            drawn.specks_of_row(gradient.at_row(y), y, widest_speck)
        });
    }

    /// The pixels of a row that are closed, with their places in the image.
    #[inline(always)]
    fn closed_of_row<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        drawn: &Drawn<'_>,
        rows_down: &[u16],
        background: [f32; 3],
        y: i32,
    ) -> Vec<(usize, [u8; 4])> {
        let mut closed = Vec::new();
        let mut scores = Scores::default();
        let max = self.views.gap_px as i32;
        let mut met = -1;
        for x in 0..drawn.size[0] {
            let at = drawn.at([x, y]);
            let is_within_reach = x - met < max || i32::from(rows_down[at]) < max;
            if drawn.is_solid(at) {
                met = x;
            }
            let pixel = drawn.pixels[at];
            if pixel[3] == u8::MAX {
                continue;
            }
            let in_gap = is_within_reach.then(|| drawn.depth_in_gap([x, y], max)).flatten();
            // Images are sampled in the gap: filling it with the surrounding colours would close the handles of real
            // objects too.
            let answer = in_gap.map(|in_gap| {
                let own = drawn.depths[at];
                let depth = if own > 0.0 { own } else { in_gap };
                let place = Place::at(view, [x, y], view.near / depth, Vec3::ZERO);
                self.find(simd, &place, &mut scores)
            });
            let behind = match answer {
                Some(PhotoAnswer::Shown { color, .. }) => Some(color),
                _ => drawn.behind_rim([x, y]),
            };
            if let Some(behind) = behind {
                closed.push((at, over(pixel, background, behind)));
            }
        }
        closed
    }
}

/// Computes the number of rows from each pixel up to the nearest one of its column that belongs to the surface, or to
/// the border.
fn rows_from_solid(size_px: [u32; 2], image: &[u8]) -> Vec<u16> {
    let width = size_px[0] as usize;
    let (pixels, _) = image.as_chunks::<4>();
    let mut rows = vec![0_u16; pixels.len()];
    let mut above = vec![0_u16; width];
    for (pixels, rows) in pixels.chunks(width.max(1)).zip(rows.chunks_mut(width.max(1))) {
        for ((pixel, row), above) in pixels.iter().zip(rows).zip(&mut above) {
            *row = above.saturating_add(1);
            *above = if is_solid(*pixel) { 0 } else { *row };
        }
    }
    rows
}

fn is_solid(pixel: [u8; 4]) -> bool {
    f32::from(pixel[3]) >= 255.0 * GAP_SOLID
}

impl Drawn<'_> {
    /// The specks of a row, no wider than `widest`, with their places in the image.
    fn specks_of_row(&self, background: [f32; 3], y: i32, widest: i32) -> Vec<(usize, [u8; 4])> {
        let mut specks = Vec::new();
        for x in 0..self.size[0] {
            let at = self.at([x, y]);
            if self.pixels[at][3] < u8::MAX
                && let Some(around) = self.mean_around([x, y], widest)
            {
                specks.push((at, over(self.pixels[at], background, around)));
            }
        }
        specks
    }

    /// The mean colour of the opaque pixels on both sides of one along each line, 0 to 1, in shares by how near they
    /// are; if all of these pairs are no more than `widest` steps apart.
    fn mean_around(&self, pixel: [i32; 2], widest: i32) -> Option<[f32; 3]> {
        let (mut sum, mut shares) = ([0.0; 3], 0.0);
        for [right, down] in PIXEL_LINES {
            let one = self.steps_to_opaque(pixel, [-right, -down], widest - 1)?;
            let other = self.steps_to_opaque(pixel, [right, down], widest - one)?;
            for steps in [-one, other] {
                let share = 1.0 / steps.abs() as f32;
                let at = self.at([pixel[0] + steps * right, pixel[1] + steps * down]);
                for (sum, channel) in sum.iter_mut().zip(self.pixels[at]) {
                    *sum += share * f32::from(channel) / 255.0;
                }
                shares += share;
            }
        }
        Some(sum.map(|sum| sum / shares))
    }

    fn steps_to_opaque(&self, [x, y]: [i32; 2], [right, down]: [i32; 2], max: i32) -> Option<i32> {
        let is_opaque = |steps: i32| {
            let pixel = [x + steps * right, y + steps * down];
            self.is_inside(pixel) && self.pixels[self.at(pixel)][3] == u8::MAX
        };
        (1..=max).find(|&steps| is_opaque(steps))
    }

    fn is_inside(&self, [x, y]: [i32; 2]) -> bool {
        (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y)
    }

    fn is_solid(&self, at: usize) -> bool {
        is_solid(self.pixels[at])
    }

    fn end(&self, [x, y]: [i32; 2], [right, down]: [i32; 2], max: i32) -> Option<End> {
        for steps in 1..=max {
            let pixel = [x + steps * right, y + steps * down];
            let depth = if !self.is_inside(pixel) {
                0.0
            } else if self.is_solid(self.at(pixel)) {
                self.depths[self.at(pixel)]
            } else {
                continue;
            };
            return Some(End { steps, depth });
        }
        None
    }

    /// The reversed depth of the surface in the gap around a pixel, if it is in one.
    fn depth_in_gap(&self, pixel: [i32; 2], widest: i32) -> Option<f32> {
        let mut found = None;
        let mut shortest = f32::INFINITY;
        // The line along which a slit is open.
        let mut open_lines = 0;
        let mut is_at_border = false;
        for line in PIXEL_LINES {
            let Some((one, other)) = self.ends(pixel, line, widest) else {
                open_lines += 1;
                if open_lines > 1 {
                    return None;
                }
                continue;
            };
            is_at_border |= one.depth.min(other.depth) == 0.0;
            let [right, down] = line;
            let span = (one.steps + other.steps) as f32 * ((right * right + down * down) as f32).sqrt();
            let depth = depth_between(one, other);
            if depth > 0.0 && span < shortest {
                (found, shortest) = (Some(depth), span);
            }
        }
        // Not at the border: with strips there as slits, Redwood's whole image had 16.18 instead of 14.94 dB, but its
        // surface ended in a comb pattern, closed where it ends near the border and open elsewhere.
        let is_slit = !is_at_border && GAPS_PER_SLIT * shortest <= widest as f32;
        found.filter(|_| open_lines == 0 || is_slit)
    }

    fn ends(&self, pixel: [i32; 2], [right, down]: [i32; 2], max: i32) -> Option<(End, End)> {
        let one = self.end(pixel, [-right, -down], max - 1)?;
        Some((one, self.end(pixel, [right, down], max - one.steps)?))
    }
}

/// The reversed depth between two ends of a line.
fn depth_between(one: End, other: End) -> f32 {
    let nearer = one.depth.max(other.depth);
    let farther = one.depth.min(other.depth);
    if farther >= GAP_ONE_SURFACE * nearer {
        let to_other = one.steps as f32 / (one.steps + other.steps) as f32;
        one.depth + to_other * (other.depth - one.depth)
    } else if farther > 0.0 {
        farther
    } else {
        nearer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [i32; 2] = [32, 24];

    /// Reversed depths of a plane.
    fn plane([x, y]: [i32; 2]) -> f32 {
        0.5 + 0.002 * x as f32 - 0.001 * y as f32
    }

    /// Result at `pixel` of a surface of these reversed depths, which is open where `is_open` says so.
    fn found(depth: impl Fn([i32; 2]) -> f32, is_open: impl Fn([i32; 2]) -> bool, pixel: [i32; 2]) -> Option<f32> {
        let all = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
        let pixels: Vec<[u8; 4]> = all().map(|at| [0, 0, 0, if is_open(at) { 0 } else { 255 }]).collect();
        let depths: Vec<f32> = all().map(|at| if is_open(at) { 0.0 } else { depth(at) }).collect();
        let drawn = Drawn {
            size: SIZE,
            pixels: &pixels,
            depths: &depths,
            rim_px: 0,
        };
        drawn.depth_in_gap(pixel, 8)
    }

    #[test]
    fn a_gap_in_a_plane_is_filled_on_the_plane() {
        let is_open = |[x, y]: [i32; 2]| (10..15).contains(&x) && (8..14).contains(&y);
        for pixel in [[10, 8], [12, 11], [14, 13], [11, 10]] {
            let depth = found(plane, is_open, pixel).unwrap();
            assert!((depth - plane(pixel)).abs() < 1e-6, "{pixel:?}: {depth}");
        }
    }

    #[test]
    fn outlines_wide_slits_and_large_holes_stay_open() {
        let beyond_outline = |[x, _]: [i32; 2]| x > 15;
        assert_eq!(found(plane, beyond_outline, [16, 12]), None);
        let corner = |[x, y]: [i32; 2]| x > 15 && y > 12;
        assert_eq!(found(plane, corner, [16, 13]), None);
        // A slit is open along its own direction.
        let slit = |[x, _]: [i32; 2]| (12..16).contains(&x);
        assert_eq!(found(plane, slit, [12, 12]), None);
        let hole = |[x, y]: [i32; 2]| (6..18).contains(&x) && (6..18).contains(&y);
        assert_eq!(found(plane, hole, [12, 12]), None);
    }

    #[test]
    fn half_width_slits_are_closed_along_their_whole_length() {
        let upright = |[x, _]: [i32; 2]| (12..15).contains(&x);
        let level = |[_, y]: [i32; 2]| (12..15).contains(&y);
        for way in [12, 13, 14] {
            for along in [4, 12, 19] {
                let depth = found(plane, upright, [way, along]).unwrap();
                assert!((depth - plane([way, along])).abs() < 1e-6, "{way}, {along}: {depth}");
                let depth = found(plane, level, [along, way]).unwrap();
                assert!((depth - plane([along, way])).abs() < 1e-6, "{along}, {way}: {depth}");
            }
        }
        // Nor is a strip between the surface and the border.
        let strip = |[x, _]: [i32; 2]| x > 29;
        assert_eq!(found(plane, strip, [30, 12]), None);
        // A notch that ends in the other direction is not a slit, and is open there.
        let notch = |[x, y]: [i32; 2]| x > 12 && (10..15).contains(&y);
        assert_eq!(found(plane, notch, [14, 12]), None);
    }

    #[test]
    fn specks_are_small_in_all_directions_and_get_the_surrounding_mean() {
        let specks = |is_open: &dyn Fn([i32; 2]) -> bool, y: i32, widest: i32| {
            let all = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
            let pixels: Vec<[u8; 4]> = all
                .map(|[x, y]| {
                    if is_open([x, y]) {
                        [0; 4]
                    } else {
                        [8 * x as u8, 9, 2 * y as u8, 255]
                    }
                })
                .collect();
            let drawn = Drawn {
                size: SIZE,
                pixels: &pixels,
                depths: &[],
                rim_px: 0,
            };
            drawn.specks_of_row([0.0; 3], y, widest)
        };
        let at = |x: usize, y: usize| SIZE[0] as usize * y + x;
        // The mean over a plane is its value at the centre.
        let two = |pixel| pixel == [10, 8] || pixel == [20, 8];
        assert_eq!(
            specks(&two, 8, 2),
            [(at(10, 8), [80, 9, 16, 255]), (at(20, 8), [160, 9, 16, 255])]
        );
        assert_eq!(specks(&two, 7, 2), []);
        assert_eq!(specks(&two, 8, 1), []);
        let pair = |pixel| pixel == [10, 8] || pixel == [11, 9];
        assert_eq!(specks(&pair, 8, 2), []);
        assert_eq!(specks(&pair, 8, 3), [(at(10, 8), [80, 9, 16, 255])]);
        let crack = |[x, y]: [i32; 2]| x == 10 && (5..12).contains(&y);
        assert_eq!(specks(&crack, 8, 3), []);
        assert_eq!(specks(&|pixel| pixel == [0, 8], 8, 3), []);
    }

    #[test]
    fn gaps_are_closed_at_the_image_border() {
        let at_border = |[x, y]: [i32; 2]| x < 3 && (10..13).contains(&y);
        let depth = found(plane, at_border, [0, 11]).unwrap();
        assert!((depth - plane([0, 11])).abs() < 0.01, "{depth}");
        // An empty image has no gaps, however small it is.
        assert_eq!(found(plane, |_| true, [0, 0]), None);
    }

    #[test]
    fn a_gap_between_two_objects_takes_the_farther_depth() {
        let two = |[x, _]: [i32; 2]| if x < 12 { 0.8 } else { 0.2 };
        let is_open = |[x, y]: [i32; 2]| (11..14).contains(&x) && (4..20).contains(&y);
        assert_eq!(
            found(two, |[x, y]| is_open([x, y]) && (10..13).contains(&y), [12, 11]),
            Some(0.2)
        );
        // Ends on the same object count, if the shortest line has them.
        let above = |[x, y]: [i32; 2]| if y < 12 && x < 20 { 0.8 } else { 0.2 };
        assert_eq!(
            found(above, |[x, y]| (10..12).contains(&x) && (9..12).contains(&y), [10, 10]),
            Some(0.8)
        );
    }
}
