//! The suite of errors of normals, octrees and levels of detail.

use super::{assert_files_agree, column, common, demo, rows_of, small};
use pointreel::bench::{BenchOptions, Cell, Report, Row, Step, run, suites};
use pointreel::progress::Progress;
use std::cell::RefCell;

#[test]
fn errors_are_measured_alongside_times() {
    let options = BenchOptions {
        // Leaves of a few pixels, so that every threshold but the finest changes the image.
        viewport_px: [384, 256],
        frames: 1,
        warmup: 0,
        repeat: 1,
        ..small(suites::ACCURACY)
    };
    let last_step = RefCell::new(None);
    let watch = |step: Step| *last_step.borrow_mut() = Some(step);
    let never = Progress::default();
    let report = run(&demo(), &options, Some(&common::context()), &watch, &never).unwrap();
    let last_step = last_step.into_inner().unwrap();
    // 24 combinations of shapes; preparing, leaves, two distances, and voxels compared with surfels.
    assert_eq!((last_step.done, last_step.total), (28, 29));
    assert_files_agree(&report);
    let names: Vec<String> = report.tables().into_iter().map(|table| table.name).collect();
    assert_eq!(names, ["normals", "leaves", "lod", "closed"]);
    assert_normals(&report);
    assert_leaves(&report);
    assert_levels_of_detail(&report);
    assert_voxels_beside_surfels(&report);
    let bars = report.bars();
    assert_eq!(bars.len(), 8, "one a threshold and distance");
    assert_eq!(bars[3].0, "demo 8 1");
}

fn assert_normals(report: &Report) {
    let rows = rows_of(report, "normals");
    let is_given = |row: &&Row| report.value(row, "chosen") == Some(&Cell::Text("given".to_owned()));
    let (rows, automatic): (Vec<&Row>, Vec<&Row>) = rows.into_iter().partition(is_given);
    // Four shapes, six disturbances, three numbers of neighbours, in this order, and one automatic choice each.
    assert_eq!((rows.len(), automatic.len()), (72, 24));
    let [mean, p95, max] = ["angle_deg_mean", "angle_deg_p95", "angle_deg_max"].map(|key| column(report, &rows, key));
    for (place, ((mean, p95), max)) in mean.iter().zip(&p95).zip(&max).enumerate() {
        assert!(
            0.0 < *mean && mean < p95 && p95 <= max && *max <= 90.0,
            "row {place}: {mean}, {p95}, {max}"
        );
    }
    assert!(
        column(report, &rows, "normals_ms_median")
            .iter()
            .all(|&time_ms| time_ms > 0.0)
    );
    for (shape, name) in ["sphere", "torus", "cube", "saddle"].into_iter().enumerate() {
        assert_eq!(
            report.value(rows[18 * shape], "shape"),
            Some(&Cell::Text(name.to_owned()))
        );
        let of_shape = &mean[18 * shape..][..12];
        for neighbours in 0..3 {
            let by_noise: Vec<f64> = of_shape.iter().copied().skip(neighbours).step_by(3).collect();
            assert!(
                by_noise.windows(2).all(|pair| pair[0] < pair[1]),
                "{name}: noise does not help: {by_noise:?}"
            );
        }
        let noisiest = &of_shape[9..];
        assert!(
            noisiest.windows(2).all(|pair| pair[0] > pair[1]),
            "{name}: more neighbours average more noise: {noisiest:?}"
        );
    }
    // One point in twenty is far off: a robust fit is closer to the ground truth on each shape.
    let robust = column(report, &rows, "robust_angle_deg_mean");
    for (plain, robust) in mean.chunks(18).zip(robust.chunks(18)) {
        let outliers_alone = 12..15;
        for (plain, robust) in plain[outliers_alone.clone()].iter().zip(&robust[outliers_alone]) {
            assert!(robust < plain, "{robust} for {plain}");
        }
    }
    // The automatic choice notices noise: it is nearer to the ground truth than the fewest neighbours.
    let automatic = column(report, &automatic, "angle_deg_mean");
    for (given, automatic) in mean.chunks(18).zip(automatic.chunks(6)) {
        assert!(automatic[3] < given[9], "{} for {}", automatic[3], given[9]);
    }
    // Without noise a sphere is nearly flat between neighbours, while edges are not.
    assert!(mean[0] < 2.0 && max[0] < 20.0, "{} and {}", mean[0], max[0]);
    assert!(max[36] > 20.0, "{}", max[36]);
}

fn assert_leaves(report: &Report) {
    let rows = rows_of(report, "leaves");
    assert_eq!(column(report, &rows, "delta"), [0.02, 0.05, 0.1, 0.25, 0.5]);
    assert_eq!(column(report, &rows, "points_without_leaf"), [0.0; 5]);
    let falls = |key: &str| {
        let numbers = column(report, &rows, key);
        assert!(numbers.windows(2).all(|pair| pair[0] >= pair[1]), "{key}: {numbers:?}");
    };
    falls("depth");
    falls("leaves");
    let [mean, max, bound, edge, distance] = [
        "leaf_distance_mean_edges",
        "leaf_distance_max_edges",
        "leaf_distance_bound_edges",
        "cell_edge",
        "leaf_distance_mean",
    ]
    .map(|key| column(report, &rows, key));
    for place in 0..5 {
        // Centres are rounded to f32.
        assert!(
            max[place] <= bound[place] * 1.0001,
            "{} of {}",
            max[place],
            bound[place]
        );
        assert!(bound[place] == 0.75f64.sqrt());
        // For points anywhere in a cube 0.48; a surface through it is somewhat closer to its centre.
        assert!((0.4..0.55).contains(&mean[place]), "{}", mean[place]);
        assert!((distance[place] / edge[place] / mean[place] - 1.0).abs() < 1e-9);
    }
    for (loss, delta) in column(report, &rows, "loss").iter().zip(column(report, &rows, "delta")) {
        assert!(*loss <= delta, "a loss of {loss} where {delta} is acceptable");
    }
}

fn assert_voxels_beside_surfels(report: &Report) {
    let rows = rows_of(report, "closed");
    let [covered, outside, flip] = ["covered", "outside", "flip_surfels_mean"].map(|key| column(report, &rows, key));
    // The paper's δ, leaves as large as the spacing lit by faces, and by normals. Seen from these two sides, surfels of
    // thin limbs extend beyond cells by more than a hundredth; tests/pictures/closed_voxels.rs tests all sides.
    assert!(covered[0] < 0.9 && covered[1] > 0.98, "{covered:?}");
    assert_eq!(covered[1], covered[2], "light changes no silhouette");
    assert!(outside[0] < outside[1] && outside[1] < 0.3, "{outside:?}");
    assert!(flip[2] < flip[1] && flip[2] < flip[0], "{flip:?}");
}

fn assert_levels_of_detail(report: &Report) {
    let rows = rows_of(report, "lod");
    assert_eq!(column(report, &rows, "lod_px"), [0.0, 1.0, 2.0, 4.0, 8.0].repeat(2));
    let (near, far) = rows.split_at(5);
    assert_eq!(column(report, near, "distance"), [1.0; 5]);
    assert_eq!(column(report, far, "distance"), [4.0; 5]);
    for rows in [near, far] {
        for key in ["drawn_voxels", "visited_nodes"] {
            let numbers = column(report, rows, key);
            assert!(numbers[4] < 0.5 * numbers[0], "{key}: {numbers:?}");
        }
        let voxels = column(report, rows, "drawn_voxels");
        assert!(voxels.windows(2).all(|pair| pair[0] >= pair[1]), "{voxels:?}");
        // A coarser cell hides the finer ones inside it.
        let shares = column(report, rows, "object_share");
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
        assert!(shares[0] > 0.0 && shares[4] < 0.5, "{shares:?}");
        // The ground truth has no error.
        for key in ["psnr_db", "flip_mean", "flip_object_mean", "flip_max", "flip_over_time"] {
            assert_eq!(report.value(rows[0], key), Some(&Cell::Missing), "{key}");
        }
        let compared = &rows[1..];
        let [whole, object, most] =
            ["flip_mean", "flip_object_mean", "flip_max"].map(|key| column(report, compared, key));
        for flip in [&whole, &object] {
            assert!(flip.windows(2).all(|pair| pair[0] < pair[1]), "{flip:?}");
        }
        for place in 0..4 {
            let errors = [0.0, whole[place], object[place], most[place], 1.0];
            assert!(
                errors.windows(2).all(|pair| pair[0] <= pair[1]),
                "background is right, and the mean is no more than the largest: {errors:?}"
            );
        }
        let over_time = column(report, compared, "flip_over_time");
        // Near by, cells of an image this small are all larger than a pixel.
        assert!(
            over_time[1..].iter().all(|error| (0.001..1.0).contains(error)),
            "{over_time:?}"
        );
        let to_surfels = column(report, rows, "flip_surfels_mean");
        assert!(
            to_surfels.iter().all(|error| (0.01..1.0).contains(error)),
            "{to_surfels:?}"
        );
        // 1 frame, 2 viewpoints.
        assert_eq!(column(report, rows, "pictures"), [2.0; 5]);
    }
    let ratios = column(report, &near[2..], "psnr_db");
    assert!(ratios.windows(2).all(|pair| pair[0] > pair[1]), "{ratios:?}");
    let [near, far] = [near, far].map(|rows| column(report, rows, "drawn_voxels"));
    assert_eq!(near[0], far[0], "all leaves");
    assert!(
        near[1..].iter().zip(&far[1..]).all(|(near, far)| near > far),
        "{near:?} {far:?}"
    );
}
