//! The selection of the median as WGSL.
//!
//! Forgetful selection (McGuire 2008), step by step as in `rgbd/filters/median.rs`: of 14 values the smallest and the
//! largest are forgotten, one more is taken in, until three are left. It is written out here because every value must
//! stay in a register: an array whose places are numbers of a loop may come to lie in memory.

use crate::rgbd::filter_constants::{MEDIAN_REACH, MEDIAN_RETAINED};
use std::fmt::Write;

/// `center_of_window`: of the window whose first value is at a place of a tile of this edge.
pub(super) fn center_of_window() -> String {
    let width = 2 * MEDIAN_REACH + 1;
    let value = |next: usize| format!("window_value(corner + {}u * edge + {}u)", next / width, next % width);
    let mut code = "fn center_of_window(corner: u32, edge: u32) -> f32 {\n".to_owned();
    let mut next = 0;
    for place in 0..MEDIAN_RETAINED {
        line(&mut code, format_args!("var v{place} = {};", value(next)));
        next += 1;
    }
    line(&mut code, format_args!("var less = 0.0;"));
    for count in (4..=MEDIAN_RETAINED).rev() {
        forget(&mut code, count);
        line(&mut code, format_args!("v0 = {};", value(next)));
        next += 1;
    }
    debug_assert_eq!(next, width * width);
    forget(&mut code, 3);
    code + "    return v1;\n}\n"
}

/// Moves the smallest of the first values to their begin and the largest to their end.
fn forget(code: &mut String, count: usize) {
    for low in 0..count / 2 {
        exchange(code, low, count - 1 - low);
    }
    // The median of an odd count is in both halves.
    for place in 1..count.div_ceil(2) {
        exchange(code, 0, place);
    }
    for place in count / 2..count - 1 {
        exchange(code, place, count - 1);
    }
}

/// The smaller of two values to the first place.
fn exchange(code: &mut String, low: usize, high: usize) {
    line(
        code,
        format_args!("less = min(v{low}, v{high}); v{high} = max(v{low}, v{high}); v{low} = less;"),
    );
}

fn line(code: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = writeln!(code, "    {text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs the lines of the function on a window of numbers.
    fn run(code: &str, window: &[f32; 25]) -> f32 {
        let mut values = [0.0_f32; MEDIAN_RETAINED];
        let number = |text: &str| {
            text.trim_matches(|c: char| !c.is_ascii_digit())
                .parse::<usize>()
                .unwrap()
        };
        for line in code.lines().map(str::trim) {
            if let Some((to, place)) = line.split_once(" = window_value(corner + ") {
                let (row, column) = place.split_once(" * edge + ").unwrap();
                values[number(to)] = window[5 * number(row) + number(column)];
            } else if let Some(pair) = line.strip_prefix("less = min(") {
                let (low, rest) = pair.split_once(", ").unwrap();
                let (low, high) = (number(low), number(rest.split_once(')').unwrap().0));
                let (a, b) = (values[low], values[high]);
                (values[low], values[high]) = (a.min(b), a.max(b));
            }
        }
        values[1]
    }

    #[test]
    fn the_median_of_25_values_is_found() {
        let code = center_of_window();
        for step in [1_u32, 2, 3, 7, 11, 12, 19, 24] {
            let window: [f32; 25] = std::array::from_fn(|place| (place as u32 * step * step % 25) as f32);
            let mut sorted = window;
            sorted.sort_by(f32::total_cmp);
            assert_eq!(run(&code, &window), sorted[12], "{window:?}");
        }
    }
}
