//! Pairs whose disparities are known.

use super::*;
use crate::stereo::matching::costs::test_costs::Random;

const WIDTH: usize = 200;
const HEIGHT: usize = 120;

/// A texture without order, smooth between its knots, which are some pixels apart: brightness at any place.
struct Texture {
    knots: Vec<f32>,
}

const KNOTS: usize = 256;

impl Texture {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let knots = (0..KNOTS * KNOTS).map(|_| (random.next() % 256) as f32).collect();
        Self { knots }
    }

    /// Cubic, so that its slope has no steps.
    fn at(&self, x: f32, y: f32) -> f32 {
        let (x, y) = ((x + 100.0) / 2.5, (y + 100.0) / 2.5);
        let weights = |t: f32| {
            let s = 1.0 - t;
            [
                s * s * s / 6.0,
                (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
                t * t * t / 6.0,
            ]
        };
        let (column, row) = (x.floor(), y.floor());
        let (across, down) = (weights(x - column), weights(y - row));
        let mut sum = 0.0;
        for (j, down) in down.iter().enumerate() {
            for (i, across) in across.iter().enumerate() {
                let knot = ((row as usize + j) % KNOTS) * KNOTS + (column as usize + i) % KNOTS;
                sum += down * across * self.knots[knot];
            }
        }
        sum
    }
}

fn image(pixel: impl Fn(usize, usize) -> f32) -> GrayImage {
    let pixels = (0..WIDTH * HEIGHT)
        .map(|at| (pixel(at % WIDTH, at / WIDTH) + 0.5).clamp(0.0, 255.0) as u8)
        .collect();
    GrayImage::new([WIDTH as u32, HEIGHT as u32], pixels).unwrap()
}

/// A plane whose disparity is 12 + 0.05 x − 0.03 y of the left image, and its pair.
fn slanted_plane() -> (GrayImage, GrayImage, impl Fn(usize, usize) -> f32) {
    let disparity = |x: f32, y: f32| 12.0 + 0.05 * x - 0.03 * y;
    let texture = Texture::new(7);
    let left = image(|x, y| texture.at(x as f32, y as f32));
    // x′ = x − d(x, y) solved for x.
    let right = image(|x, y| texture.at((x as f32 + 12.0 - 0.03 * y as f32) / 0.95, y as f32));
    (left, right, move |x, y| disparity(x as f32, y as f32))
}

/// Number of pixels found, median and 95th percentile of their errors.
fn errors(map: &DisparityMap, truth: impl Fn(usize, usize) -> f32) -> (usize, f32, f32) {
    let found = map.pixels().iter().enumerate().filter(|(_, found)| !found.is_nan());
    let mut errors: Vec<f32> = found
        .map(|(at, found)| (found - truth(at % WIDTH, at / WIDTH)).abs())
        .collect();
    errors.sort_by(f32::total_cmp);
    let of = |share: usize| errors[(errors.len() - 1) * share / 100];
    (errors.len(), of(50), of(95))
}

fn range(min: i32, max: i32) -> DisparityRange {
    DisparityRange::new(min, max).unwrap()
}

#[test]
fn a_slanted_plane_is_found_to_a_tenth_of_a_pixel() {
    let (left, right, truth) = slanted_plane();
    let parabola = Matching {
        between: Between::Parabola,
        ..Matching::default()
    };
    for (matching, median_px, max_px) in [
        (Matching::default(), 0.04, 0.12),
        (parabola, 0.07, 0.15),
        (Matching::fast(), 0.04, 0.12),
    ] {
        let map = matching.disparities(&left, &right, range(0, 40)).unwrap();
        let (count, median, most) = errors(&map, &truth);
        // Pixels whose partners are inside the right image: a twelfth of the width are not.
        assert!(count * 100 >= 85 * WIDTH * HEIGHT, "{count} pixels by {matching:?}");
        assert!(
            median <= median_px && most <= max_px,
            "{median} and {most} px by {matching:?}"
        );
    }
}

/// Sums along paths alone would draw them to whole ones.
#[test]
fn subpixel_disparities_are_not_biased_towards_whole_pixels() {
    let texture = Texture::new(5);
    let left = image(|x, y| texture.at(x as f32, y as f32));
    for part in [0.0, 0.125, 0.25, 0.375, 0.5, 0.75] {
        let right = image(|x, y| texture.at(x as f32 + 8.0 + part, y as f32));
        for matching in [Matching::default(), Matching::fast()] {
            let map = matching.disparities(&left, &right, range(0, 31)).unwrap();
            let found = map.pixels().iter().filter(|found| !found.is_nan());
            let mean = found.clone().sum::<f32>() / found.count() as f32;
            assert!(
                (mean - 8.0 - part).abs() <= 0.02,
                "{part} became {mean} by {matching:?}"
            );
        }
    }
}

#[test]
fn negative_disparities_are_treated_like_others() {
    let texture = Texture::new(3);
    let left = image(|x, y| texture.at(x as f32, y as f32));
    let right = image(|x, y| texture.at(x as f32 - 5.25, y as f32));
    let map = Matching::default().disparities(&left, &right, range(-20, 3)).unwrap();
    let (count, median, most) = errors(&map, |_, _| -5.25);
    assert!(count * 10 >= 9 * WIDTH * HEIGHT, "{count}");
    assert!(median <= 0.1 && most <= 0.15, "{median} {most}");
}

/// A square 20 px before a wall at 4: the area to its left is seen by the left image alone.
#[test]
fn pixels_visible_in_one_image_only_have_no_disparity() {
    let (wall, front) = (Texture::new(1), Texture::new(2));
    let is_front = |x: f32, y: usize| (80.0..140.0).contains(&x) && (30..90).contains(&y);
    let left = image(|x, y| {
        let x = x as f32;
        if is_front(x, y) {
            front.at(x, y as f32)
        } else {
            wall.at(x, y as f32)
        }
    });
    let right = image(|x, y| {
        let at = x as f32 + 20.0;
        if is_front(at, y) {
            front.at(at, y as f32)
        } else {
            wall.at(x as f32 + 4.0, y as f32)
        }
    });
    for matching in [Matching::default(), Matching::fast()] {
        let map = matching.disparities(&left, &right, range(0, 31)).unwrap();
        let count = |columns: std::ops::Range<usize>, is_right: fn(f32) -> bool| {
            let pixels = (34..86).flat_map(|y| columns.clone().map(move |x| y * WIDTH + x));
            pixels.filter(|&at| is_right(map.pixels()[at])).count()
        };
        let hidden = 64..80;
        let inside = 86..134;
        let of_hidden = 52 * hidden.len();
        let of_inside = 52 * inside.len();
        let none = count(hidden, f32::is_nan);
        let front = count(inside, |found| (found - 20.0).abs() <= 0.1);
        assert!(
            none * 100 >= 80 * of_hidden,
            "{none} of {of_hidden} hidden ones by {matching:?}"
        );
        assert!(front * 100 >= 99 * of_inside, "{front} of {of_inside} by {matching:?}");
    }
}

#[test]
fn brightness_and_contrast_of_one_image_change_nothing() {
    let (left, right, truth) = slanted_plane();
    let dark: Vec<u8> = right.pixels().iter().map(|&value| 20 + value / 3).collect();
    let dark = GrayImage::new(right.size_px(), dark).unwrap();
    let map = Matching::default().disparities(&left, &dark, range(0, 40)).unwrap();
    let (count, median, most) = errors(&map, truth);
    assert!(count * 100 >= 85 * WIDTH * HEIGHT, "{count}");
    assert!(median <= 0.06 && most <= 0.2, "{median} {most}");
}

#[test]
fn a_uniform_image_has_no_disparity_anywhere() {
    let even = image(|_, _| 90.0);
    for matching in [Matching::default(), Matching::fast()] {
        let map = matching.disparities(&even, &even, range(0, 31)).unwrap();
        assert_eq!(map.found_count(), 0, "{matching:?}");
    }
}

#[test]
fn tiny_images_are_matched_without_errors() {
    for size in [[1, 1], [1, 9], [9, 1], [3, 2]] {
        let pixels = (0..size[0] * size[1]).map(|value| value as u8 * 9).collect();
        let image = GrayImage::new(size, pixels).unwrap();
        for matching in [Matching::default(), Matching::fast()] {
            for range in [range(0, 0), range(-500, -400), range(300, 900), range(-40, 40)] {
                let map = matching.disparities(&image, &image, range).unwrap();
                assert_eq!([map.width(), map.height()], size.map(|side| side as usize));
            }
        }
    }
}

#[test]
fn images_of_different_or_zero_size_are_reported() {
    let of = |size: [u32; 2]| GrayImage::new(size, vec![0; (size[0] * size[1]) as usize]);
    assert_eq!(of([0, 5]), None);
    let error = Matching::default()
        .disparities(&of([8, 5]).unwrap(), &of([8, 6]).unwrap(), range(0, 3))
        .unwrap_err();
    assert!(
        error.to_string().contains("8 × 5") && error.to_string().contains("8 × 6"),
        "{error}"
    );
    for (min, max) in [(5, 4), (0, i32::MAX), (i32::MIN, i32::MAX), (i32::MIN, i32::MIN)] {
        assert!(
            matches!(DisparityRange::new(min, max), Err(StereoError::NoRange { .. })),
            "{min} {max}"
        );
    }
}

#[test]
fn any_number_of_threads_finds_the_same_disparities() {
    let (left, right, _) = slanted_plane();
    for matching in [Matching::default(), Matching::fast()] {
        let of = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let map = pool.install(|| matching.disparities(&left, &right, range(0, 40)).unwrap());
            map.pixels()
                .iter()
                .map(|disparity| disparity.to_bits())
                .collect::<Vec<_>>()
        };
        let one = of(1);
        assert!(of(2) == one && of(5) == one, "{matching:?}");
    }
}
