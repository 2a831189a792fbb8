//! Points that move along known lines.

use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;
use crate::sequence::{FrameEntry, Needs, PrepareCounters, prepare};

/// Far enough from zero that the sequence has an origin.
const FAR: DVec3 = DVec3::new(4.0e6, -2.0e6, 1.0e5);

/// Point `index` of frame `frame`: each goes along a line of its own, by a step of `speed` a frame.
fn place(index: usize, frame: usize) -> DVec3 {
    let begin = DVec3::new((index % 10) as f64, (index / 10) as f64, 0.0);
    begin + direction(index) * frame as f64
}

fn direction(index: usize) -> DVec3 {
    DVec3::new(0.25, 0.5, 0.125 * (index % 4) as f64)
}

/// Frames of points in order, as `points` says how many there are and in which order.
fn sequence(frame_count: usize, points: impl Fn(usize) -> Option<Vec<usize>> + Send + Sync + 'static) -> Sequence {
    let sources = (0..frame_count as u64).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("{number}.ply"))
    });
    Sequence::with_decoder(sources.collect(), move |source| {
        let frame = source.number.unwrap() as usize;
        let order = points(frame).ok_or("line 3: expected an element")?;
        let positions = order.into_iter().map(|index| match index {
            usize::MAX => [f64::NAN; 3],
            index => (FAR + place(index, frame)).to_array(),
        });
        Ok(RawCloud::from_positions(Positions::F64(positions.collect())))
    })
}

fn request(indices: &[u32], chosen_in: usize, frames: Range<usize>) -> TrailRequest {
    TrailRequest {
        indices: indices.to_vec(),
        chosen_in,
        points_in_file: 100,
        frames,
    }
}

fn trace(sequence: &Sequence, request: &TrailRequest) -> Trails {
    Trails::trace(request, sequence, |_| None, &Progress::default()).unwrap()
}

/// Frames in which the only trail has a place.
fn placed(trails: &Trails) -> Vec<usize> {
    let mut frames: Vec<usize> = trails.frames().collect();
    frames.retain(|&frame| trails.place(0, frame).is_some());
    frames
}

fn texts(trails: &Trails) -> Vec<String> {
    let texts = trails
        .breaks()
        .iter()
        .map(|broken| broken.text(|frame| format!("frame {}", frame + 1)));
    texts.collect()
}

#[test]
fn linear_motion_has_known_positions_lengths_and_speeds() {
    let sequence = sequence(12, |_| Some((0..100).collect()));
    let indices = [7, 42, 99];
    let request = request(&indices, 5, 2..10);
    let trails = trace(&sequence, &request);
    let origin = sequence.origin();
    assert_ne!(origin, DVec3::ZERO);
    assert_eq!((trails.trail_count(), trails.breaks().len()), (3, 0));
    for (trail, &index) in indices.iter().enumerate() {
        for frame in 2..10 {
            let found = origin + trails.place(trail, frame).unwrap().as_dvec3();
            assert_eq!(found, FAR + place(index as usize, frame));
        }
        let step = direction(index as usize).length();
        let measure = trails.measure(trail, |frame| frame as f64 / 24.0).unwrap();
        assert!((measure.length - 7.0 * step).abs() < 1e-5);
        assert!((measure.mean_speed - 24.0 * step).abs() < 1e-4);
        assert!((measure.max_speed - 24.0 * step).abs() < 1e-4);
        // As timestamps may indicate: the last step took three times as long.
        let uneven = |frame: usize| if frame == 9 { 11.0 } else { frame as f64 };
        let measure = trails.measure(trail, uneven).unwrap();
        assert!((measure.mean_speed - 7.0 / 9.0 * step).abs() < 1e-5);
        assert!((measure.max_speed - step).abs() < 1e-5);
    }
    assert_eq!(trails.place(0, 1), None);
    assert_eq!(trails.place(0, 10), None);
    assert_eq!(trails.place(3, 4), None);
}

#[test]
fn positions_from_cached_frames_match_the_files() {
    let sequence = Arc::new(sequence(6, |frame| {
        let mut order: Vec<usize> = (0..100).collect();
        order[13] = usize::MAX;
        order[20 + frame] = usize::MAX;
        Some(order)
    }));
    let prepared = |index: usize| {
        let frame = Arc::new(sequence.frame(index).unwrap());
        let counters = PrepareCounters::default();
        Arc::new(prepare(index, frame, 0.0, &Needs::default(), &counters))
    };
    let request = request(&[0, 13, 22, 99], 0, 0..6);
    let from_files = trace(&sequence, &request);
    let resident: Vec<_> = (0..6).map(prepared).collect();
    let decoded = sequence.decode_count();
    let in_memory = |index: usize| Some(Arc::clone(&resident[index]));
    let from_memory = Trails::trace(&request, &sequence, in_memory, &Progress::default()).unwrap();
    // NaN is not equal to itself.
    for frame in 0..6 {
        for trail in 0..4 {
            assert_eq!(from_memory.place(trail, frame), from_files.place(trail, frame));
        }
        assert_eq!(from_files.place(1, frame), None, "a hole in every frame");
        assert_eq!(from_files.place(2, frame).is_none(), frame == 2);
    }
    assert_eq!(sequence.decode_count(), decoded, "nothing was read");
    // There is no trail across the gap.
    let measure = from_files.measure(2, |frame| frame as f64).unwrap();
    assert!((measure.length - 3.0 * direction(22).length()).abs() < 1e-5);
    assert_eq!(from_files.measure(1, |frame| frame as f64), None);
}

#[test]
fn frames_with_other_counts_and_broken_frames_break_trails_and_are_reported() {
    let sequence = sequence(9, |frame| match frame {
        6 | 7 => Some((0..102).collect()),
        2 => None,
        _ => Some((0..100).collect()),
    });
    let trails = trace(&sequence, &request(&[50], 4, 0..9));
    assert_eq!(placed(&trails), [0, 1, 3, 4, 5, 8]);
    assert_eq!(
        texts(&trails),
        [
            "frame 3 cannot be read",
            "frame 7 has 102 points, frame 6 has 100: indices do not stay with the points"
        ]
    );
    // There are three steps between neighbours.
    let measure = trails.measure(0, |frame| frame as f64).unwrap();
    assert!((measure.length - 3.0 * direction(50).length()).abs() < 1e-5);
}

#[test]
fn a_trail_ends_where_the_order_changes_on_either_side_of_its_origin() {
    let shuffled = |index: usize| index * 37 % 100;
    let sequence = sequence(9, move |frame| {
        Some(if frame < 5 {
            (0..100).collect()
        } else {
            (0..100).map(shuffled).collect()
        })
    });
    let before = trace(&sequence, &request(&[50], 1, 0..9));
    assert_eq!(placed(&before), [0, 1, 2, 3, 4]);
    let expected = [
        "the points of frame 6 seem to be in another order than those of frame 5: indices do not stay with the points",
    ];
    assert_eq!(texts(&before), expected);
    let after = trace(&sequence, &request(&[50], 7, 0..9));
    assert_eq!(placed(&after), [5, 6, 7, 8]);
    assert_eq!(texts(&after), expected);
    // Chosen outside the tracked range: the frames in between are visited as well.
    let outside = trace(&sequence, &request(&[50], 8, 3..6));
    assert_eq!(placed(&outside), [5]);
}

#[test]
fn a_cancelled_search_has_no_result_and_reads_no_more() {
    let sequence = sequence(9, |_| Some((0..100).collect()));
    sequence.origin();
    let before = sequence.decode_count();
    let request = request(&[1], 0, 0..9);
    let progress = Progress::told_to(|progress| {
        if progress.done() == 3 {
            progress.cancel();
        }
    });
    let trails = Trails::trace(&request, &sequence, |_| None, &progress);
    assert_eq!(trails, None);
    assert_eq!((progress.done(), progress.of()), (3, Some(9)));
    assert_eq!(sequence.decode_count() - before, 3);
}

#[test]
fn the_number_of_trails_is_limited_by_memory() {
    let sequence = sequence(2, |_| Some((0..100).collect()));
    let indices: Vec<u32> = (0..100).collect();
    let all = trace(&sequence, &request(&indices, 0, 0..2));
    assert_eq!(all.trail_count(), 100);
    let max = MAX_BYTES / size_of::<Vec3>();
    let many = vec![3; max];
    let trails = trace(&sequence, &request(&many, 0, 0..usize::MAX));
    assert_eq!(trails.trail_count(), max / 2);
}

#[test]
fn a_tube_surrounds_the_trajectory_and_is_brighter_for_the_past() {
    let sequence = sequence(6, |_| Some((0..100).collect()));
    let trails = trace(&sequence, &request(&[40], 0, 0..6));
    let (first, last) = (trails.place(0, 0).unwrap(), trails.place(0, 5).unwrap());
    let tube = trails.tube(0, 2, 0.05).unwrap();
    // Five steps of 0.56, in pieces of at most the radius, eight points around.
    assert_eq!(tube.points.len(), 5 * 12 * 8);
    let along = (last - first).normalize();
    for point in tube.points.iter() {
        let place = Vec3::from_array(point.position) - first;
        let way = place.dot(along);
        assert!((0.0..(last - first).length()).contains(&way), "{way}");
        assert!(((place - way * along).length() - 0.05).abs() < 1e-4);
        let is_behind = way < (trails.place(0, 2).unwrap() - first).length();
        assert_eq!(point.color[0] == 255, is_behind);
    }
    assert!(trails.tube(0, 2, 1e-9).unwrap().points.len() <= 800_000);
    assert!(trails.tube(7, 2, 0.05).unwrap().points.is_empty());
}
