//! Letters of straight strokes, for the few words in images: drawn at any size, without a font.

/// A stroke from one place to another.
pub(super) type Stroke = [[f32; 2]; 2];

/// Height of digits, in the units of [`glyph`].
const HEIGHT: f32 = 6.0;

/// Between two letters, in the same units.
const GAP: f32 = 1.6;

/// The polylines of a letter: digits are x and y, from the left and from the top; the lower edge of digits is at 6. And
/// how wide it is.
fn glyph(letter: char) -> (&'static [&'static str], f32) {
    match letter {
        '0' => (&["10 30 41 45 36 16 05 01 10"], 4.0),
        '1' => (&["01 20 26"], 2.4),
        '2' => (&["01 10 30 41 42 06 46"], 4.0),
        '3' => (&["01 10 30 41 42 33 13", "33 44 45 36 16 05"], 4.0),
        '4' => (&["36 30 04 44"], 4.0),
        '5' => (&["40 00 03 33 44 45 36 16 05"], 4.0),
        '6' => (&["30 10 02 05 16 36 45 44 33 13 04"], 4.0),
        '7' => (&["00 40 16"], 4.0),
        '8' => (&["10 30 41 42 33 13 02 01 10", "33 44 45 36 16 05 04 13"], 4.0),
        '9' => (&["16 36 44 41 30 10 01 02 13 33 42"], 4.0),
        '.' => (&["06 06"], 0.4),
        '-' => (&["04 34"], 3.0),
        'c' => (&["43 32 12 03 05 16 36 45"], 4.0),
        'e' => (&["04 44 43 32 12 03 05 16 36 45"], 4.0),
        'f' => (&["40 30 21 26", "03 43"], 4.0),
        'i' => (&["02 06", "00 00"], 0.4),
        'k' => (&["00 06", "42 04", "14 46"], 4.0),
        'm' => (&["02 06", "03 12 22 33 36", "33 42 52 63 66"], 6.0),
        'n' => (&["02 06", "03 12 32 43 46"], 4.0),
        's' => (&["43 32 12 03 14 34 45 36 16 05"], 4.0),
        't' => (&["10 15 26 36", "02 32"], 3.2),
        'u' => (&["02 05 16 36 45", "42 46"], 4.0),
        'U' => (&["00 05 16 36 45 40"], 4.0),
        'S' => (&["41 30 10 01 02 13 33 44 45 36 16 05"], 4.0),
        'µ' => (&["02 08", "05 16 36 45", "42 46"], 4.0),
        _ => (&[], 2.0),
    }
}

/// The strokes of a text whose digits are `height` high, from its upper left corner; and how wide it is.
pub(super) fn text_strokes(text: &str, height: f32) -> (Vec<Stroke>, f32) {
    let unit = height / HEIGHT;
    let (mut strokes, mut left) = (Vec::new(), 0.0);
    for letter in text.chars() {
        let (lines, width) = glyph(letter);
        for line in lines {
            let places: Vec<[f32; 2]> = line
                .split(' ')
                .map(|place| place_of(place).map(|edge| edge * unit))
                .map(|[x, y]| [x + left, y])
                .collect();
            strokes.extend(places.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        left += (width + GAP) * unit;
    }
    (strokes, (left - GAP * unit).max(0.0))
}

/// Returns the position encoded by two digits.
fn place_of(digits: &str) -> [f32; 2] {
    let mut numbers = digits.bytes().map(|digit| f32::from(digit - b'0'));
    [0; 2].map(|_| numbers.next().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_of_a_scale_bar_exists_and_fits_its_width() {
        for letter in "0123456789.-cefikmnstuUSµ".chars() {
            let (strokes, width) = text_strokes(&letter.to_string(), 6.0);
            assert!(!strokes.is_empty(), "{letter}");
            let is_inside = |[x, y]: [f32; 2]| (0.0..=width + 0.61).contains(&x) && (0.0..=8.0).contains(&y);
            assert!(strokes.iter().flatten().all(|&place| is_inside(place)), "{letter}");
        }
        let (strokes, width) = text_strokes("1 m", 12.0);
        // 2.4, a gap, a space of 2, a gap and 6, scaled by two.
        assert!((width - 2.0 * (2.4 + 1.6 + 2.0 + 1.6 + 6.0)).abs() < 1e-4, "{width}");
        assert!(strokes.iter().flatten().any(|place| place[0] > 20.0));
    }
}
