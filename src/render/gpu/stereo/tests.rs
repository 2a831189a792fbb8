//! Pairs matched by the card beside the processor's answers, and sums beside their definition.

use super::passes::SUMS;
use super::*;
use crate::render::gpu::context::ContextOptions;
use crate::stereo::Penalties;
use crate::stereo::constants::{CENSUS_HALF_HEIGHT, CENSUS_HALF_WIDTH};
use std::fmt::Write;
use std::sync::LazyLock;
use wgpu::BufferUsages as Usages;

/// Sizes: a pixel, lines, odd ones, whole workgroups.
const SIZES: [[u32; 2]; 7] = [[1, 1], [9, 1], [1, 7], [5, 40], [33, 17], [47, 31], [128, 128]];

/// Ranges: none below 0, some, all, and none of the image's.
const RANGES: [[i32; 2]; 5] = [[0, 63], [-20, 43], [-3, 60], [-500, -440], [30, 300]];

static CONTEXT: LazyLock<Arc<Context>> = LazyLock::new(context);

fn context() -> Arc<Context> {
    let options = ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    };
    Context::headless(&options).unwrap()
}

/// A number of a place, without order.
fn random(x: i64, y: i64, seed: u64) -> u8 {
    let mut bits = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).rotate_left(32) ^ seed.rotate_left(17);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 56) as u8
}

/// A texture of knots that are some pixels apart.
fn texture(x: f32, y: f32, seed: u64) -> f32 {
    let knot = |x: f32, y: f32| f32::from(random(x as i64, y as i64, seed));
    let (x, y) = (x / 2.5, y / 2.5);
    let (s, t) = (x - x.floor(), y - y.floor());
    let line = |y: f32| knot(x.floor(), y) * (1.0 - s) + knot(x.floor() + 1.0, y) * s;
    line(y.floor()) * (1.0 - t) + line(y.floor() + 1.0) * t
}

fn image([width, height]: [u32; 2], pixel: impl Fn(u32, u32) -> u8) -> GrayImage {
    let pixels = (0..width * height).map(|at| pixel(at % width, at / width)).collect();
    GrayImage::new([width, height], pixels).unwrap()
}

/// Pairs that have nothing, little and much in common.
fn pairs(size: [u32; 2], seed: u64) -> Vec<(&'static str, [GrayImage; 2])> {
    let noise = |seed, levels: u8| image(size, |x, y| random(x.into(), y.into(), seed) % levels);
    // A slanted wall, and a square before it whose texture is fine.
    let is_front = |x: f32, y: u32| x >= 40.0 && x < 80.0 && (20..90).contains(&y);
    let left = image(size, |x, y| {
        let place = if is_front(x as f32, y) { 3.0 } else { 1.0 };
        texture(x as f32 * place, y as f32 * place, seed) as u8
    });
    let right = image(size, |x, y| {
        let front = x as f32 + 20.5;
        let back = (x as f32 + 4.0 - 0.03 * y as f32) / 0.95;
        let (place, x) = if is_front(front, y) { (3.0, front) } else { (1.0, back) };
        texture(x * place, y as f32 * place, seed) as u8
    });
    // Stripes that are as good everywhere, with an even part.
    let stripes = |shift: u32| {
        image(
            size,
            move |x, y| if y % 32 < 12 { 77 } else { ((x + shift) % 6 * 40) as u8 },
        )
    };
    vec![
        ("noise", [noise(seed, 255), noise(seed + 1, 255)]),
        ("few levels", [noise(seed, 3), noise(seed + 1, 3)]),
        ("one image twice", [noise(seed, 255), noise(seed, 255)]),
        ("walls", [left, right]),
        ("stripes", [stripes(0), stripes(2)]),
    ]
}

fn all_matchings() -> Vec<Matching> {
    let narrow = Penalties {
        p1: 3,
        p2: 61,
        p2_least: 9,
        half_change: 0,
    };
    let gatherings = [
        Gathering::SemiGlobal(Penalties::default()),
        Gathering::SemiGlobal(narrow),
        Gathering::Local { radius_px: 3 },
        Gathering::Local { radius_px: 0 },
        Gathering::Local { radius_px: 99 },
    ];
    let between = [Between::Lines, Between::Parabola];
    let all = gatherings.into_iter().enumerate().flat_map(|(number, gathering)| {
        between.map(|between| Matching {
            gathering,
            between,
            // Whatever differs is to be seen, and what is usual as well.
            unique_percent: [3, 0, 5, 0, 0][number],
            least_area_px: [100, 0, 0, 0, 0][number],
        })
    });
    all.collect()
}

fn range([min, max]: [i32; 2]) -> DisparityRange {
    DisparityRange::new(min, max).unwrap()
}

/// How many pixels have a disparity, and the largest difference to the processor's.
fn compare(
    matcher: &CardMatcher,
    matching: &Matching,
    [left, right]: &[GrayImage; 2],
    range: DisparityRange,
) -> (usize, f32) {
    let found = matcher
        .on_card(matching, [left, right], range)
        .unwrap()
        .expect("a pair for the card");
    let found = matching.without_specks([left.width(), left.height()], found);
    let expected = matching.disparities(left, right, range).unwrap();
    let mut most = 0.0_f32;
    for (at, (found, expected)) in found.pixels().iter().zip(expected.pixels()).enumerate() {
        assert_eq!(
            found.is_nan(),
            expected.is_nan(),
            "pixel {at} of {:?}: {found}, not {expected}; {matching:?} {range:?}",
            left.size_px()
        );
        if !found.is_nan() {
            most = most.max((found - expected).abs());
        }
    }
    (expected.found_count(), most)
}

#[test]
fn disparities_are_those_of_the_processor() {
    let matcher = CardMatcher::new(Arc::clone(&CONTEXT));
    let mut found = String::new();
    for (number, size) in SIZES.into_iter().enumerate() {
        for (name, pair) in pairs(size, 7 + number as u64) {
            for matching in all_matchings() {
                for ends in RANGES {
                    let (count, most) = compare(&matcher, &matching, &pair, range(ends));
                    // Places by a parabola are quotients of whole numbers.
                    let allowed = if matching.between == Between::Lines { 1e-3 } else { 0.0 };
                    assert!(
                        most <= allowed,
                        "{most} px in {name} of {size:?}, {matching:?}, {ends:?}"
                    );
                    if size == [128, 128] && count * 2 > 128 * 128 {
                        write!(found, " {name}").unwrap();
                    }
                }
            }
        }
    }
    // Where nothing is found nothing can differ.
    assert!(found.contains("walls") && found.contains("one image twice"), "{found}");
}
