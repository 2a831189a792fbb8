//! Scan conversion of polygons: the pixels of a row that a polygon covers.
//!
//! A pixel is covered where its centre is inside. Where an edge meets the pixel centres of a row follows from its two
//! ends alone, taken in one order, so the polygons on both sides of it get the same number, bit by bit: a span that
//! ends there on the left begins there on the right. So surfaces have neither holes nor pixels drawn twice along their
//! edges, regardless of rounding; a closed mesh lets nothing shine through.

use super::view::PixelRect;
use std::ops::Range;

/// Calls `visit` with each row of `clip`, and those of its columns, whose pixel centres a convex polygon covers.
/// Corners are given in pixels, in their order around it. Centres on the left and the upper border are covered, centres
/// on the right and the lower one are not.
#[inline(always)]
pub(super) fn for_each_span(corners: &[[f64; 2]], clip: PixelRect, mut visit: impl FnMut(i32, Range<i32>)) {
    let (mut top, mut bottom) = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in corners {
        top = top.min(corner[1]);
        bottom = bottom.max(corner[1]);
    }
    let rows = first_center(top).max(clip.start[1])..first_center(bottom).min(clip.end[1]);
    for y in rows {
        let center = f64::from(y) + 0.5;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for (index, &start) in corners.iter().enumerate() {
            let end = corners[(index + 1) % corners.len()];
            if (start[1] <= center) != (end[1] <= center) {
                let x = crossing(start, end, center);
                left = left.min(x);
                right = right.max(x);
            }
        }
        let columns = first_center(left).max(clip.start[0])..first_center(right).min(clip.end[0]);
        if !columns.is_empty() {
            visit(y, columns);
        }
    }
}

/// Returns the first pixel whose centre is not before a position.
#[inline(always)]
fn first_center(place: f64) -> i32 {
    (place - 0.5).ceil() as i32
}

/// Returns the intersection of `y` with the line between two positions, one above `y` and one not: the same whichever
/// is first.
#[inline(always)]
fn crossing(start: [f64; 2], end: [f64; 2], y: f64) -> f64 {
    let [upper, lower] = if start[1] <= end[1] { [start, end] } else { [end, start] };
    upper[0] + (y - upper[1]) * ((lower[0] - upper[0]) / (lower[1] - upper[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EDGE: i32 = 24;

    fn covered(corners: &[[f64; 2]]) -> Vec<[i32; 2]> {
        let clip = PixelRect {
            start: [0; 2],
            end: [EDGE; 2],
        };
        let mut pixels = Vec::new();
        for_each_span(corners, clip, |y, columns| pixels.extend(columns.map(|x| [x, y])));
        pixels
    }

    /// Twice the area of a triangle, with the sign of its turn.
    fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    proptest! {
        #[test]
        fn pixels_are_covered_where_their_centers_are_inside(
            corners in prop::array::uniform3(prop::array::uniform2(-8f64..32.0)),
        ) {
            prop_assume!(doubled_area(corners).abs() > 1e-3);
            let found = covered(&corners);
            for x in 0..EDGE {
                for y in 0..EDGE {
                    let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                    let sides = [0, 1, 2].map(|side| {
                        doubled_area([corners[side], corners[(side + 1) % 3], center]) * doubled_area(corners).signum()
                    });
                    let nearest = sides.into_iter().fold(f64::INFINITY, f64::min);
                    // On the border rounding decides.
                    if nearest.abs() > 1e-9 {
                        prop_assert_eq!(found.contains(&[x, y]), nearest > 0.0);
                    }
                }
            }
        }

        /// A fan of triangles around a place covers each pixel of its outline once, on any grid of corners.
        #[test]
        fn triangles_around_a_corner_leave_no_hole_and_do_not_overlap(
            center in prop::array::uniform2(8f64..16.0),
            steps in 1f64..64.0,
            rim in prop::collection::vec(0f64..1.0, 3..9),
        ) {
            let on_grid = |place: f64| (place * steps).round() / steps;
            let center = center.map(on_grid);
            let mut turns = rim;
            turns.sort_by(f64::total_cmp);
            let outline: Vec<[f64; 2]> = turns
                .iter()
                .map(|turn| {
                    let (sine, cosine) = (turn * std::f64::consts::TAU).sin_cos();
                    [on_grid(center[0] + 7.0 * cosine), on_grid(center[1] + 7.0 * sine)]
                })
                .collect();
            let mut fan = Vec::new();
            for (index, &start) in outline.iter().enumerate() {
                let corners = [center, start, outline[(index + 1) % outline.len()]];
                // The fan goes once around the corner, without folds.
                prop_assume!(doubled_area(corners) >= 0.0);
                fan.extend(covered(&corners));
            }
            fan.sort_unstable();
            let count = fan.len();
            fan.dedup();
            prop_assert_eq!(fan.len(), count, "drawn twice");
            for x in 0..EDGE {
                for y in 0..EDGE {
                    let place = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                    let is_inside = (0..outline.len()).all(|index| {
                        doubled_area([outline[index], outline[(index + 1) % outline.len()], place]) > 1e-9
                    });
                    prop_assert!(!is_inside || fan.contains(&[x, y]), "a hole at {x} {y}");
                }
            }
        }
    }

    #[test]
    fn nan_and_zero_area_triangles_cover_nothing() {
        assert!(covered(&[[f64::NAN; 2]; 3]).is_empty());
        assert!(covered(&[[1.0, 1.0], [9.0, 1.0], [20.0, 1.0]]).is_empty());
        assert!(covered(&[[4.0, 1.0], [4.0, 9.0], [4.0, 20.0]]).is_empty());
        // Borders: the left and the upper one are included.
        let square = covered(&[[0.5, 0.5], [2.5, 0.5], [2.5, 2.5], [0.5, 2.5]]);
        assert_eq!(square, [[0, 0], [1, 0], [0, 1], [1, 1]]);
    }
}
