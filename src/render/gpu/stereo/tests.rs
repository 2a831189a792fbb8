//! Pairs matched by the GPU compared with the CPU's answers, and sums with their definition.

use super::passes::SUMS;
use super::*;
use crate::render::gpu::context::ContextOptions;
use crate::stereo::Penalties;
use crate::stereo::matching::constants::{CENSUS_HALF_HEIGHT, CENSUS_HALF_WIDTH};
use std::sync::LazyLock;
use wgpu::BufferUsages as Usages;

/// Sizes: a pixel, lines, odd ones, whole workgroups.
const SIZES: [[u32; 2]; 7] = [[1, 1], [9, 1], [1, 7], [5, 40], [33, 17], [47, 31], [128, 128]];

/// Ranges: none below 0, some, all, and none of the image's.
const RANGES: [[i32; 2]; 5] = [[0, 63], [-20, 43], [-3, 60], [-500, -440], [30, 300]];

/// Larger images are matched in fewer modes.
const MAX_SMALL_PIXELS: u32 = 2000;

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
    // A slanted wall, and a square in front of it with a fine texture.
    let is_front = |x: f32, y: u32| (40.0..80.0).contains(&x) && (20..90).contains(&y);
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
    // Stripes that match equally well at several places, with a textureless part.
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
        p2_min: 9,
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
            // Covers both the options that differ and the default values.
            unique_percent: [3, 0, 5, 0, 0][number],
            min_area_px: [100, 0, 0, 0, 0][number],
        })
    });
    all.collect()
}

fn range([min, max]: [i32; 2]) -> DisparityRange {
    DisparityRange::new(min, max).unwrap()
}

/// The number of pixels with a disparity, and the largest difference from the CPU's.
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

/// The pairs of a size that are worth their time: large ones are slow on an adapter without a GPU.
fn pairs_of(size: [u32; 2], seed: u64) -> Vec<(&'static str, [GrayImage; 2])> {
    let mut pairs = pairs(size, seed);
    if size[0] * size[1] > MAX_SMALL_PIXELS {
        pairs.retain(|(name, _)| ["walls", "one image twice"].contains(name));
    }
    pairs
}

#[test]
fn disparities_match_the_cpu() {
    let matcher = CardMatcher::new(Arc::clone(&CONTEXT));
    let mut found = [0; 2];
    for (number, size) in SIZES.into_iter().enumerate() {
        let is_small = size[0] * size[1] <= MAX_SMALL_PIXELS;
        for (name, pair) in pairs_of(size, 7 + number as u64) {
            for matching in all_matchings() {
                for &ends in if is_small { &RANGES[..] } else { &RANGES[1..2] } {
                    let (count, most) = compare(&matcher, &matching, &pair, range(ends));
                    let by_lines = matching.between == Between::Lines;
                    // Positions from a parabola are quotients of integers.
                    let allowed = if by_lines { 1e-3 } else { 0.0 };
                    assert!(
                        most <= allowed,
                        "{most} px in {name} of {size:?}, {matching:?}, {ends:?}"
                    );
                    if !is_small {
                        found[usize::from(by_lines)] += count;
                    }
                }
            }
        }
    }
    // Where nothing is found nothing can differ: for two pairs and five cost aggregations, at least half of the pixels
    // must be found.
    let pixels = 10 * 128 * 128;
    assert!(found.iter().all(|&count| 2 * count >= pixels), "{found:?} of {pixels}");
}

/// The bits that differ between a pixel and a partner, which is one of the border where there is none.
fn cost_by_definition([left, right]: [&GrayImage; 2], [x, y]: [i64; 2], partner: i64) -> u32 {
    let size = left.size_px().map(i64::from);
    let at = |image: &GrayImage, x: i64, y: i64| {
        let x = x.clamp(0, size[0] - 1);
        image.pixels()[(y.clamp(0, size[1] - 1) * size[0] + x) as usize]
    };
    let partner = partner.clamp(0, size[0] - 1);
    let (across, down) = (CENSUS_HALF_WIDTH as i64, CENSUS_HALF_HEIGHT as i64);
    let around = (-down..=down).flat_map(|dy| (-across..=across).map(move |dx| [dx, dy]));
    let differs = |[dx, dy]: [i64; 2]| {
        let is_darker = |image, x| at(image, x + dx, y + dy) < at(image, x, y);
        is_darker(left, x) != is_darker(right, partner)
    };
    around.filter(|&aside| differs(aside)).count() as u32
}

/// Sums along eight paths, each on its own.
fn sums_along_paths(costs: &[u32], guide: &GrayImage, count: usize, penalties: Penalties) -> Vec<u32> {
    let [width, height] = guide.size_px().map(|edge| edge as usize);
    let mut sums = vec![0; costs.len()];
    for [dx, dy] in PATH_STEPS {
        let mut path = vec![0_u32; costs.len()];
        for place in 0..width * height {
            let [x, y] = [place % width, place / width];
            // From the side where the path starts.
            let x = if dx < 0 { width - 1 - x } else { x };
            let y = if dy < 0 { height - 1 - y } else { y };
            let at = y * width + x;
            let from_x = x.checked_add_signed(-dx as isize).filter(|&x| x < width);
            let from_y = y.checked_add_signed(-dy as isize).filter(|&y| y < height);
            let from = from_x.zip(from_y).map(|(x, y)| y * width + x);
            let before: Option<Vec<u32>> = from.map(|from| path[from * count..(from + 1) * count].to_vec());
            for label in 0..count {
                let mut best = 0;
                if let (Some(before), Some(from)) = (&before, from) {
                    let change = u32::from(guide.pixels()[from].abs_diff(guide.pixels()[at]));
                    let half = u32::from(penalties.half_change.max(1));
                    let above = u32::from(penalties.p2 - penalties.p2_min) * half / (half + change);
                    let least = before.iter().copied().min().unwrap();
                    let beside = [label.wrapping_sub(1), label + 1];
                    let near = beside.iter().filter_map(|&label| before.get(label)).min().unwrap();
                    best = before[label].min(near + u32::from(penalties.p1));
                    best = best.min(least + u32::from(penalties.p2_min) + above) - least;
                }
                path[at * count + label] = costs[at * count + label] + best;
            }
        }
        for (sum, path) in sums.iter_mut().zip(path) {
            *sum += path;
        }
    }
    sums
}

fn sums_over_squares(costs: &[u32], size: [u32; 2], count: usize, radius: i64) -> Vec<u32> {
    let [width, height] = size.map(i64::from);
    let mut sums = vec![0; costs.len()];
    for (index, sum) in sums.iter_mut().enumerate() {
        let (at, label) = ((index / count) as i64, index % count);
        for down in -radius..=radius {
            for across in -radius..=radius {
                let x = (at % width + across).clamp(0, width - 1);
                let y = (at / width + down).clamp(0, height - 1);
                *sum += costs[(y * width + x) as usize * count + label];
            }
        }
    }
    sums
}

/// The sums of all labels on the GPU.
fn sums_on_card(matching: &Matching, images: [&GrayImage; 2], range: DisparityRange) -> Vec<u32> {
    let context = &*CONTEXT;
    let job = Job::of(context, matching, images, range).unwrap();
    let scratch = Scratch::of(context, None, job.sizes).unwrap();
    job.run(context, &Programs::new(context), &scratch).unwrap();
    let sums = scratch.bound(SUMS);
    let readable = context.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: sums.size(),
        usage: Usages::MAP_READ | Usages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = context
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(sums, 0, &readable, 0, readable.size());
    context.queue.submit([encoder.finish()]);
    let sums: Vec<u16> = map_and_read(context, &readable, bytemuck::pod_collect_to_vec).unwrap();
    sums.into_iter().map(u32::from).collect()
}

#[test]
fn sums_are_those_of_the_definition_to_the_bit() {
    for (size, ends) in [([1, 1], [0, 31]), ([5, 40], [-7, 24]), ([33, 17], [-40, 30])] {
        let range = range(ends);
        let count = range.count();
        for (name, [left, right]) in &pairs(size, 3) {
            let costs = (0..left.pixels().len() * count).map(|index| {
                let (at, label) = ((index / count) as i64, (index % count) as i64);
                let [x, y] = [at % i64::from(size[0]), at / i64::from(size[0])];
                cost_by_definition([left, right], [x, y], x - i64::from(range.min()) - label)
            });
            let costs: Vec<u32> = costs.collect();
            for matching in all_matchings().into_iter().step_by(2) {
                let expected = match matching.gathering {
                    Gathering::SemiGlobal(penalties) => sums_along_paths(&costs, left, count, penalties),
                    Gathering::Local { radius_px } => sums_over_squares(&costs, size, count, radius_px.min(15) as i64),
                };
                let found = sums_on_card(&matching, [left, right], range);
                let differs = found
                    .iter()
                    .zip(&expected)
                    .position(|(found, expected)| found != expected);
                assert_eq!(differs, None, "{name} of {size:?}, {matching:?}");
            }
        }
    }
}

/// Bits of the CPU's disparities and of a matcher's.
fn bits_of_both(matcher: &CardMatcher, matching: &Matching, [left, right]: &[GrayImage; 2]) -> [Vec<u32>; 2] {
    let bits = |map: DisparityMap| map.pixels().iter().map(|found| found.to_bits()).collect();
    let by_card = matcher.disparities(matching, left, right, range([0, 40])).unwrap();
    let by_processor = matching.disparities(left, right, range([0, 40])).unwrap();
    [bits(by_card), bits(by_processor)]
}

#[test]
fn the_cpu_takes_over_where_the_gpu_fails() {
    let (_, pair) = pairs([90, 50], 5).swap_remove(3);
    let matching = Matching::default();
    let context = context();
    let matcher = CardMatcher::new(Arc::clone(&context));
    context.simulate_out_of_memory(1);
    let [found, expected] = bits_of_both(&matcher, &matching, &pair);
    assert!(found == expected && lock(&matcher.on_card).has_warned);
    let is_cached = || lock(&matcher.on_card).scratch.is_some();
    assert!(!is_cached());
    compare(&matcher, &matching, &pair, range([0, 40]));
    assert!(is_cached(), "there is memory again");
    context.simulate_loss();
    let [found, expected] = bits_of_both(&matcher, &matching, &pair);
    assert_eq!(found, expected);
}

#[test]
fn pairs_unsuitable_for_the_gpu_are_errors_or_matched_by_the_cpu() {
    let matcher = CardMatcher::new(Arc::clone(&CONTEXT));
    let image = image([60, 20], |x, y| random(x.into(), y.into(), 1));
    let smaller = GrayImage::new([60, 19], image.pixels()[60..].to_vec()).unwrap();
    let told = |matching: &Matching, right: &GrayImage| {
        matcher
            .disparities(matching, &image, right, range([0, 31]))
            .unwrap_err()
    };
    let error = told(&Matching::default(), &smaller);
    assert!(matches!(error, StereoError::SizesDiffer { .. }), "{error}");
    let wrong = Matching {
        gathering: Gathering::SemiGlobal(Penalties {
            p1: 9,
            p2_min: 8,
            ..Penalties::default()
        }),
        ..Matching::default()
    };
    let error = told(&wrong, &image);
    assert!(matches!(error, StereoError::NoPenalties { .. }), "{error}");
    for (ends, is_for_card) in [([-256, 255], true), ([-256, 256], false)] {
        let job = Job::of(&CONTEXT, &Matching::default(), [&image, &image], range(ends));
        assert_eq!(job.is_some(), is_for_card, "{ends:?}");
        let map = matcher
            .disparities(&Matching::default(), &image, &image, range(ends))
            .unwrap();
        let same = map.pixels().iter().filter(|found| found.abs() < 0.5).count();
        assert!(same > 60 * 20 / 2, "{same} in {ends:?}");
    }
}

#[test]
fn pairs_beyond_gpu_memory_or_dispatch_limits_are_not_for_the_gpu() {
    let is_for_card = |size: [u32; 2], gathering| {
        let image = image(size, |_, _| 0);
        let matching = Matching {
            gathering,
            ..Matching::default()
        };
        Job::of(&CONTEXT, &matching, [&image, &image], range([0, 63])).is_some()
    };
    let (paths, squares) = (
        Gathering::SemiGlobal(Penalties::default()),
        Gathering::Local { radius_px: 3 },
    );
    // 2 bytes for each of 64 labels, doubled for squares.
    for (size, gathering, expected) in [
        ([1024, 512], paths, true),
        ([2048, 1024], squares, false),
        ([2048, 2048], paths, false),
        (
            [CONTEXT.limits.max_compute_workgroups_per_dimension + 1, 1],
            paths,
            false,
        ),
        (
            [1, CONTEXT.limits.max_compute_workgroups_per_dimension + 1],
            squares,
            false,
        ),
        ([1, 10_000], squares, true),
    ] {
        assert_eq!(is_for_card(size, gathering), expected, "{size:?} {gathering:?}");
    }
}

#[test]
fn a_software_adapter_leaves_pairs_to_the_cpu() {
    let is_of_processor = CardMatcher::shared(&CONTEXT) == SharedMatcher::default();
    assert_eq!(is_of_processor, CONTEXT.is_software());
    let by_card = SharedMatcher(Arc::new(CardMatcher::new(Arc::clone(&CONTEXT))));
    assert_ne!(by_card, SharedMatcher::default());
}

#[test]
fn threads_share_a_gpu() {
    let matcher = CardMatcher::new(Arc::clone(&CONTEXT));
    let matching = Matching {
        between: Between::Parabola,
        ..Matching::default()
    };
    std::thread::scope(|scope| {
        for (number, size) in [[70, 40], [50, 50], [64, 33]].into_iter().enumerate() {
            let (matcher, matching) = (&matcher, &matching);
            std::thread::Builder::new()
                .spawn_scoped(scope, move || {
                    let (_, pair) = pairs(size, number as u64).swap_remove(3);
                    for _ in 0..3 {
                        let [found, expected] = bits_of_both(matcher, matching, &pair);
                        assert!(found == expected, "{size:?}");
                    }
                })
                .unwrap();
        }
    });
}
