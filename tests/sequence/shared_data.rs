//! Real sequences: the demo, which is part of the program, and the shared data.

use super::data::shared;
use super::*;

#[test]
fn the_demo_plays() {
    let sequence = Arc::new(Sequence::demo());
    assert_eq!(sequence.len(), 24);
    assert_eq!(sequence.origin(), DVec3::ZERO);
    let loader = loader(&sequence, 2, usize::MAX);
    loader.request(0, Direction::Forward, &Needs::default());
    let first = loader.wait(0, &Needs::default()).unwrap();
    for index in 0..24 {
        let frame = loader.wait(index, &Needs::default()).unwrap();
        assert_eq!(frame.points.len(), 8334);
        assert_eq!(frame.colors(), ColorSource::File);
        assert_eq!(sequence.entry(index).number, Some(index as u64));
        // Points correspond: between any two frames of a walk no part of the body moves by a metre.
        let [now, then] = [&frame, &first].map(|frame| by_file(&frame.frame, frame.frame.positions()));
        let farthest = now
            .iter()
            .zip(then)
            .map(|(now, then)| now.distance(then))
            .fold(0.0, f32::max);
        assert!(farthest < 1.0, "frame {index} moved {farthest} m");
        assert_eq!(index == 0, farthest == 0.0);
    }
    assert_eq!(loader.stats().decoded, 24);
}

fn check(folder: &Path, frames: &[usize]) -> Arc<Sequence> {
    let sequence = Arc::new(Sequence::discover(&[folder.to_path_buf()]).unwrap());
    assert_eq!(sequence.len(), frames.len());
    let loader = loader(&sequence, 2, usize::MAX);
    for (index, &points) in frames.iter().enumerate() {
        let frame = loader.wait(index, &Needs::default()).unwrap();
        assert_eq!(frame.points.len(), points, "{}", sequence.entry(index).name);
    }
    sequence
}

#[test]
fn a_plant_sequence_of_mixed_formats_with_gaps_plays() {
    let Some(folder) = shared("sequences/plant4d_tomato") else {
        return;
    };
    let sequence = check(&folder, &[24_795, 50_000, 179_757, 261_379]);
    let numbers: Vec<_> = sequence.entries().iter().map(|s| s.number).collect();
    assert_eq!(numbers, [Some(5), Some(6), Some(8), Some(10)]);
    // It lies 740 units from zero and is 50 wide: the origin moves to it, on a grid of 64.
    assert_eq!(sequence.origin() % 64.0, DVec3::ZERO);
    assert_ne!(sequence.origin(), DVec3::ZERO);
}

#[test]
fn camera_frames_named_by_time_play() {
    let Some(folder) = shared("sequences/pcl_openni_3frames") else {
        return;
    };
    let sequence = check(&folder.join("pcd"), &[271_575, 271_395, 271_328]);
    assert!(sequence.entry(0).name.contains("142255.814212"));
    // The other folder has images, but no clouds.
    let parent = Sequence::discover(&[folder]).unwrap();
    assert_eq!(parent.len(), sequence.len());
    let frames = parent.assumptions();
    assert!(
        frames.iter().any(|assumption| assumption.value.contains("3 files in")),
        "{frames:?}"
    );
}

#[test]
fn the_sampled_man_plays() {
    if let Some(folder) = shared("sequences/cesiumman_24fps") {
        check(&folder, &[50_000; 24]);
    }
}

/// Every second frame of the model, sampled as in the demo.
#[test]
fn the_man_the_demo_was_made_from() {
    let Some(model) = shared("models/CesiumMan.glb") else {
        return;
    };
    let read = ReadOptions::default().with_sample_count(NonZeroUsize::new(8334));
    let options = OpenOptions {
        read,
        ..OpenOptions::default()
    };
    let model = Sequence::open(&[model], &options).unwrap();
    let demo = Sequence::demo();
    for index in [0, 13, 23] {
        let [sampled, retained] = [model.frame(2 * index), demo.frame(index)].map(Result::unwrap);
        let colors = |frame: &Frame| by_file(frame, frame.colors().unwrap());
        assert_eq!(colors(&sampled), colors(&retained));
        let [sampled, retained] = [&sampled, &retained].map(|frame| by_file(frame, frame.positions()));
        for (sampled, retained) in sampled.iter().zip(retained) {
            assert!(sampled.distance(retained) < 1e-6, "{sampled} {retained}");
        }
    }
}
