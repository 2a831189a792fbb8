//! Semi-global matching by its definition: each path on its own through a volume of numbers that are wide enough.

use super::*;
use crate::stereo::matching::costs::Volume;
use crate::stereo::matching::costs::test_costs::Random;
use proptest::prelude::*;

const COUNT: usize = 32;

/// Sums of all labels of all pixels.
fn sums_by_definition(volume: &Volume, guide: &GrayImage, penalties: Penalties) -> Vec<u16> {
    let table = penalties.table().unwrap();
    let [width, height] = volume.size.map(|side| side as i64);
    let count = volume.count;
    let mut sums = vec![0; volume.costs.len()];
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)] {
        let mut path: Vec<i32> = vec![0; volume.costs.len()];
        for step_y in 0..height {
            for step_x in 0..width {
                let x = if dx < 0 { width - 1 - step_x } else { step_x };
                let y = if dy < 0 { height - 1 - step_y } else { step_y };
                let (from_x, from_y) = (x - dx, y - dy);
                let at = (y * width + x) as usize;
                let is_first = from_x < 0 || from_y < 0 || from_x >= width || from_y >= height;
                for label in 0..count {
                    let cost = i32::from(volume.costs[at * count + label]);
                    let before = if is_first {
                        0
                    } else {
                        let from = (from_y * width + from_x) as usize;
                        let p2 = i32::from(table.p2(guide.pixels()[from], guide.pixels()[at]));
                        let p1 = i32::from(penalties.p1);
                        let of = |label: usize| path[from * count + label];
                        let min = (0..count).map(of).min().unwrap();
                        let mut best = of(label).min(min + p2);
                        if label > 0 {
                            best = best.min(of(label - 1) + p1);
                        }
                        if label + 1 < count {
                            best = best.min(of(label + 1) + p1);
                        }
                        best - min
                    };
                    path[at * count + label] = cost + before;
                }
            }
        }
        for (sum, path) in sums.iter_mut().zip(path) {
            *sum += path as u16;
        }
    }
    sums
}

fn sums(volume: &Volume, guide: &GrayImage, penalties: Penalties) -> Vec<u16> {
    let mut out = vec![Vec::new(); volume.size[0] * volume.size[1]];
    semi_global(volume, guide, penalties, &mut out, |sums, out| {
        for (out, sums) in out.iter_mut().zip(sums.chunks_exact(volume.count)) {
            *out = sums.to_vec();
        }
    })
    .unwrap();
    out.concat()
}

fn random_guide([width, height]: [usize; 2], seed: u64) -> GrayImage {
    let mut random = Random(seed);
    let pixels = (0..width * height).map(|_| random.next() as u8).collect();
    GrayImage::new([width as u32, height as u32], pixels).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn sums_are_those_of_the_definition_bit_by_bit(
        width in 1_usize..24,
        height in 1_usize..40,
        blocks in 1_usize..4,
        seed in any::<u64>(),
        p1 in 0_u8..60,
        more in 1_u8..40,
        max in 0_u8..60,
        half_change in any::<u8>(),
    ) {
        let volume = Volume::random([width, height], blocks * COUNT, seed);
        let guide = random_guide([width, height], seed ^ 1);
        let penalties = Penalties { p1, p2: p1 + more + max, p2_min: p1 + more, half_change };
        if let Err(error) = penalties.table() {
            prop_assert!(u16::from(p1) + u16::from(penalties.p2) > 193, "{error}");
            return Ok(());
        }
        let expected = sums_by_definition(&volume, &guide, penalties);
        prop_assert_eq!(sums(&volume, &guide, penalties), expected);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_sums() {
    let volume = Volume::random([37, 50], 2 * COUNT, 3);
    let guide = random_guide([37, 50], 4);
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sums(&volume, &guide, Penalties::default()))
    };
    let one = of(1);
    for threads in [2, 3, 7] {
        assert!(of(threads) == one, "{threads} threads");
    }
}

#[test]
fn penalties_that_do_not_fit_bytes_are_rejected() {
    let default = Penalties::default();
    for (p1, p2_min, p2) in [(24, 24, 120), (24, 60, 59), (100, 110, 120), (255, 255, 255)] {
        let penalties = Penalties {
            p1,
            p2,
            p2_min,
            ..default
        };
        let error = penalties.table().unwrap_err();
        assert!(matches!(error, StereoError::NoPenalties { .. }), "{error}");
    }
}

#[test]
fn matching_that_needs_gigabytes_is_rejected_before_allocating() {
    struct Huge;
    impl Costs for Huge {
        fn size(&self) -> [usize; 2] {
            [1, 1]
        }
        fn count(&self) -> usize {
            1 << 40
        }
        fn fill(&self, _: std::ops::Range<usize>, _: &mut [u8]) {
            panic!("asked for costs");
        }
    }
    let guide = random_guide([1, 1], 0);
    let error = semi_global(&Huge, &guide, Penalties::default(), &mut [0], |_, _| ()).unwrap_err();
    assert!(matches!(error, StereoError::TooLarge { .. }), "{error}");
}
