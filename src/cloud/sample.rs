//! Subsampling: points that represent all of them where there is no time for all.
//!
//! Points are taken evenly from the order of the file: one out of each of N equal parts, at an index that differs from
//! part to part. So a sample does not need the coordinates, organised clouds do not lose whole columns, and equal
//! clouds have equal samples.

/// `max` places of `0..count`, ascending, one in each of `max` equal parts; all where there are no more.
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
    use crate::cloud::attributes::gather;
    use crate::cloud::{Ellipse, Frame, Positions, RawCloud};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn one_sample_is_taken_from_each_stratum(count in 0usize..5000, max in 0usize..6000) {
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
    fn samples_cover_all_columns_of_an_organised_cloud() {
        let width = 640;
        let mut met = vec![0; width];
        for place in even_places(640 * 480, 640 * 480 / 16) {
            met[place % width] += 1;
        }
        assert!(met.iter().all(|&times| (5..=80).contains(&times)), "{met:?}");
    }

    #[test]
    fn moving_points_do_not_change_which_ones_are_sampled() {
        let line = |moved: f32| {
            let mut positions: Vec<[f32; 3]> = (0..1000).map(|index| [index as f32, 0.5, 0.0]).collect();
            positions[17] = [moved, 9.0, 3.0];
            positions[400] = [f32::NAN; 3];
            RawCloud::from_positions(Positions::F32(positions))
        };
        let taken = |frame: &Frame| {
            let mut indices = frame.file_index().to_vec();
            indices.sort_unstable();
            indices
        };
        let from_file = Frame::from_raw_sample(line(0.0), DVec3::ZERO, 100).unwrap();
        for moved in [0.0, 312.0, 999.0] {
            let frame = Frame::from_raw(line(moved), DVec3::ZERO).unwrap();
            let (sample, slots) = frame.sample(100).unwrap();
            assert_eq!(taken(&sample), taken(&from_file), "{moved}");
            let counts = |frame: &Frame| [frame.len(), frame.dropped_points(), frame.points_in_file()];
            assert_eq!(counts(&sample), counts(&from_file));
            assert_eq!(gather(frame.file_index(), &slots), sample.file_index());
            assert!(sample.is_sample());
        }
        // A sample of a sample has no others.
        let (smaller, _) = from_file.sample(10).unwrap();
        assert_eq!(smaller.len(), 10);
        assert!(
            smaller
                .file_index()
                .iter()
                .all(|index| from_file.file_index().contains(index))
        );
    }

    #[test]
    fn ellipses_of_a_sample_scale_with_its_radii() {
        let mut raw = RawCloud::from_positions(Positions::F32((0..100).map(|x| [x as f32, 0.0, 0.0]).collect()));
        let ellipse = Ellipse {
            axis: Vec3::X,
            ratio: 0.25,
        };
        raw.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; 100]);
        raw.attributes.radii = Some(vec![2.0; 100]);
        raw.attributes.ellipses = Some(vec![ellipse; 100]);
        let whole = Frame::from_raw(raw.clone(), DVec3::ZERO).unwrap();
        let of_file = Frame::from_raw_sample(raw, DVec3::ZERO, 25).unwrap();
        let (of_memory, _) = whole.sample(25).unwrap();
        for (frame, half_axes) in [(&whole, [4.0, 1.0]), (&of_file, [8.0, 2.0]), (&of_memory, [8.0, 2.0])] {
            for (ellipse, &radius) in frame.ellipses().unwrap().iter().zip(frame.radii().unwrap()) {
                assert_eq!((ellipse.axis, ellipse.half_axes(radius)), (Vec3::X, half_axes));
            }
        }
        let part = whole.part_without_splats(&[1, 2]).unwrap();
        assert_eq!((part.radii(), part.ellipses()), (None, None));
        assert!(part.normals().is_some());
    }

    #[test]
    fn a_sample_knows_the_file_index_of_its_points() {
        let position = |i: usize| [(i * 7 % 100) as f32, (i % 10) as f32, (i / 10) as f32];
        let mut raw = RawCloud::from_positions(Positions::F32((0..100).map(position).collect()));
        raw.attributes.radii = Some(vec![0.5; 100]);
        let sample = Frame::from_raw_sample(raw.clone(), DVec3::ZERO, 25).unwrap();
        assert_eq!(
            (sample.len(), sample.points_in_file(), sample.is_sample()),
            (25, 100, true)
        );
        assert!(
            sample.radii().unwrap().iter().all(|&radius| radius == 1.0),
            "cover as much"
        );
        let whole = Frame::from_raw(raw.clone(), DVec3::ZERO).unwrap();
        assert_eq!(Frame::from_raw_sample(raw, DVec3::ZERO, 100).unwrap(), whole);
        let (again, slots) = whole.sample(25).unwrap();
        assert_eq!(again.points_in_file(), 100);
        for (&slot, at) in slots.iter().zip(again.positions()) {
            assert_eq!(whole.positions()[slot as usize], *at);
        }
        let (twice, _) = again.sample(5).unwrap();
        assert_eq!((twice.len(), twice.points_in_file()), (5, 100));
        for frame in [sample, again, twice] {
            for (&index, at) in frame.file_index().iter().zip(frame.positions()) {
                assert_eq!(at.to_array(), position(index as usize));
            }
        }
    }
}
