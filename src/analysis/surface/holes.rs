//! Gaps of Voronoi cells narrower than the angle between the directions along which [`super::radii`] measures.
//!
//! How it works: the inverse distance to the end of a cell is the largest of the `w·d`, one for each line. Along a
//! single line it is a sinusoid, so `h' − 2 cos δ h + 'h` of the inverse distances in three directions δ apart is 0;
//! where another line takes over it is the surplus of the next value over the first line, continued. Let these
//! surpluses be `a` and `b` at two neighbouring directions, with inverse distances `g` and `h`. The line that ends the
//! cell before the first, continued beyond it, and the line that ends the cell after the second, continued backwards,
//! then meet along `a` times the first direction plus `b` times the second, as `w·d` is linear in `d`, and there (times
//! the length of that sum) the inverse distance is `a g + b (h − a)`. No line makes it less; if it is next to nothing,
//! and stays so when all lines are asked, the cell is open there.
//!
//! When it wins: over more directions, which are never enough for a row of points, whose cells are strips between two
//! parallel lines.

use super::directions::{DIRECTIONS, QUARTER};
use crate::analysis::search::point_tree::LaneRow;

/// Share of the inverse distance to the last neighbour below which a cell is open between two directions.
///
/// Much less than along a direction: one in two hundred points scattered on a surface has a sharp corner twice as far
/// out as the last neighbour. It is not a gap, and the point may be left with a near duplicate only if it does not
/// count.
pub(super) const OPEN_BETWEEN: f32 = 1.0 / 64.0;

/// Twice the cosine of δ, a 32nd of a turn.
pub(super) const TWICE_COSINE: f32 = 1.961_570_6;

/// Sets to 0 the inverse distances next to a gap between two directions, in the inverse distances of eight cells to
/// their ends. `known` are the inverse distances to the last neighbours, `lines` the `w` of all. To be called where
/// there may be a gap, which is rare.
#[cold]
pub(super) fn set_open(
    quarter_circle: &[[f32; 2]; QUARTER],
    lines: &[[LaneRow; 2]],
    known: LaneRow,
    inverse: &mut [LaneRow; DIRECTIONS],
) {
    for (lane, known) in known.into_iter().enumerate() {
        set_open_in_lane(quarter_circle, lines, OPEN_BETWEEN * known, inverse, lane);
    }
}

fn set_open_in_lane(
    quarter_circle: &[[f32; 2]; QUARTER],
    lines: &[[LaneRow; 2]],
    open: f32,
    inverse: &mut [LaneRow; DIRECTIONS],
    lane: usize,
) {
    let distances: [f32; DIRECTIONS] = inverse.map(|row| row[lane]);
    let at = |direction: usize| distances[direction % DIRECTIONS];
    // Negative only because of rounding.
    let surplus = |direction: usize| {
        let continued = TWICE_COSINE * at(direction) - at(direction + DIRECTIONS - 1);
        (at(direction + 1) - continued).max(0.0)
    };
    for direction in 0..DIRECTIONS {
        let (first, second) = (surplus(direction), surplus(direction + 1));
        let meeting = first * (at(direction) - open) + second * (at(direction + 1) - open - first);
        if meeting >= 0.0 {
            continue;
        }
        let [x, y] = cosine_and_sine(quarter_circle, direction);
        let [next_x, next_y] = cosine_and_sine(quarter_circle, direction + 1);
        let (x, y) = (first * x + second * next_x, first * y + second * next_y);
        let along = lines.iter().map(|line| line[0][lane] * x + line[1][lane] * y);
        if along.fold(0.0, f32::max) < open * x.hypot(y) {
            inverse[direction][lane] = 0.0;
            inverse[(direction + 1) % DIRECTIONS][lane] = 0.0;
        }
    }
}

/// Returns the cosine and sine of any direction, from one quarter of the circle.
fn cosine_and_sine(quarter_circle: &[[f32; 2]; QUARTER], direction: usize) -> [f32; 2] {
    let quarter = QUARTER - 1;
    let [cosine, sine] = quarter_circle[direction % quarter];
    match direction / quarter % 4 {
        0 => [cosine, sine],
        1 => [-sine, cosine],
        2 => [-cosine, -sine],
        _ => [sine, -cosine],
    }
}

#[cfg(test)]
mod tests {
    use super::super::directions::quarter_circle;
    use super::*;
    use crate::analysis::search::point_tree::LANES;
    use std::f32::consts::TAU;

    /// The inverse distances of a cell, before and after gaps are cleared.
    fn measure(lines: &[[f32; 2]]) -> [[f32; DIRECTIONS]; 2] {
        let circle = quarter_circle();
        let inverse: [f32; DIRECTIONS] = std::array::from_fn(|direction| {
            let [x, y] = cosine_and_sine(&circle, direction);
            let along = lines.iter().map(|line| line[0] * x + line[1] * y);
            along.fold(0.0, f32::max)
        });
        let rows: Vec<[LaneRow; 2]> = lines.iter().map(|line| line.map(|w| [w; LANES])).collect();
        let mut left = inverse.map(|distance| [distance; LANES]);
        set_open(&circle, &rows, [1.0; LANES], &mut left);
        assert!(left.iter().all(|row| *row == [row[0]; LANES]));
        [inverse, left.map(|row| row[0])]
    }

    fn line(turn: f32, w: f32) -> [f32; 2] {
        let (sine, cosine) = (turn * TAU).sin_cos();
        [w * cosine, w * sine]
    }

    #[test]
    fn the_constant_is_twice_the_cosine_of_a_step() {
        assert!((TWICE_COSINE - 2.0 * quarter_circle()[1][0]).abs() < 2e-7);
    }

    #[test]
    fn directions_cover_the_circle() {
        for direction in 0..2 * DIRECTIONS {
            let [cosine, sine] = cosine_and_sine(&quarter_circle(), direction);
            let [x, y] = line(direction as f32 / DIRECTIONS as f32, 1.0);
            assert!((cosine - x).abs() < 1e-5 && (sine - y).abs() < 1e-5);
        }
    }

    #[test]
    fn strips_are_open_only_at_both_ends() {
        for step in 0..50 {
            let turn = step as f32 / 50.0;
            for widths in [[6.0, 6.0], [6.0, 1.5]] {
                let strip = [line(turn, widths[0]), line(turn + 0.5, widths[1])];
                let [before, after] = measure(&strip);
                let open = (0..DIRECTIONS).filter(|&direction| after[direction] < 0.1);
                for direction in open.clone() {
                    let across = (direction as f32 / DIRECTIONS as f32 - turn) * TAU;
                    // At most two steps off: a direction nearly along the strip has both sides of it next to it.
                    assert!(across.cos().abs() < 0.39, "{direction} at {turn}");
                }
                assert!(open.count() >= 4, "both ends of {turn}");
                let retained = before.iter().zip(after).filter(|(a, b)| **a == *b).count();
                assert!(retained >= DIRECTIONS - 6);
            }
        }
    }

    #[test]
    fn closed_cells_are_unchanged() {
        for step in 0..50 {
            let turn = step as f32 / 50.0;
            // A square, a triangle, a long rectangle, and a half-plane with a far corner.
            let cells: [&[(f32, f32)]; 4] = [
                &[(0.0, 2.0), (0.25, 2.0), (0.5, 2.0), (0.75, 2.0)],
                &[(0.0, 2.0), (0.33, 3.0), (0.66, 2.0)],
                &[(0.0, 9.0), (0.25, 0.5), (0.5, 9.0), (0.75, 0.5)],
                &[(0.0, 100.0), (0.3, 1.5), (0.7, 2.0)],
            ];
            for cell in cells {
                let lines: Vec<[f32; 2]> = cell.iter().map(|&(at, w)| line(turn + at, w)).collect();
                let [before, after] = measure(&lines);
                assert_eq!(before, after, "{cell:?} at {turn}");
            }
        }
    }
}
