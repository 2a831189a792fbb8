//! Suites about inputs: sequence files, depth images, playing.

use super::{assert_files_agree, input, measure, numbers, small};
use pointreel::bench::{BenchOptions, Cell, Row, run, suites};
use pointreel::progress::Progress;
use pointreel::sequence::Sequence;

#[test]
fn sequence_files_are_measured_by_stream() {
    let report = measure(&small(suites::REEL));
    assert_files_agree(&report);
    let number = |options: &str, key: &str| {
        let of = |row: &&Row| report.value(row, "options") == Some(&Cell::Text(options.to_owned()));
        let row = report.rows.iter().find(of);
        let row = row.unwrap_or_else(|| panic!("no row of {options}"));
        report.value(row, key).and_then(Cell::number)
    };
    let of_reel = [
        "every point",
        "sampling density",
        "sampling density, fast",
        "sampling density, each frame by itself",
        "10 bits",
        "10 bits, fast",
        "lossless",
    ];
    let of_draco = [
        "Draco, 10 bits, positions alone",
        "Draco, 10 bits",
        "Draco, 10 bits, sequential",
    ];
    assert_eq!(report.rows.len(), of_reel.len() + of_draco.len());
    let bits = |options| number(options, "bits_per_point").unwrap();
    let [every_point, density, _, alone, voxels, _, lossless] = of_reel.map(bits);
    assert!(voxels < lossless && density < every_point && every_point < lossless);
    // Frames of a group share a directory, and one cube for their coordinates.
    assert!(density < 1.05 * alone, "{density} {alone}");
    let streams = [
        "geometry", "position", "color", "normal", "offset", "radius", "scalar", "order", "motion",
    ];
    for options in of_reel {
        let of_streams = streams.map(|stream| number(options, &format!("{stream}_bits")).unwrap());
        let (sum, bits) = (of_streams.iter().sum::<f64>(), bits(options));
        assert!(sum > 0.8 * bits && sum < bits, "{options}: {sum} of {bits}");
    }
    for key in ["encode_ms", "decode_ms"] {
        assert!(numbers(&report, key).iter().all(|&ms| ms > 0.0));
    }
    // Ten bits preserve a tenth of a percent of the longest side; lossless coding has no error, and so no ratio to it.
    let psnr = number("10 bits", "d1_psnr").unwrap();
    assert!(psnr > 60.0);
    assert_eq!(number("lossless", "d1_psnr"), None);
    assert_eq!(number("lossless", "flip"), Some(0.0));
    assert!(number("10 bits", "flip") > Some(0.0));
    let colors = |options| number(options, "color_psnr").unwrap();
    assert!(
        colors("sampling density") < colors("10 bits"),
        "merging points mixes colours"
    );
    // Draco is given the same cells, and loses nothing of them; positions are rounded once more when converted back.
    let [positions, kd_tree, sequential] = of_draco.map(bits);
    assert!(positions < kd_tree && positions < sequential);
    for options in of_draco {
        let of_draco = number(options, "d1_psnr").unwrap();
        assert!((of_draco - psnr).abs() < 1e-3, "{options}: {of_draco} beside {psnr}");
    }
    let without_colors = number("Draco, 10 bits, positions alone", "flip");
    assert_eq!(without_colors, None, "no colours, no picture");
}

#[test]
fn filters_of_depth_images_are_measured_one_by_one() {
    let options = BenchOptions {
        warmup: 0,
        repeat: 1,
        ..small(suites::RGBD)
    };
    let report = measure(&options);
    assert_files_agree(&report);
    // Rows of filters and of clouds have different columns.
    let there = |key: &str| -> Vec<f64> {
        let cells = report.rows.iter().filter_map(|row| report.value(row, key));
        cells.filter_map(Cell::number).collect()
    };
    // The demo has no images: no decoding, five filters, all of them together, and points. Then the sizes of the paper,
    // and a frame.
    let (filters, clouds) = (7, 5);
    assert_eq!(report.rows.len(), filters + clouds);
    for (key, rows) in [
        ("one_thread_ms_median", filters),
        ("all_threads_ms_median", filters),
        ("mpixels_per_s", filters),
        ("cull_ms_median", clouds),
        ("normals_ms_median", clouds),
        ("bisected_ms_median", clouds),
        ("draw_ms_median", clouds),
    ] {
        let values = there(key);
        assert!(
            values.len() == rows && values.iter().all(|&value| value > 0.0),
            "{key}: {values:?}"
        );
    }
    let retained = there("valid_after");
    let measured = there("valid");
    // The median and the bilateral filter neither drop nor fill pixels.
    assert_eq!((retained[1], retained[2]), (measured[1], measured[2]));
    assert!(
        retained
            .iter()
            .zip(&measured)
            .all(|(retained, measured)| retained <= measured),
        "{retained:?} of {measured:?}"
    );
    assert_eq!(retained.len(), filters);
    let (points, visible) = (there("points"), there("visible"));
    assert!(points.len() == clouds && visible.len() == clouds);
    assert!(
        visible
            .iter()
            .zip(&points)
            .all(|(visible, points)| visible <= points && *visible > 0.0),
        "{visible:?} of {points:?}"
    );
}

#[test]
fn playback_is_counted_frame_by_frame() {
    let options = BenchOptions {
        frames: 30,
        ..small(suites::PLAY)
    };
    let inputs = [input("demo", Sequence::demo().with_fps(60.0))];
    let never = Progress::default();
    let report = run(&inputs, &options, None, &|_| {}, &never).unwrap();
    assert_eq!(report.rows.len(), 3, "points, surfels and voxels");
    for row in &report.rows {
        let number = |key: &str| report.value(row, key).and_then(Cell::number).unwrap();
        assert_eq!((number("fps_asked"), number("frames_shown")), (60.0, 30.0));
        assert!(number("fps_held") <= 61.0, "never ahead of the clock");
        assert!(number("points_share") > 0.0 && number("points_share") <= 1.0);
        assert!(number("resident_peak_mib") >= number("resident_end_mib"));
        assert!(number("picture_ms_median") > 0.0);
    }
}
