//! Subsampling: the points that stand for all of them where there is no time for all.
//!
//! Points are taken evenly from the order of the file: one out of each of N equal parts, at an index that differs from
//! part to part. So a sample requires no look at the coordinates, organised clouds do not lose whole columns, and equal
//! clouds have equal samples.

/// `max` places of `0..count`, ascending, one in each of as many equal parts; all where there are no more.
pub(crate) fn even_places(count: usize, max: usize) -> Vec<usize> {
    if count <= max {
        return (0..count).collect();
    }
    let begin = |part: usize| (part as u64 * count as u64 / max as u64) as usize;
    (0..max)
        .map(|part| {
            let len = begin(part + 1) - begin(part);
            begin(part) + (fraction(part as u64) * len as f64) as usize
        })
        .collect()
}

/// Factor on the radii of a sample of `retained` out of `count` points, so that it covers the surface that all of them
/// cover.
pub(crate) fn radius_factor(count: usize, retained: usize) -> f32 {
    (count as f64 / retained.max(1) as f64).max(1.0).sqrt() as f32
}

/// A well-mixed number from 0 to less than 1 (splitmix64).
fn fraction(number: u64) -> f64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn places_are_one_in_each_part(count in 0usize..5000, max in 0usize..6000) {
            let places = even_places(count, max);
            prop_assert_eq!(places.len(), count.min(max));
            prop_assert!(places.is_sorted_by(|a, b| a < b));
            for (number, &place) in places.iter().enumerate() {
                let part = number * count / places.len()..(number + 1) * count / places.len();
                prop_assert!(part.contains(&place), "{place} in {part:?}");
            }
        }
    }

    #[test]
    fn columns_of_an_organised_cloud_are_all_met() {
        let width = 640;
        let mut met = vec![0; width];
        for place in even_places(640 * 480, 640 * 480 / 16) {
            met[place % width] += 1;
        }
        assert!(met.iter().all(|&times| (5..=80).contains(&times)), "{met:?}");
    }
}
