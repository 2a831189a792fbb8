//! Tests of estimates against the actual file sizes.

use super::*;
use crate::cloud::Attributes;
use crate::reel::Precision;
use std::fs;

/// Four frames of a wave of 1,600 points, coloured and with normals; the last one is empty.
fn sequence() -> Sequence {
    sequence_of(4)
}

/// The first of those frames.
fn sequence_of(count: u32) -> Sequence {
    let entries = (0..count.into()).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("nowhere/{number}.ply"))
    });
    Sequence::with_decoder(entries.collect(), |entry| {
        let phase = entry.number.unwrap_or(0) as f32;
        let count = if entry.number == Some(3) { 0 } else { 1600 };
        let places = (0..count).map(|index| {
            let [x, y] = [index % 40, index / 40].map(|place| place as f32 * 0.1);
            [x, y, (x + phase).sin()]
        });
        let positions = Positions::F32(places.collect());
        let attributes = Attributes {
            colors: Some((0..count).map(|index| [(index % 40 * 6) as u8, 99, 9, 255]).collect()),
            normals: Some(vec![[0.0, 0.6, 0.8]; count]),
            ..Attributes::default()
        };
        Ok(RawCloud {
            attributes,
            ..RawCloud::from_positions(positions)
        })
    })
}

fn judged(index: usize, target: &Target) -> SampleEstimate {
    judged_of(&sequence(), index, target)
}

fn judged_of(sequence: &Sequence, index: usize, target: &Target) -> SampleEstimate {
    let sample = SampleFrame::read(sequence, &(0..=sequence.len() - 1), index, &Edit::default()).unwrap();
    sample.judge(target, &Progress::default()).unwrap().unwrap()
}

#[test]
fn an_estimate_matches_the_written_file() {
    let sequence = sequence_of(3);
    for options in [ReelOptions::merged(), ReelOptions::lossless(), ReelOptions::default()] {
        let options = ReelOptions {
            keyframes: 3,
            ..options
        };
        let target = Target::Reel(options.clone());
        let samples = [0, 1, 2].map(|index| judged_of(&sequence, index, &target));
        let estimate = Estimate::of(&samples).unwrap();
        let clouds = [0, 1, 2].map(|index| sequence.decode(index).unwrap());
        let frames = clouds.each_ref().map(|cloud| NewFrame {
            cloud,
            name: "frame.ply",
            time: None,
        });
        let written = write_to_memory(&frames, &options).unwrap().len() as f64;
        let expected = 3.0 * estimate.frame_bytes;
        assert!(
            (written / expected - 1.0).abs() < 0.06,
            "{written} bytes for {expected}"
        );
        let of_streams: f64 = estimate.bits_by_stream().iter().map(|(_, bits)| bits).sum();
        assert!(of_streams < estimate.bits_per_point() && of_streams > 0.7 * estimate.bits_per_point());
    }
}

#[test]
fn lossless_has_no_error_and_a_length_respects_its_bound() {
    let lossless = judged(0, &Target::Reel(ReelOptions::lossless()));
    let errors = Estimate::of(&[lossless]).unwrap().errors.unwrap();
    assert_eq!((errors.largest, errors.rms), (0.0, 0.0));
    assert_eq!(errors.d1_psnr_db, Some(f64::INFINITY));
    assert_eq!(errors.color_psnr_db, Some(f64::INFINITY));
    assert!(errors.normals_deg.unwrap()[1] < 1e-6);
    let of_length = judged(
        0,
        &Target::Reel(ReelOptions {
            precision: Precision::Length(0.01),
            ..ReelOptions::default()
        }),
    );
    assert_eq!(of_length.retained_points, 1600);
    let errors = Estimate::of(&[of_length]).unwrap().errors.unwrap();
    assert!(
        errors.largest > 0.0 && errors.largest <= 0.01 * 3f64.sqrt() * 1.001,
        "{errors:?}"
    );
    assert!(
        errors.rms <= errors.largest && errors.d1_psnr_db.unwrap() > 40.0,
        "{errors:?}"
    );
}

#[test]
fn means_are_over_frames_and_the_max_error_is_of_the_worst_frame() {
    let target = Target::Reel(ReelOptions::default());
    let samples = [0, 2, 3].map(|index| judged(index, &target));
    assert_eq!((samples[2].points, samples[2].error), (0, None));
    let estimate = Estimate::of(&samples).unwrap();
    assert_eq!((estimate.frames, estimate.points), (3, 3200.0 / 3.0));
    let largest = samples.iter().filter_map(|sample| sample.error);
    let largest = largest
        .map(|error| error.geometry.point_to_point.hausdorff())
        .fold(0.0, f64::max);
    assert_eq!(estimate.errors.unwrap().largest, largest);
    assert_eq!(Estimate::of(&[]), None);
}

#[test]
fn files_are_estimated_by_reading_them_back() {
    let sequence = sequence();
    let ply = judged(0, &Target::Files(WriteFormat::default()));
    let mut file = Cursor::new(Vec::new());
    io::write(&mut file, WriteFormat::default(), &sequence.decode(0).unwrap()).unwrap();
    assert_eq!(ply.bytes, file.into_inner().len() as f64);
    assert_eq!((ply.retained_points, ply.bytes_by_stream), (1600, None));
    assert_eq!(ply.error.unwrap().geometry.point_to_point.hausdorff(), 0.0);
    // LAS stores integer multiples of a length.
    let las = judged(0, &Target::Files("las".parse().unwrap()));
    let error = las.error.unwrap().geometry.point_to_point.hausdorff();
    assert!(error > 0.0 && error < 0.01, "{error}");
}

#[test]
fn a_cancelled_frame_is_not_estimated() {
    let sample = SampleFrame::read(&sequence(), &(0..=sequence().len() - 1), 0, &Edit::default()).unwrap();
    let progress = Progress::default();
    progress.cancel();
    let target = Target::Files(WriteFormat::default());
    assert_eq!(sample.judge(&target, &progress).unwrap(), None);
}

#[test]
fn files_of_a_source_are_counted_once() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one.ply", "two.ply"].map(|name| folder.path().join(name));
    fs::write(&one, [0; 100]).unwrap();
    fs::write(&two, [0; 30]).unwrap();
    let entries = [&one, &two, &two].map(FrameEntry::file);
    let sequence = Sequence::with_decoder(entries.to_vec(), |_| Err("not read".into()));
    assert_eq!(source_bytes(&sequence, &(0..=2)), Some(130));
    assert_eq!(source_bytes(&sequence, &(1..=9)), Some(30));
    fs::remove_file(&two).unwrap();
    assert_eq!(source_bytes(&sequence, &(0..=2)), None);
    assert!(source_bytes(&Sequence::demo(), &(0..=23)).unwrap() > 10_000);
}
